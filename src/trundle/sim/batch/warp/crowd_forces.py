"""How members of crowds react, on a device: each operation and its order are those of `_core/crowds/forces.hpp`."""

# pyright: reportAttributeAccessIssue=false, reportInvalidTypeForm=false, reportOperatorIssue=false
# pyright: reportCallIssue=false, reportIndexIssue=false, reportArgumentType=false

import math

import warp as wp

from trundle.sim.batch.warp.arithmetic import EXACT, HALF, ONE, TWO, ZERO, clamped, far, greater, lesser, sin_cos
from trundle.sim.batch.warp.crowd_model import ROBOT_MARGIN, Crowds, cell_of, length_of

wp.set_module_options(EXACT)

PI = wp.constant(wp.float64(math.pi))
TAU = wp.constant(wp.float64(0.5))
TINY = wp.constant(wp.float64(1e-9))
_LOOK_S, _SWING_MARGIN = wp.constant(wp.float64(1.5)), wp.constant(wp.float64(0.1))
_SOCIAL, _SOCIAL_M = wp.constant(wp.float64(2.1 / 0.3)), wp.constant(wp.float64(0.3))
_BORDER, _BORDER_M = wp.constant(wp.float64(10.0 / 0.2)), wp.constant(wp.float64(0.2))
_STEP_S, _SEEN, _UNSEEN = (wp.constant(wp.float64(value)) for value in (2.0, -0.1736481776669303, 0.5))
_PEDESTRIAN, _TWO_PEDESTRIANS = wp.constant(wp.float64(0.3)), wp.constant(wp.float64(2.0 * 0.3))
_LEAST_SQUARE, _MOST_FORCE, _FOUR = (wp.constant(wp.float64(value)) for value in (1e-6, 1e3, 4.0))
_STILL, _NEARER = wp.constant(wp.float64(1e-12)), wp.constant(wp.float64(1e-12))
_TWO_PI, _255 = wp.constant(wp.float64(2.0 * math.pi)), wp.constant(wp.float64(255.0))
_VANISHES, _PER_LN_2 = wp.constant(wp.float64(-700.0)), wp.constant(wp.float64(1.4426950408889634))
_LN_2_FIRST = wp.constant(wp.float64(float.fromhex("0x1.62e42feep-1")))
_LN_2_SECOND = wp.constant(wp.float64(float.fromhex("0x1.a39ef35793c76p-33")))
_E13, _E12, _E11, _E10, _E9, _E8, _E7, _E6, _E5, _E4, _E3 = (
    wp.constant(wp.float64(1.0 / math.factorial(n))) for n in range(13, 2, -1)
)
_SIXTEENTH = wp.constant(wp.float64(0.41421356237309503))
_A0, _A1, _A2, _A3, _A4, _A5, _A6, _A7, _A8, _A9 = (
    wp.constant(wp.float64(value))
    for value in (
        *(-0.025316882023658713, 0.050249178580926424, -0.06506074628618731, 0.07673558912869073),
        *(-0.09089533150850244, 0.11111049096224869, -0.14285712671671452, 0.1999999997859086),
        *(-0.3333333333322278, 0.9999999999999994),
    )
)
_QUARTER_PI, _HALF_PI = wp.constant(wp.float64(0.25 * math.pi)), wp.constant(wp.float64(0.5 * math.pi))


@wp.func
def exp_of(x: wp.float64):
    """The exponential function of a number of at most 0."""
    if not (x > _VANISHES):
        return ZERO
    whole = wp.floor(x * _PER_LN_2 + HALF)
    r = (x - whole * _LN_2_FIRST) - whole * _LN_2_SECOND
    total = _E13 * r + _E12
    total = total * r + _E11
    total = total * r + _E10
    total = total * r + _E9
    total = total * r + _E8
    total = total * r + _E7
    total = total * r + _E6
    total = total * r + _E5
    total = total * r + _E4
    total = total * r + _E3
    value = ONE + (r + r * r * (HALF + r * total))
    bits = (wp.int64(whole) + wp.int64(1023)) << wp.int64(52)
    return value * wp.cast(bits, wp.float64)


@wp.func
def is_negative(x: wp.float64):
    """Whether the sign is minus, that of 0 as well."""
    return wp.cast(x, wp.int64) < wp.int64(0)


@wp.func
def bearing_of(y: wp.float64, x: wp.float64):
    """`bearing_of_usual`: members have a speed wherever it is asked for."""
    ax, ay = wp.abs(x), wp.abs(y)
    large, small = ax, ay
    if ax < ay:
        large, small = ay, ax
    steep = small > _SIXTEENTH * large
    z = small / large
    if steep:
        z = (small - large) / (large + small)
    u = z * z
    total = _A0 * u + _A1
    total = total * u + _A2
    total = total * u + _A3
    total = total * u + _A4
    total = total * u + _A5
    total = total * u + _A6
    total = total * u + _A7
    total = total * u + _A8
    total = total * u + _A9
    angle = z * total
    if steep:
        angle = angle + _QUARTER_PI
    if ay > ax:
        angle = _HALF_PI - angle
    if is_negative(x):
        angle = PI - angle
    angle = wp.abs(angle)
    if is_negative(y):
        angle = -angle
    return angle


@wp.func
def wrapped(angle: wp.float64):
    """To (−π, π]."""
    rest = wp.mod(PI - angle, _TWO_PI)
    if rest < ZERO:
        rest = rest + _TWO_PI
    return PI - rest


