"""What all robots share on a device, and what kernels ask of it."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, ZERO, greater, sin_cos

wp.set_module_options(EXACT)

NO_FAULT = 2**62
"""What `fault` holds without one; else 8 × robot + kind, of the first robot. Nothing moves until the host raised it."""

NOTHING_BAD = wp.constant(wp.int64(NO_FAULT))
NOTHING_TOUCHED = wp.constant(wp.int64(2**62))
COMMAND, POSE, MAP, RECORDING, ERRORS, NO_ROOM = range(1, 7)


@wp.struct
class Model:
    """What all robots share; see `BatchModel`."""

    cells: wp.array(dtype=wp.uint8)
    shapes: wp.array2d(dtype=wp.int32)  # offset, rows, cols
    frames: wp.array2d(dtype=wp.float64)  # x, y, yaw, sine, cosine
    resolution: wp.float64
    outline: wp.array(dtype=wp.vec2d)
    radius: wp.float64
    cover: wp.array(dtype=wp.vec2d)
    cover_radius: wp.float64
    forward: wp.float64
    reverse: wp.float64
    turning: wp.float64
    linear_step: wp.float64
    angular_step: wp.float64
    wheel_radius: wp.float64
    track_width: wp.float64
    wheel_speed: wp.float64
    timestep: wp.float64
    lidars: wp.array(dtype=wp.vec4d)  # x, y, range_min, range_max
    lidar_of: wp.array(dtype=wp.int32)  # of each beam
    beams: wp.array(dtype=wp.vec2d)  # unit vectors in base_link
    corners: wp.array(dtype=wp.vec2d)
    corner_ranges: wp.array(dtype=wp.vec2i)  # of each mover
    radii: wp.array(dtype=wp.float64)
    tracks: wp.array2d(dtype=wp.vec3d)
    recordings: wp.array(dtype=wp.vec2i)
    members: wp.array(dtype=wp.int32)  # of each recording, the first mover that is a member of a live crowd
    samples: wp.int32
    period: wp.float64


@wp.kernel
def turn_angles(angles: wp.array(dtype=wp.float64), out: wp.array(dtype=wp.vec2d)):
    """Sine and cosine of each angle."""
    i = wp.tid()
    out[i] = sin_cos(angles[i])


@wp.func
def blame(fault: wp.array(dtype=wp.int64), robot: wp.int32, kind: wp.int32):
    wp.atomic_min(fault, 0, wp.int64(robot) * wp.int64(8) + wp.int64(kind))


@wp.func
def turned(turn: wp.vec2d, point: wp.vec2d):
    return wp.vec2d(turn[1] * point[0] - turn[0] * point[1], turn[0] * point[0] + turn[1] * point[1])


@wp.func
def to_cells(model: Model, number: wp.int32, px: wp.float64, py: wp.float64):
    dx = px - model.frames[number, 0]
    dy = py - model.frames[number, 1]
    sin, cos = model.frames[number, 3], model.frames[number, 4]
    return wp.vec2d((cos * dx + sin * dy) / model.resolution, (cos * dy - sin * dx) / model.resolution)


@wp.func
def mover_at(model: Model, mover: wp.int32, time: wp.float64):
    """Pose of a mover; `Movers::at`."""
    sample = greater(time / model.period, ZERO)
    whole = wp.floor(sample)
    if not (whole < wp.float64(model.samples - 1)):
        return model.tracks[mover, model.samples - 1]
    index = wp.int32(whole)
    a = model.tracks[mover, index]
    b = model.tracks[mover, index + 1]
    share = sample - whole
    return wp.vec3d(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2]))


@wp.func
def mover_of(
    model: Model,
    members: wp.array3d(dtype=wp.vec3d),
    recording: wp.int32,
    mover: wp.int32,
    robot: wp.int32,
    substep: wp.int32,
    time: wp.float64,
):
    """Pose of a mover around a robot at the time of a substep, for which `members` of live crowds are known."""
    member = mover - model.members[recording]
    if member >= 0:
        return members[member, robot, substep]
    return mover_at(model, mover, time)


@wp.func
def placed_corner(model: Model, index: wp.int32, turn: wp.vec2d, dx: wp.float64, dy: wp.float64):
    corner = model.corners[index]
    return wp.vec2d(
        dx + turn[1] * corner[0] - turn[0] * corner[1],
        dy + turn[0] * corner[0] + turn[1] * corner[1],
    )
