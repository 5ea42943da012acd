"""Kernels that start the crowds around robots that are reset: `CrowdState::reset`, a thread for a robot.

A crowd is drawn into separate memory first, so that nothing changes where one has no room.
"""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import math

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, ZERO, far
from trundle.sim.batch.warp.crowd_draws import draw_uniform, draw_whole, seed_words, start_draws
from trundle.sim.batch.warp.crowd_goals import far_cell
from trundle.sim.batch.warp.crowd_model import NOTHING_DUE, START, Crowds, CrowdState, length_of, middle_of
from trundle.sim.batch.warp.model import NO_ROOM, NOTHING_BAD, blame

wp.set_module_options(EXACT | {"block_dim": 32})

_PI = wp.constant(wp.float64(math.pi))
_CLEAR_OF_ROBOT, _APART, _SLOWEST = (wp.constant(wp.float64(value)) for value in (2.0, 0.1, 0.7))
_TRIES, _PLACINGS = wp.constant(wp.int32(400)), wp.constant(wp.int32(20))
_NEARLY_ALL, _A_FEW = wp.constant(wp.float64(0.8)), wp.constant(wp.float64(5.0))


@wp.struct
class Starts:
    """Crowds that are drawn; `CrowdState` has the same for those that walk."""

    draws: wp.array3d(dtype=wp.uint64)
    at: wp.array2d(dtype=wp.vec3d)
    goals: wp.array2d(dtype=wp.int32)
    preferred: wp.array2d(dtype=wp.float64)
    missing: wp.array(dtype=wp.int32)  # the first member of each robot's crowds that finds no place


@wp.func
def is_clear(
    crowds: Crowds,
    starts: Starts,
    scene: wp.int32,
    member: wp.int32,
    robot: wp.int32,
    p: wp.vec2d,
    pose_x: wp.float64,
    pose_y: wp.float64,
    robot_radius: wp.float64,
):
    """Whether a member may start at a point: beside the robot, the members before it, and all others that move."""
    first = crowds.scenes[scene, 2]
    radius = crowds.radii[first + member]
    if not (length_of(p[0] - pose_x, p[1] - pose_y) - robot_radius - radius > _CLEAR_OF_ROBOT):
        return False
    for k in range(member):
        before = starts.at[k, robot]
        if not (length_of(before[0] - p[0], before[1] - p[1]) - crowds.radii[first + k] - radius > _APART):
            return False
    for k in range(crowds.scenes[scene, 5]):
        other = crowds.others[crowds.scenes[scene, 6] + k]
        apart = length_of(other[0] - p[0], other[1] - p[1])
        if not (apart > radius + crowds.other_radii[crowds.scenes[scene, 4] + k]):
            return False
    return True


@wp.func
def find_place(
    crowds: Crowds,
    starts: Starts,
    scene: wp.int32,
    member: wp.int32,
    robot: wp.int32,
    pose_x: wp.float64,
    pose_y: wp.float64,
    robot_radius: wp.float64,
):
    """Put a member at a random place, and draw where it goes; whether there is one."""
    crowd = crowds.crowd_of[crowds.scenes[scene, 2] + member]
    row = crowd - crowds.scenes[scene, 0]
    first, count = crowds.floors[crowd, 4], crowds.floors[crowd, 5]
    for _attempt in range(_TRIES):
        cell = wp.int32(crowds.free[first + draw_whole(starts.draws, row, robot, count)])
        p = middle_of(crowds, crowd, cell)
        if is_clear(crowds, starts, scene, member, robot, p, pose_x, pose_y, robot_radius):
            starts.at[member, robot] = wp.vec3d(p[0], p[1], draw_uniform(starts.draws, row, robot, -_PI, _PI))
            starts.goals[member, robot] = far_cell(crowds, starts.draws, crowd, row, robot, p)
            return True
    return False


@wp.kernel
def draw_starts(
    crowds: Crowds,
    starts: Starts,
    active: wp.array(dtype=wp.bool),
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    seeds: wp.array(dtype=wp.uint64),
    robot_radius: wp.float64,
    fault: wp.array(dtype=wp.int64),
):
    """Draw where the crowds of robots start that are reset, and blame robots that leave no room for one."""
    i = wp.tid()
    if not active[i] or fault[0] != NOTHING_BAD or places[i, 1] < wp.int64(0):
        return
    scene = wp.int32(places[i, 1])
    first_crowd, first = crowds.scenes[scene, 0], crowds.scenes[scene, 2]
    begin = wp.int32(0)
    for row in range(crowds.scenes[scene, 1]):
        crowd = first_crowd + row
        words = seed_words(seeds[i], crowds.keys[crowd])
        if crowds.has_seed[crowd]:
            for part in range(4):
                words[part] = crowds.words[crowd, part]
        start_draws(starts.draws, row, i, words[0], words[1], words[2], words[3])
        end = wp.int32(crowds.ends[crowd])
        for k in range(begin, end):
            top = crowds.tops[first + k]
            starts.preferred[k, i] = draw_uniform(starts.draws, row, i, top * _SLOWEST, top)
        placed = wp.int32(begin)
        for _placing in range(_PLACINGS):
            placed = wp.int32(begin)
            while placed < end:
                if not find_place(crowds, starts, scene, placed, i, poses[i, 0], poses[i, 1], robot_radius):
                    break
                placed += 1
            if placed == end:
                break
            if wp.float64(placed - begin) < _NEARLY_ALL * wp.float64(end - begin) - _A_FEW:
                break
        if placed < end:
            starts.missing[i] = placed
            blame(fault, i, NO_ROOM)
            return
        begin = wp.int32(end)


@wp.kernel
def begin_crowds(
    crowds: Crowds,
    starts: Starts,
    state: CrowdState,
    active: wp.array(dtype=wp.bool),
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    robot_radius: wp.float64,
    fault: wp.array(dtype=wp.int64),
):
    """Let the crowds that were drawn begin, if all robots that are reset have one."""
    i = wp.tid()
    if i == 0:
        state.queued[0] = 0
    state.due[i] = NOTHING_DUE
    if not active[i] or fault[0] != NOTHING_BAD or places[i, 1] < wp.int64(0):
        return
    scene = wp.int32(places[i, 1])
    members = crowds.scenes[scene, 3]
    if members == 0:
        return
    state.due[i] = START
    state.index[i] = 0
    state.robots[i] = wp.vec4d(poses[i, 0], poses[i, 1], ZERO, ZERO)
    state.radius[i] = robot_radius
    for row in range(crowds.scenes[scene, 1]):
        for part in range(6):
            state.draws[row, i, part] = starts.draws[row, i, part]
    for k in range(members):
        state.at[k, i] = starts.at[k, i]
        state.velocity[k, i] = wp.vec3d(ZERO, ZERO, ZERO)
        state.goals[k, i] = starts.goals[k, i]
        state.preferred[k, i] = starts.preferred[k, i]
        state.was_at[k, i] = wp.vec2d(far(), far())
        state.waits[k, i] = ZERO
        state.windows[k, i] = wp.vec4i(0, 0, 0, 0)
        state.disc_counts[k, i] = 0