@wp.func
def repulsion(at: wp.vec2d, radius: wp.float64, direction: wp.vec2d, other: wp.vec4d, other_radius: wp.float64):
    """The force on someone away from another, (x, y, vx, vy)."""
    apart_x, apart_y = at[0] - other[0], at[1] - other[1]
    distance = length_of(apart_x, apart_y)
    if distance < TINY:
        return wp.vec2d(ZERO, ZERO)
    step_x, step_y = other[2] * _STEP_S, other[3] * _STEP_S
    beyond_x, beyond_y = apart_x - step_x, apart_y - step_y
    reached = length_of(beyond_x, beyond_y)
    whole = distance + reached
    minor = wp.sqrt(greater(whole * whole - (step_x * step_x + step_y * step_y), _LEAST_SQUARE)) / TWO
    wide = greater(ZERO, radius + other_radius - _TWO_PEDESTRIANS)
    strength = _SOCIAL * exp_of(-greater(ZERO, minor - wide) / _SOCIAL_M)
    strength = lesser(strength * (whole / (_FOUR * minor)), _MOST_FORCE)
    away = greater(reached, TINY)
    force_x = strength * (apart_x / distance + beyond_x / away)
    force_y = strength * (apart_y / distance + beyond_y / away)
    share = wp.float64(_UNSEEN)
    if -(force_x * direction[0] + force_y * direction[1]) >= _SEEN * length_of(force_x, force_y):
        share = wp.float64(1.0)
    return wp.vec2d(force_x * share, force_y * share)


@wp.func
def border_force(crowds: Crowds, crowd: wp.int32, p: wp.vec2d, radius: wp.float64):
    """The force away from the nearest solid; `Floor::push` and `border_force`."""
    offset, cols = crowds.floors[crowd, 0], crowds.floors[crowd, 2]
    at = offset + cell_of(crowds, crowd, p[0], p[1])
    away_x = wp.float64(crowds.nearness[at - 1]) - wp.float64(crowds.nearness[at + 1])
    away_y = wp.float64(crowds.nearness[at - cols]) - wp.float64(crowds.nearness[at + cols])
    length = greater(length_of(away_x, away_y), TINY)
    distance = (ONE - wp.float64(crowds.nearness[at]) / _255) * crowds.frames[crowd][3]
    gap = greater(ZERO, distance - (radius - _PEDESTRIAN))
    strength = _BORDER * exp_of(-gap / _BORDER_M)
    return wp.vec2d(strength * (away_x / length), strength * (away_y / length))


@wp.func
def gap_to_path(p: wp.vec2d, robot: wp.vec4d):
    """The distance of a point from the line that the robot drives next, and the unit vector from there."""
    along_x, along_y = robot[2] * _LOOK_S, robot[3] * _LOOK_S
    from_x, from_y = p[0] - robot[0], p[1] - robot[1]
    square = greater(along_x * along_x + along_y * along_y, _STILL)
    share = clamped((from_x * along_x + from_y * along_y) / square, ZERO, ONE)
    offset_x, offset_y = p[0] - (robot[0] + share * along_x), p[1] - (robot[1] + share * along_y)
    distance = length_of(offset_x, offset_y)
    length = greater(distance, TINY)
    return wp.vec3d(distance, offset_x / length, offset_y / length)


@wp.func
def enters_path(p: wp.vec2d, reached: wp.vec2d, radius: wp.float64, robot: wp.vec4d, robot_radius: wp.float64):
    """Whether someone would come too near to the robot, or to where it is about to be."""
    then = gap_to_path(reached, robot)[0]
    return then < radius + robot_radius + ROBOT_MARGIN and then < gap_to_path(p, robot)[0] - _NEARER


@wp.func
def give_way(
    p: wp.vec2d,
    velocity: wp.vec2d,
    radius: wp.float64,
    robot: wp.vec4d,
    robot_radius: wp.float64,
    dt: wp.float64,
):
    """A velocity without what leads into the robot, or into where it is about to be."""
    if not enters_path(p, wp.vec2d(p[0] + velocity[0] * dt, p[1] + velocity[1] * dt), radius, robot, robot_radius):
        return velocity
    gap = gap_to_path(p, robot)
    inward = lesser(ZERO, velocity[0] * gap[1] + velocity[1] * gap[2])
    return wp.vec2d(velocity[0] - inward * gap[1], velocity[1] - inward * gap[2])


@wp.func
def from_outline(corners: wp.array(dtype=wp.vec2d), own: wp.vec2i, at: wp.vec3d, yaw: wp.float64, robot: wp.vec4d):
    """The distance of the robot's centre from an outline at a pose; 0 inside."""
    turn = sin_cos(yaw)
    dx, dy = robot[0] - at[0], robot[1] - at[1]
    px, py = turn[1] * dx + turn[0] * dy, turn[1] * dy - turn[0] * dx
    inside = wp.bool(True)
    nearest = far()
    for i in range(own[0], own[1]):
        start = corners[i]
        after = i + 1
        if after == own[1]:
            after = own[0]
        end = corners[after]
        along_x, along_y = end[0] - start[0], end[1] - start[1]
        offset_x, offset_y = px - start[0], py - start[1]
        if not (along_x * offset_y >= along_y * offset_x):
            inside = False
        square = along_x * along_x + along_y * along_y
        share = clamped((offset_x * along_x + offset_y * along_y) / square, ZERO, ONE)
        nearest = lesser(nearest, length_of(offset_x - share * along_x, offset_y - share * along_y))
    if inside:
        return ZERO
    return nearest


@wp.func
def swings_into(
    corners: wp.array(dtype=wp.vec2d),
    own: wp.vec2i,
    at: wp.vec3d,
    turned: wp.float64,
    robot: wp.vec4d,
    robot_radius: wp.float64,
):
    """Whether a body would come too near to the robot by turning."""
    after = from_outline(corners, own, at, turned, robot)
    if not (after < robot_radius + _SWING_MARGIN):
        return False
    before = from_outline(corners, own, at, at[2], robot)
    return after < before or before < robot_radius
