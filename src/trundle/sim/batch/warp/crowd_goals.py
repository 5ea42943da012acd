"""Kernels that draw where members of live crowds go, as `_core/crowds/walk.cpp` does: a thread for a robot."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import math

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, ZERO, greater, lesser, sin_cos
from trundle.sim.batch.warp.crowd_draws import draw_uniform, draw_whole
from trundle.sim.batch.warp.crowd_model import (
    NOTHING_DUE,
    PERIOD,
    RETREATS,
    ROBOT_MARGIN,
    STEP,
    Crowds,
    CrowdState,
    cell_of,
    distance_of,
    has_path,
    index_at,
    middle_of,
    place_of,
)
from trundle.sim.batch.warp.crowd_paths import BLOCKING
from trundle.sim.batch.warp.model import NOTHING_BAD, Model

wp.set_module_options(EXACT | {"block_dim": 32})

_LEAST_WALK, _THERE, _STUCK_S, _SOMEWHERE = (wp.constant(wp.float64(value)) for value in (4.0, 0.4, 2.0, 0.5))
_TURNS_FIRST = wp.constant(wp.float64(math.pi / 1.2))


@wp.func
def far_cell(crowds: Crowds, draws: wp.array3d(dtype=wp.uint64), crowd: wp.int32, row: wp.int32, robot: wp.int32,
             here: wp.vec2d):  # fmt: skip
    """A free cell at least as far away as a walk, if one is found soon; `row` is that of the draws."""
    first, count = crowds.floors[crowd, 4], crowds.floors[crowd, 5]
    cell = wp.int32(crowds.free[first + draw_whole(draws, row, robot, count)])
    for _i in range(8):
        if distance_of(middle_of(crowds, crowd, cell), here) < _LEAST_WALK:
            cell = wp.int32(crowds.free[first + draw_whole(draws, row, robot, count)])
        else:
            break
    return cell


@wp.kernel
def begin_step(
    model: Model,
    crowds: Crowds,
    state: CrowdState,
    active: wp.array(dtype=wp.bool),
    fault: wp.array(dtype=wp.int64),
    places: wp.array2d(dtype=wp.int64),
    steps: wp.array(dtype=wp.int64),
    passed: wp.array2d(dtype=wp.vec3d),
    speeds: wp.array2d(dtype=wp.float64),
    substeps: wp.int32,
):
    """Find the crowds that the next of some substeps takes beyond their last step, and the robot's motion then."""
    i = wp.tid()
    if i == 0:
        state.queued[0] = 0
    state.due[i] = NOTHING_DUE
    if not active[i] or fault[0] != NOTHING_BAD or places[i, 1] < wp.int64(0):
        return
    if crowds.scenes[wp.int32(places[i, 1]), 3] == 0:
        return
    for substep in range(substeps):
        time = wp.float64(steps[i] - wp.int64(substeps - 1 - substep)) * model.timestep
        if index_at(time) > state.index[i]:
            pose = passed[i, substep]
            turn = sin_cos(pose[2])
            speed = speeds[i, substep]
            state.robots[i] = wp.vec4d(pose[0], pose[1], speed * turn[1], speed * turn[0])
            state.radius[i] = model.radius
            state.index[i] = state.index[i] + 1
            state.due[i] = STEP
            return


@wp.func
def is_blocked(crowds: Crowds, state: CrowdState, scene: wp.int32, member: wp.int32, robot: wp.int32):
    """Whether anybody is next to someone who is stuck."""
    first, members = crowds.scenes[scene, 2], crowds.scenes[scene, 3]
    here = place_of(state.at[member, robot])
    radius = crowds.radii[first + member]
    for k in range(members):
        apart = distance_of(place_of(state.at[k, robot]), here)
        if apart < crowds.radii[first + k] + radius + BLOCKING and apart > ZERO:
            return True
    if not crowds.sees[first + member]:
        return False
    apart = distance_of(wp.vec2d(state.robots[robot][0], state.robots[robot][1]), here)
    return apart < radius + state.radius[robot] + ROBOT_MARGIN + BLOCKING and apart > ZERO


@wp.kernel
def choose_goals(crowds: Crowds, state: CrowdState, places: wp.array2d(dtype=wp.int64)):
    """Draw where those go next who are there or stuck, and queue those who need a path."""
    i = wp.tid()
    if state.due[i] == NOTHING_DUE:
        return
    scene = wp.int32(places[i, 1])
    first_crowd, first, members = crowds.scenes[scene, 0], crowds.scenes[scene, 2], crowds.scenes[scene, 3]
    if state.due[i] == STEP:
        for k in range(members):
            state.at[k, i] = state.next_at[k, i]
            state.velocity[k, i] = state.next_velocity[k, i]
    for k in range(members):
        crowd = crowds.crowd_of[first + k]
        row = crowd - first_crowd
        here = place_of(state.at[k, i])
        wait = wp.float64(state.waits[k, i])
        if distance_of(here, state.was_at[k, i]) >= _SOMEWHERE:
            state.was_at[k, i] = here
            wait = lesser(wait, ZERO)
        else:
            wait = wait + PERIOD
        goal = middle_of(crowds, crowd, state.goals[k, i])
        there = distance_of(goal, here) < greater(_THERE, crowds.radii[first + k])
        state.retreats[k, i, 0] = -1
        if there or wait > _STUCK_S:
            if there or not is_blocked(crowds, state, scene, k, i):
                state.goals[k, i] = far_cell(crowds, state.draws, crowd, row, i, here)
                state.windows[k, i] = wp.vec4i(0, 0, 0, 0)
                state.disc_counts[k, i] = 0
            else:
                for n in range(RETREATS):
                    drawn = draw_whole(state.draws, row, i, crowds.floors[crowd, 5])
                    state.retreats[k, i, n] = crowds.free[crowds.floors[crowd, 4] + drawn]
            wait = -draw_uniform(state.draws, row, i, ZERO, _STUCK_S)
            if crowds.steers[first + k]:
                wait = wait - _TURNS_FIRST
        state.waits[k, i] = wait
        cell = cell_of(crowds, crowd, here[0], here[1])
        if state.retreats[k, i, 0] >= 0 or not has_path(crowds, state, crowd, k, i, cell):
            state.queue[wp.atomic_add(state.queued, 0, 1)] = wp.vec2i(k, i)
