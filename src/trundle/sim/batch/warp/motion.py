"""Kernels that put robots somewhere and drive them: a thread for a robot."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, FINITE, ONE, SIX, SMALL_TURN, TWO, ZERO, greater, lesser, sin_cos
from trundle.sim.batch.warp.model import (
    COMMAND,
    ERRORS,
    MAP,
    NOTHING_BAD,
    NOTHING_TOUCHED,
    POSE,
    RECORDING,
    Model,
    blame,
    to_cells,
)

# A warp is a block: the few thousand robots of a batch are on all multiprocessors then.
wp.set_module_options(EXACT | {"block_dim": 32})


@wp.kernel
def check_commands(
    commands: wp.array2d(dtype=wp.float64),
    fault: wp.array(dtype=wp.int64),
):
    """Blame robots whose command is not finite."""
    i = wp.tid()
    if not (wp.abs(commands[i, 0]) < FINITE and wp.abs(commands[i, 1]) < FINITE):
        blame(fault, i, COMMAND)


@wp.kernel
def check_places(
    active: wp.array(dtype=wp.bool),
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    errors: wp.array2d(dtype=wp.float64),
    maps: wp.int64,
    recordings: wp.int64,
    fault: wp.array(dtype=wp.int64),
):
    """Blame robots that cannot be reset like this."""
    i = wp.tid()
    if not active[i]:
        return
    for k in range(3):
        if not (wp.abs(poses[i, k]) < FINITE):
            blame(fault, i, POSE)
    if places[i, 0] < wp.int64(0) or places[i, 0] >= maps:
        blame(fault, i, MAP)
    if places[i, 1] < wp.int64(-1) or places[i, 1] >= recordings:
        blame(fault, i, RECORDING)
    noise, dropouts = errors[i, 0], errors[i, 1]
    if not (noise >= ZERO and noise <= wp.float64(10.0) and dropouts >= ZERO and dropouts <= ONE):
        blame(fault, i, ERRORS)


@wp.kernel
def place_robots(
    active: wp.array(dtype=wp.bool),
    given_poses: wp.array2d(dtype=wp.float64),
    given_places: wp.array2d(dtype=wp.int64),
    given_errors: wp.array2d(dtype=wp.float64),
    given_keys: wp.array(dtype=wp.uint64),
    fault: wp.array(dtype=wp.int64),
    poses: wp.array2d(dtype=wp.float64),
    motions: wp.array2d(dtype=wp.float64),
    wheels: wp.array2d(dtype=wp.float64),
    lengths: wp.array(dtype=wp.float64),
    steps: wp.array(dtype=wp.int64),
    places: wp.array2d(dtype=wp.int64),
    errors: wp.array2d(dtype=wp.float64),
    keys: wp.array(dtype=wp.uint64),
):
    """Put active robots at rest."""
    i = wp.tid()
    if not active[i] or fault[0] != NOTHING_BAD:
        return
    for k in range(3):
        poses[i, k] = given_poses[i, k]
    for k in range(6):
        motions[i, k] = ZERO
    for k in range(2):
        wheels[i, k] = ZERO
        places[i, k] = given_places[i, k]
        errors[i, k] = given_errors[i, k]
    lengths[i] = ZERO
    steps[i] = wp.int64(0)
    keys[i] = given_keys[i]


@wp.kernel
def drive(
    model: Model,
    active: wp.array(dtype=wp.bool),
    commands: wp.array2d(dtype=wp.float64),
    before: wp.int32,
    substeps: wp.int32,
    fault: wp.array(dtype=wp.int64),
    poses: wp.array2d(dtype=wp.float64),
    motions: wp.array2d(dtype=wp.float64),
    wheels: wp.array2d(dtype=wp.float64),
    lengths: wp.array(dtype=wp.float64),
    steps: wp.array(dtype=wp.int64),
    passed: wp.array2d(dtype=wp.vec3d),
    speeds: wp.array2d(dtype=wp.float64),
    first: wp.array(dtype=wp.int64),
):
    """Drive some substeps after those `before`; write pose and speed after each, without substeps the pose now."""
    i = wp.tid()
    if not active[i] or fault[0] != NOTHING_BAD:
        return
    if before == 0:
        first[i] = NOTHING_TOUCHED
    v = lesser(model.forward, greater(-model.reverse, commands[i, 0]))
    w = lesser(model.turning, greater(-model.turning, commands[i, 1]))
    dt, most = model.timestep, model.wheel_speed
    # The constructors copy: what is read from an array is a reference to it.
    x, y, yaw = wp.float64(poses[i, 0]), wp.float64(poses[i, 1]), wp.float64(poses[i, 2])
    ramp_v, ramp_w = wp.float64(motions[i, 0]), wp.float64(motions[i, 1])
    now_v, now_w = wp.float64(motions[i, 2]), wp.float64(motions[i, 3])
    left, right = wp.float64(motions[i, 4]), wp.float64(motions[i, 5])
    left_angle, right_angle, length = wp.float64(wheels[i, 0]), wp.float64(wheels[i, 1]), wp.float64(lengths[i])
    if substeps == 0:
        passed[i, 0] = wp.vec3d(x, y, yaw)
    by_length, by_turn, along, across = wp.float64(0.0), wp.float64(0.0), wp.float64(1.0), wp.float64(0.0)
    is_new = wp.bool(True)
    for substep in range(substeps):
        if not (ramp_v == v and ramp_w == w):
            is_new = True
            ramp_v = ramp_v + lesser(model.linear_step, greater(-model.linear_step, v - ramp_v))
            ramp_w = ramp_w + lesser(model.angular_step, greater(-model.angular_step, w - ramp_w))
            now_v = ramp_v
            now_w = ramp_w
            side = now_w * model.track_width / TWO
            left = (now_v - side) / model.wheel_radius
            right = (now_v + side) / model.wheel_radius
            if wp.abs(left) > most or wp.abs(right) > most:
                left = lesser(most, greater(-most, left))
                right = lesser(most, greater(-most, right))
                now_v = model.wheel_radius * (left + right) / TWO
                now_w = model.wheel_radius * (right - left) / model.track_width
        if is_new:
            is_new = False
            by_length = now_v * dt
            by_turn = now_w * dt
            if wp.abs(by_turn) < SMALL_TURN:
                along = ONE - by_turn * by_turn / SIX
                across = by_turn / TWO
            else:
                turned = sin_cos(by_turn)
                along = turned[0] / by_turn
                across = (ONE - turned[1]) / by_turn
        turn = sin_cos(yaw)
        x = x + by_length * (turn[1] * along - turn[0] * across)
        y = y + by_length * (turn[0] * along + turn[1] * across)
        yaw = yaw + by_turn
        left_angle = left_angle + left * dt
        right_angle = right_angle + right * dt
        length = length + wp.abs(by_length)
        passed[i, substep] = wp.vec3d(x, y, yaw)
        speeds[i, substep] = now_v
    poses[i, 0] = x
    poses[i, 1] = y
    poses[i, 2] = yaw
    motions[i, 0] = ramp_v
    motions[i, 1] = ramp_w
    motions[i, 2] = now_v
    motions[i, 3] = now_w
    motions[i, 4] = left
    motions[i, 5] = right
    wheels[i, 0] = left_angle
    wheels[i, 1] = right_angle
    lengths[i] = length
    steps[i] = steps[i] + wp.int64(substeps)


@wp.kernel
def find_off_map(
    model: Model,
    poses: wp.array2d(dtype=wp.float64),
    places: wp.array2d(dtype=wp.int64),
    out: wp.array(dtype=wp.bool),
):
    """Which robots have their base_link beyond their map."""
    i = wp.tid()
    number = wp.int32(places[i, 0])
    base = to_cells(model, number, poses[i, 0], poses[i, 1])
    width, height = wp.float64(model.shapes[number, 2]), wp.float64(model.shapes[number, 1])
    out[i] = base[0] < ZERO or base[1] < ZERO or base[0] > width or base[1] > height
