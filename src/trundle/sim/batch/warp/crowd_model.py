"""Live crowds on a device: what their members share, and where those around each robot are.

It is `CrowdModel` and `CrowdState` of `_core/crowds` in arrays. Of those with a column for each robot, a row is of a
member of its recording's crowds; who is beyond the last member is nobody.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, HALF, ONE, TWO, clamped

wp.set_module_options(EXACT)

PERIOD = wp.constant(wp.float64(0.05))
WALL = wp.constant(wp.uint8(255))
RETREATS = wp.constant(wp.int32(12))
"""Places that one who is stuck looks at."""

ROBOT_MARGIN = wp.constant(wp.float64(0.5))
"""How near those who see the robot come to it [m]; `kMargin`."""

_ALMOST = wp.constant(wp.float64(1e-9))
_FARTHEST = wp.constant(wp.float64(1e9))


@wp.struct
class Crowds:
    """Crowds of all recordings, one after the other."""

    scenes: wp.array2d(dtype=wp.int32)  # of each recording: first crowd, crowds, first member, members, first other,
    # others, first row of `others`, samples; all 0 without live crowds
    ends: wp.array(dtype=wp.int32)  # of each crowd, where its members end, counted in its recording
    keys: wp.array(dtype=wp.uint32)  # of each crowd: its seeds differ by them
    has_seed: wp.array(dtype=wp.bool)
    words: wp.array2d(dtype=wp.uint64)  # that those draw from which have a seed of their own
    floors: wp.array2d(dtype=wp.int32)  # of each crowd: offset, rows, cols, look, first free cell, free cells
    frames: wp.array(dtype=wp.vec4d)  # x and y of the corner, resolution, reach
    costs: wp.array(dtype=wp.uint8)
    nearness: wp.array(dtype=wp.uint8)
    free: wp.array(dtype=wp.int32)
    crowd_of: wp.array(dtype=wp.int32)  # of each member
    radii: wp.array(dtype=wp.float64)
    tops: wp.array(dtype=wp.float64)
    sees: wp.array(dtype=wp.bool)
    steers: wp.array(dtype=wp.bool)
    outlines: wp.array(dtype=wp.vec2i)  # in `corners`
    corners: wp.array(dtype=wp.vec2d)
    other_radii: wp.array(dtype=wp.float64)  # of those who move by functions of time
    others: wp.array(dtype=wp.vec4d)  # x, y, vx, vy at each step
    window: wp.int32  # largest edge of the square in which a path is kept [cells]


@wp.struct
class CrowdState:
    """Where the members around each robot are; `CrowdState` in C++."""

    index: wp.array(dtype=wp.int32)  # steps since the start
    due: wp.array(dtype=wp.int32)  # what is next: `NOTHING_DUE`, `STEP` or `START`
    robots: wp.array(dtype=wp.vec4d)  # x, y, vx, vy of the robot in the step
    radius: wp.array(dtype=wp.float64)  # of the robot then
    draws: wp.array3d(dtype=wp.uint64)  # of each crowd
    at: wp.array2d(dtype=wp.vec3d)  # x, y, yaw at the last step
    velocity: wp.array2d(dtype=wp.vec3d)  # before that
    next_at: wp.array2d(dtype=wp.vec3d)
    next_velocity: wp.array2d(dtype=wp.vec3d)  # from the last step on
    goals: wp.array2d(dtype=wp.int32)  # cells
    was_at: wp.array2d(dtype=wp.vec2d)
    waits: wp.array2d(dtype=wp.float64)
    preferred: wp.array2d(dtype=wp.float64)
    windows: wp.array2d(dtype=wp.vec4i)  # row, col, rows, cols that `paths` has around the goal's path; 0 rows without
    paths: wp.array3d(dtype=wp.uint8)  # which cell around a cell is the next; a byte holds two
    disc_counts: wp.array2d(dtype=wp.int32)
    discs: wp.array3d(dtype=wp.vec3d)  # x, y, radius of what the path leads around
    retreats: wp.array3d(dtype=wp.int32)  # cells that one who is stuck looks at, the first −1 for all others
    queue: wp.array(dtype=wp.vec2i)  # member and robot of those who need a path
    queued: wp.array(dtype=wp.int32)
    turned: wp.array2d(dtype=wp.float64)
    reached: wp.array2d(dtype=wp.vec2d)
    slid: wp.array2d(dtype=wp.vec2d)


NOTHING_DUE, STEP, START = (wp.constant(wp.int32(value)) for value in (0, 1, 2))


@wp.func
def length_of(x: wp.float64, y: wp.float64):
    return wp.sqrt(x * x + y * y)


@wp.func
def distance_of(a: wp.vec2d, b: wp.vec2d):
    return length_of(a[0] - b[0], a[1] - b[1])


@wp.func
def place_of(at: wp.vec3d):
    return wp.vec2d(at[0], at[1])


@wp.func
def index_at(time: wp.float64):
    """How many steps there are at a time; `CrowdState::index_at`."""
    return wp.int32(wp.floor(time / PERIOD + _ALMOST))


@wp.func
def member_at(state: CrowdState, member: wp.int32, robot: wp.int32, time: wp.float64):
    """Pose of a member at a time within the period that was stepped last."""
    at = state.at[member, robot]
    velocity = state.next_velocity[member, robot]
    since = (time / PERIOD - wp.float64(state.index[robot])) * PERIOD
    return wp.vec3d(at[0] + since * velocity[0], at[1] + since * velocity[1], at[2] + since * velocity[2])


@wp.func
def place_in(value: wp.float64, corner: wp.float64, resolution: wp.float64, count: wp.int32):
    place = clamped((value - corner) / resolution, -_FARTHEST, _FARTHEST)
    return wp.int32(clamped(wp.floor(place), ONE, wp.float64(count) - TWO))


@wp.func
def cell_of(crowds: Crowds, crowd: wp.int32, x: wp.float64, y: wp.float64):
    """The cell of a point, never one of the rim."""
    frame = crowds.frames[crowd]
    row = place_in(y, frame[1], frame[2], crowds.floors[crowd, 1])
    return row * crowds.floors[crowd, 2] + place_in(x, frame[0], frame[2], crowds.floors[crowd, 2])


@wp.func
def middle_of(crowds: Crowds, crowd: wp.int32, cell: wp.int32):
    frame = crowds.frames[crowd]
    cols = crowds.floors[crowd, 2]
    row = cell // cols
    col = cell - row * cols
    return wp.vec2d((wp.float64(col) + HALF) * frame[2] + frame[0], (wp.float64(row) + HALF) * frame[2] + frame[1])


@wp.func
def is_free(crowds: Crowds, crowd: wp.int32, x: wp.float64, y: wp.float64):
    return crowds.costs[crowds.floors[crowd, 0] + cell_of(crowds, crowd, x, y)] != WALL


@wp.func
def around_row(step: wp.int32):
    """The cell itself, and those around it: `kAroundRow`."""
    if step == 0 or step == 4 or step == 5:
        return 0
    if step < 4:
        return -1
    return 1


@wp.func
def around_col(step: wp.int32):
    if step == 0 or step == 2 or step == 7:
        return 0
    if step == 1 or step == 4 or step == 6:
        return -1
    return 1


@wp.func
def has_path(crowds: Crowds, state: CrowdState, crowd: wp.int32, member: wp.int32, robot: wp.int32, cell: wp.int32):
    """Whether the path of a member is known for all cells that it looks at from one."""
    window = state.windows[member, robot]
    rows, cols, look = crowds.floors[crowd, 1], crowds.floors[crowd, 2], crowds.floors[crowd, 3]
    row = cell // cols
    col = cell - row * cols
    return (
        window[2] > 0
        and wp.max(row - look, 1) >= window[0]
        and wp.max(col - look, 1) >= window[1]
        and wp.min(row + look, rows - 2) < window[0] + window[2]
        and wp.min(col + look, cols - 2) < window[1] + window[3]
    )
