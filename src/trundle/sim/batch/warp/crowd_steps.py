"""Kernels that step live crowds: `next` of `_core/crowds/walk.cpp`, a thread for a member around a robot."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, ONE, ZERO, clamped, far, greater, lesser, sin_cos
from trundle.sim.batch.warp.crowd_forces import (
    TAU,
    TINY,
    bearing_of,
    border_force,
    enters_path,
    give_way,
    repulsion,
    swings_into,
    wrapped,
)
from trundle.sim.batch.warp.crowd_model import (
    NOTHING_DUE,
    PERIOD,
    Crowds,
    CrowdState,
    around_col,
    around_row,
    cell_of,
    distance_of,
    index_at,
    is_free,
    length_of,
    member_at,
    middle_of,
    place_of,
)
from trundle.sim.batch.warp.model import Model

wp.set_module_options(EXACT | {"block_dim": 64})

_SWING, _SLOW, _NEARER = (wp.constant(wp.float64(value)) for value in (0.2, 0.02, 1e-12))
_MOST_TURN, _MOST_STEER = wp.constant(wp.float64(4.0 * 0.05)), wp.constant(wp.float64(1.2 * 0.05))


@wp.func
def place_in_plane(places: wp.array2d(dtype=wp.vec2d), member: wp.int32, robot: wp.int32):
    """A copy: what is read from an array is a reference to it."""
    return wp.vec2d(places[member, robot][0], places[member, robot][1])


@wp.func
def ahead_of(crowds: Crowds, state: CrowdState, crowd: wp.int32, member: wp.int32, robot: wp.int32, p: wp.vec2d):
    """The point a little ahead on a member's path."""
    cols = crowds.floors[crowd, 2]
    cell = cell_of(crowds, crowd, p[0], p[1])
    window = state.windows[member, robot]
    for _i in range(crowds.floors[crowd, 3]):
        place = (cell // cols - window[0]) * window[3] + cell % cols - window[1]
        step = wp.int32(state.paths[robot, member, place // 2])
        step = wp.where(place % 2 == 0, step % 16, step // 16)
        cell += around_row(step) * cols + around_col(step)
    return middle_of(crowds, crowd, cell)


@wp.func
def turn_of(crowds: Crowds, state: CrowdState, member: wp.int32, number: wp.int32, robot: wp.int32, off: wp.float64):
    """The new yaw of a member that is off by an angle from where it wants to; `number` is that among all members."""
    at = state.at[member, robot]
    most = wp.float64(_MOST_TURN)
    if crowds.steers[number]:
        most = wp.float64(_MOST_STEER)
    turned = at[2] + clamped(off, -most, most)
    if crowds.steers[number] and crowds.sees[number] and turned != at[2]:
        seen, robot_radius = state.robots[robot], state.radius[robot]
        apart = distance_of(place_of(at), wp.vec2d(seen[0], seen[1]))
        if apart < crowds.radii[number] + robot_radius + _SWING:
            meets = swings_into(crowds.corners, crowds.outlines[number], at, turned, seen, robot_radius)
            if meets:
                return wp.float64(at[2])
    return turned


@wp.func
def sum_of_repulsion(crowds: Crowds, state: CrowdState, scene: wp.int32, robot: wp.int32, p: wp.vec2d,
                     radius: wp.float64, direction: wp.vec2d):  # fmt: skip
    """The forces of all others on someone, those of members first; the robot's is not among them."""
    first, members = crowds.scenes[scene, 2], crowds.scenes[scene, 3]
    x, y = wp.float64(0.0), wp.float64(0.0)
    for k in range(members):
        at, moves = state.at[k, robot], state.velocity[k, robot]
        pushed = repulsion(p, radius, direction, wp.vec4d(at[0], at[1], moves[0], moves[1]), crowds.radii[first + k])
        x = x + pushed[0]
        y = y + pushed[1]
    others = crowds.scenes[scene, 5]
    row = crowds.scenes[scene, 6] + wp.min(state.index[robot], crowds.scenes[scene, 7] - 1) * others
    for k in range(others):
        pushed = repulsion(
            p, radius, direction, crowds.others[row + k], crowds.other_radii[crowds.scenes[scene, 4] + k]
        )
        x = x + pushed[0]
        y = y + pushed[1]
    return wp.vec2d(x, y)


@wp.kernel
def push_members(crowds: Crowds, state: CrowdState, places: wp.array2d(dtype=wp.int64)):
    """Where forces take each member within a period, off solids and the robot's way; others are no matter yet."""
    member, i = wp.tid()
    if state.due[i] == NOTHING_DUE:
        return
    scene = wp.int32(places[i, 1])
    if member >= crowds.scenes[scene, 3]:
        return
    number = crowds.scenes[scene, 2] + member
    crowd, radius = crowds.crowd_of[number], crowds.radii[number]
    p = place_of(state.at[member, i])
    velocity = wp.vec2d(state.velocity[member, i][0], state.velocity[member, i][1])
    ahead = ahead_of(crowds, state, crowd, member, i, p)
    away_x, away_y = ahead[0] - p[0], ahead[1] - p[1]
    length = greater(length_of(away_x, away_y), TINY)
    direction = wp.vec2d(away_x / length, away_y / length)
    border = border_force(crowds, crowd, p, radius)
    preferred = state.preferred[member, i]
    force_x = border[0] + (preferred * direction[0] - velocity[0]) / TAU
    force_y = border[1] + (preferred * direction[1] - velocity[1]) / TAU
    pushed = sum_of_repulsion(crowds, state, scene, i, p, radius, direction)
    force_x = force_x + pushed[0]
    force_y = force_y + pushed[1]
    robot, robot_radius, sees = state.robots[i], state.radius[i], crowds.sees[number]
    if sees:
        driven = repulsion(p, radius, direction, robot, robot_radius)
        force_x = force_x + driven[0]
        force_y = force_y + driven[1]
    wanted_x, wanted_y = velocity[0] + force_x * PERIOD, velocity[1] + force_y * PERIOD
    share = lesser(ONE, crowds.tops[number] / greater(length_of(wanted_x, wanted_y), TINY))
    wanted_x = wanted_x * share
    wanted_y = wanted_y * share
    speed = length_of(wanted_x, wanted_y)
    off = wp.float64(0.0)
    if not (speed < _SLOW):
        off = wrapped(bearing_of(wanted_y, wanted_x) - state.at[member, i][2])
    turned = turn_of(crowds, state, member, number, i, off)
    state.turned[member, i] = turned
    if crowds.steers[number]:
        forwards = speed * greater(ZERO, sin_cos(off)[1])
        turn = sin_cos(turned)
        wanted_x = forwards * turn[1]
        wanted_y = forwards * turn[0]
    wanted = wp.vec2d(wanted_x, wanted_y)
    if sees:
        wanted = give_way(p, wanted, radius, robot, robot_radius, PERIOD)
    # Off solids: along one axis where not along both, or nowhere.
    x, y = p[0] + wanted[0] * PERIOD, p[1] + wanted[1] * PERIOD
    if not is_free(crowds, crowd, x, y):
        if is_free(crowds, crowd, x, p[1]):
            y = p[1]
        elif is_free(crowds, crowd, p[0], y):
            x = p[0]
        else:
            x = p[0]
            y = p[1]
    state.reached[member, i] = wp.vec2d(x, y)


@wp.func
def overlaps(then: wp.float64, now: wp.float64, least: wp.float64):
    return then < least and then < now - _NEARER


@wp.kernel
def keep_apart(
    crowds: Crowds,
    state: CrowdState,
    places: wp.array2d(dtype=wp.int64),
    turn: wp.int32,
    reached: wp.array2d(dtype=wp.vec2d),
    out: wp.array2d(dtype=wp.vec2d),
):
    """Where members get without overlapping others: past the one in the way in the first turn, then nowhere."""
    member, i = wp.tid()
    if state.due[i] == NOTHING_DUE:
        return
    scene = wp.int32(places[i, 1])
    members = crowds.scenes[scene, 3]
    if member >= members:
        return
    first, others = crowds.scenes[scene, 2], crowds.scenes[scene, 5]
    row = crowds.scenes[scene, 6] + wp.min(state.index[i], crowds.scenes[scene, 7] - 1) * others
    p = place_of(state.at[member, i])
    own = place_in_plane(reached, member, i)
    stopped = wp.bool(False)
    nearest = far()
    blocker = wp.vec2d(ZERO, ZERO)
    for k in range(members + others):
        other = wp.vec2d(ZERO, ZERO)
        radius = wp.float64(0.0)
        if k < members:
            other = place_of(state.at[k, i])
            radius = wp.float64(crowds.radii[first + k])
        else:
            other = wp.vec2d(crowds.others[row + k - members][0], crowds.others[row + k - members][1])
            radius = wp.float64(crowds.other_radii[crowds.scenes[scene, 4] + k - members])
        if k != member:
            least = crowds.radii[first + member] + radius
            now = distance_of(p, other)
            hits = overlaps(distance_of(own, other), now, least)
            if not hits and k < members:
                hits = overlaps(distance_of(own, reached[k, i]), now, least)
            if hits:
                stopped = True
                if now - least < nearest:
                    nearest = now - least
                    blocker = wp.vec2d(other[0], other[1])
    if not stopped:
        out[member, i] = own
        return
    if turn > 0:  # who still approaches someone stays
        out[member, i] = p
        return
    x, y = p[0] - blocker[0], p[1] - blocker[1]
    length = greater(length_of(x, y), TINY)
    x = x / length
    y = y / length
    inward = lesser(ZERO, (own[0] - p[0]) * x + (own[1] - p[1]) * y)
    out[member, i] = wp.vec2d(own[0] - inward * x, own[1] - inward * y)


@wp.kernel
def settle_members(crowds: Crowds, state: CrowdState, places: wp.array2d(dtype=wp.int64)):
    """Write where members are a period later, from `slid`."""
    member, i = wp.tid()
    if state.due[i] == NOTHING_DUE:
        return
    scene = wp.int32(places[i, 1])
    if member >= crowds.scenes[scene, 3]:
        return
    number = crowds.scenes[scene, 2] + member
    at = state.at[member, i]
    p = place_of(at)
    reached = place_in_plane(state.slid, member, i)
    allowed = is_free(crowds, crowds.crowd_of[number], reached[0], reached[1])
    if allowed and crowds.sees[number]:
        allowed = not enters_path(p, reached, crowds.radii[number], state.robots[i], state.radius[i])
    if not allowed:
        reached = wp.vec2d(p[0], p[1])
    turned = state.turned[member, i]
    state.next_at[member, i] = wp.vec3d(reached[0], reached[1], turned)
    state.next_velocity[member, i] = wp.vec3d(
        (reached[0] - p[0]) / PERIOD, (reached[1] - p[1]) / PERIOD, (turned - at[2]) / PERIOD
    )


@wp.kernel
def place_members(
    model: Model,
    crowds: Crowds,
    state: CrowdState,
    active: wp.array(dtype=wp.bool),
    places: wp.array2d(dtype=wp.int64),
    steps: wp.array(dtype=wp.int64),
    substeps: wp.int32,
    out: wp.array3d(dtype=wp.vec3d),
):
    """Write where members are after each of the last substeps that are within the period that was stepped last."""
    member, i = wp.tid()
    if not active[i] or places[i, 1] < wp.int64(0):
        return
    if member >= crowds.scenes[wp.int32(places[i, 1]), 3]:
        return
    for substep in range(substeps):
        time = wp.float64(steps[i] - wp.int64(substeps - 1 - substep)) * model.timestep
        if index_at(time) == state.index[i]:
            out[member, i, substep] = member_at(state, member, i, time)


@wp.kernel
def find_members(state: CrowdState, robot: wp.int32, time: wp.float64, out: wp.array(dtype=wp.vec3d)):
    """Write where the members around a robot are at its time."""
    member = wp.tid()
    out[member] = member_at(state, member, robot, time)
