"""Behaviors that move the robot: `BackUp`, `DriveOnHeading`, `Spin`, and `DriveClear`, off what it touches."""

from __future__ import annotations

import math

import numpy as np

from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop, may_pass
from trundle.errors import BehaviorFailedError, InputError
from trundle.geometry import FloatArray, Twist2D, integrate_twist, shrink_outline, wrap_angle
from trundle.geometry.poses import parse_angle, warn_of_degrees
from trundle.navigation.behaviors.behavior import Behavior, BehaviorContext
from trundle.values import as_number, check_number

BACK_UP_M, BACK_UP_MPS = 0.3, 0.15
"""As in Nav2's `navigate_to_pose_w_replanning_and_recovery.xml`."""
_QUARTER_RAD = 1.57  # Nav2's spin_dist
_SPIN_RADPS = 1.0  # Nav2's max_rotational_vel
_BRAKING_SHARE = 0.8
_DONE_M, _DONE_RAD = 0.005, 0.01
_SLOWEST_MPS, _SLOWEST_RADPS = 0.02, 0.05
_FIRST_M = 0.05
"""A motion that would touch something so early is not begun [m]."""
_SHARES = (0.2, 0.4, 0.6, 0.8, 1.0)


class DriveOnHeading(Behavior):
    """Drive straight on, by the robot's odometry.

    Unlike Nav2's, which looks ahead at a fixed speed, it is sent only commands after which the robot can still stop.

    Args:
        distance: How far [m].
        speed: How fast at most [m/s]; the robot slows down before the end.
        allowance: Time after which it has failed [s]. If None, twice the time that it takes at its speed, and 5 s.

    Raises:
        InputError: If one is not a positive number.
    """

    _direction = 1.0

    def __init__(
        self, distance: float = BACK_UP_M, speed: float = BACK_UP_MPS, *, allowance: float | None = None
    ) -> None:
        self.distance = positive("distance", distance)
        self.speed = positive("speed", speed)
        self._allowance = None if allowance is None else positive("allowance", allowance)
        self._driven_m = self._time = 0.0

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.distance:g}, speed={self.speed:g})"

    @property
    def time_allowance(self) -> float:
        """Time after which it has failed [s]."""
        return 2.0 * self.distance / self.speed + 5.0 if self._allowance is None else self._allowance

    def helps(self, context: BehaviorContext) -> bool:
        """Return whether the robot may drive the first 5 cm of it."""
        first = self._direction * min(self.distance, _FIRST_M)
        return _may_begin(context, [Twist2D(share * first, 0.0) for share in _SHARES])

    def start(self, context: BehaviorContext) -> None:
        """Begin here.

        Raises:
            BehaviorFailedError: If the robot cannot drive backwards and is to, or would touch something within the
                first 5 cm.
        """
        limits = context.robot.limits
        if self._direction < 0.0 and limits.reverse_speed == 0.0:
            raise BehaviorFailedError(f"{context.robot.name} cannot reverse: its reverse_speed is 0")
        if not self.helps(context):
            raise BehaviorFailedError(_blocked_at(context))
        self._driven_m, self._time = 0.0, context.time

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return the command for the next control period; None when it has driven that far."""
        self._driven_m += self._direction * context.twist.v * (context.time - self._time)
        self._time = context.time
        left_m = self.distance - self._driven_m
        if left_m <= _DONE_M:
            return None
        speed = _speed_to_stop(left_m, context.robot.limits.linear_acceleration)
        return Twist2D(self._direction * min(self.speed, max(speed, _SLOWEST_MPS)), 0.0)


class BackUp(DriveOnHeading):
    """Drive straight back, by the robot's odometry.

    Args:
        distance: How far [m].
        speed: How fast at most [m/s], as a positive number.
        allowance: Time after which it has failed [s], as of `DriveOnHeading`.

    Raises:
        InputError: If one is not a positive number.
    """

    _direction = -1.0


class Spin(Behavior):
    """Turn in place by an angle, or to a heading.

    Args:
        angle: How far to turn [rad], counter-clockwise; negative turns clockwise. Text may be degrees, `90deg`. None
            means a quarter turn, as in Nav2, where no heading is given.
        speed: How fast at most [rad/s].
        heading: The yaw to turn to instead [rad], map frame, on the shorter side.
        allowance: Time after which it has failed [s]. If None, twice the time that it takes at its speed, and 5 s.

    Raises:
        InputError: If both an angle and a heading are given, one is not finite, or the speed is not positive.
    """

    def __init__(
        self,
        angle: float | str | None = None,
        speed: float = _SPIN_RADPS,
        *,
        heading: float | str | None = None,
        allowance: float | None = None,
    ) -> None:
        if angle is not None and heading is not None:
            raise InputError("spin turns by an angle or to a heading: give one of them, Spin(1.57) or Spin(heading=0)")
        if heading is None:
            angle = _QUARTER_RAD if angle is None else angle
        self.angle = None if angle is None else _read_angle("angle", angle)
        self.heading = None if heading is None else _read_angle("heading", heading)
        self.speed = positive("speed", speed)
        self._allowance = None if allowance is None else positive("allowance", allowance)
        self._left_rad = self._time = 0.0

    def __repr__(self) -> str:
        what = f"{self.angle:g}" if self.angle is not None else f"heading={self.heading:g}"
        return f"Spin({what}, speed={self.speed:g})"

    @property
    def time_allowance(self) -> float:
        """Time after which it has failed [s]."""
        if self._allowance is not None:
            return self._allowance
        return 2.0 * abs(math.pi if self.angle is None else self.angle) / self.speed + 5.0

    def _angle_from(self, yaw: float) -> float:
        """Return how far to turn [rad] from this yaw."""
        return wrap_angle((self.heading or 0.0) - yaw) if self.angle is None else self.angle

    def helps(self, context: BehaviorContext) -> bool:
        """Return whether the robot may make the first turn in which its outline moves by 5 cm."""
        angle = self._angle_from(context.pose.yaw)
        first = math.copysign(min(abs(angle), _FIRST_M / context.robot.circumscribed_radius), angle)
        return _may_begin(context, [Twist2D(0.0, share * first) for share in _SHARES])

    def start(self, context: BehaviorContext) -> None:
        """Begin here.

        Raises:
            BehaviorFailedError: If the robot would touch something before its outline has moved by 5 cm.
        """
        if not self.helps(context):
            raise BehaviorFailedError(_blocked_at(context))
        self._left_rad = self._angle_from(context.pose.yaw)
        self._time = context.time

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return the command for the next control period; None when it has turned that far."""
        self._left_rad -= context.twist.w * (context.time - self._time)
        self._time = context.time
        if abs(self._left_rad) <= _DONE_RAD:
            return None
        speed = _speed_to_stop(abs(self._left_rad), context.robot.limits.angular_acceleration)
        return Twist2D(0.0, math.copysign(min(self.speed, max(speed, _SLOWEST_RADPS)), self._left_rad))


def _may_begin(context: BehaviorContext, motions: list[Twist2D]) -> bool:
    """Return whether the robot may drive from where it is through motions of 1 s each, all of them from there."""
    x, y, yaw = context.pose.as_tuple()
    poses = [(x, y, yaw), *(integrate_twist(x, y, yaw, motion.v, motion.w, 1.0) for motion in motions)]
    padded = context.robot.planar.padded(FOOTPRINT_PADDING_M).outline
    return may_pass(context.costmap, np.array(poses), padded=padded)


def _blocked_at(context: BehaviorContext) -> str:
    return (
        f"blocked at ({context.pose.x:.2f}, {context.pose.y:.2f}): it would touch something within the first "
        f"{_FIRST_M:g} m"
    )


def _speed_to_stop(left: float, deceleration: float) -> float:
    """Return the speed from which a robot stops within `left`."""
    return math.sqrt(2.0 * _BRAKING_SHARE * deceleration * left)


def positive(name: str, value: float) -> float:
    """Return a positive number of an option.

    Raises:
        InputError: If it is none.
    """
    number = check_number(name, value, 0.0, math.inf)
    if not 0.0 < number < math.inf:
        raise InputError(f"{name} must be a positive number, got {value!r}")
    return number


def _read_angle(name: str, value: float | str) -> float:
    if isinstance(value, str):
        try:
            return parse_angle(value)
        except ValueError as error:
            raise InputError(f"{name} is an angle, as 1.57 or 90deg: {error}") from None
    angle = as_number(value, name)
    if not math.isfinite(angle):
        raise InputError(f"{name} must be a finite angle [rad], got {value!r}")
    warn_of_degrees(angle, name, stacklevel=3)
    return angle


CLEAR_M, CLEAR_MPS = 0.1, 0.15
_TURNS_RADPS = (0.0, 0.3, -0.3, 0.7, -0.7)  # of the motions compared, each forwards, backwards and, but for 0, in place
_AHEAD_S = (0.5, 1.0, 2.0)
_LATER_WEIGHT = 0.1  # of the room gained in half a second: of motions that gain as much, the quickest is taken
_DEPTHS_M = (0.0, 0.04, 0.08, 0.12, 0.16)  # by which the outline is shrunk until it touches nothing
_GAIN_M = 0.005  # a tenth of a usual cell
_NEAR_M = 0.05  # a usual cell
_MOST_M = 1.0
_VAIN_S = 0.4
_MOVES_MPS, _MOVES_RADPS = 0.01, 0.02
_STAND = Twist2D()


class DriveClear(Behavior):
    """Drive off what the robot touches or nearly touches, as where something has pushed it against a shelf.

    Of short motions, forward and back, straight, curved and turning in place, it drives the one that takes the
    footprint farthest from everything, until there is room on all sides, or no motion makes more of it. A motion that
    does not move the robot, as a collision monitor stops it, is not tried again.

    Args:
        distance: The room to make [m].
        speed: How fast at most [m/s].

    Raises:
        InputError: If one is not a positive number.
    """

    def __init__(self, distance: float = CLEAR_M, speed: float = CLEAR_MPS) -> None:
        self.distance = positive("distance", distance)
        self.speed = positive("speed", speed)
        self._begin()

    def __repr__(self) -> str:
        return f"DriveClear({self.distance:g}, speed={self.speed:g})"

    @property
    def time_allowance(self) -> float:
        """Time in which it can try every motion, and drive one of them [s]."""
        return 15.0

    def helps(self, context: BehaviorContext) -> bool:
        """Return whether the robot touches something, or nearly does."""
        pose = np.array(context.pose.as_tuple())
        return float(context.costmap.clearance(pose, cap=_MOST_M)[0]) < _NEAR_M

    def start(self, context: BehaviorContext) -> None:
        """Begin here."""
        self._begin()

    def _begin(self) -> None:
        self._moved = False
        self._driving: Twist2D | None = None
        self._vain_s = 0.0
        self._vain: set[Twist2D] = set()

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return the command for the next control period; None where there is room, or no motion makes more of it.

        Raises:
            BehaviorFailedError: If the robot is stuck where it was.
        """
        outline, here = _outline_that_is_free(context)
        if outline is context.costmap.footprint and here >= self.distance:
            return None
        self._watch(context)
        padded = context.robot.planar.padded(FOOTPRINT_PADDING_M).outline
        for command, gain in self._ranked(context, outline, here):
            if gain < _GAIN_M:
                break
            if command in self._vain:
                continue
            limits, dt = context.robot.limits, context.dt
            if can_stop(context.costmap, limits, context.pose, context.twist, command, dt, padded=padded):
                if command != self._driving:
                    self._driving, self._vain_s = command, 0.0
                return command
        if self._moved:
            return None
        raise BehaviorFailedError(
            f"stuck at ({context.pose.x:.2f}, {context.pose.y:.2f}): no motion takes the robot away from what it is at"
        )

    def _watch(self, context: BehaviorContext) -> None:
        """Note whether the motion that is driven moves the robot."""
        if abs(context.twist.v) >= _MOVES_MPS or abs(context.twist.w) >= _MOVES_RADPS:
            self._moved, self._vain_s = True, 0.0
            return
        self._vain_s += context.dt
        if self._driving is not None and self._vain_s >= _VAIN_S:
            self._vain.add(self._driving)

    def _ranked(self, context: BehaviorContext, outline: FloatArray, here: float) -> list[tuple[Twist2D, float]]:
        """Commands, each with the room [m] that it makes, the best one first."""
        commands = self._commands(context)
        x, y, yaw = context.pose.as_tuple()
        poses = np.array([integrate_twist(x, y, yaw, c.v, c.w, time) for c in commands for time in _AHEAD_S])
        room = context.costmap.clearance(poses, cap=_MOST_M, outline=outline).reshape(len(commands), len(_AHEAD_S))
        # What it passes through on the way there counts too: a motion is as good as its best pose before it touches.
        reached = np.where(np.minimum.accumulate(room, axis=1) > 0.0, room, 0.0)
        gains = (reached - here).max(axis=1) + _LATER_WEIGHT * (reached[:, 0] - here)
        return [(commands[index], float(gains[index])) for index in np.argsort(-gains, kind="stable")]

    def _commands(self, context: BehaviorContext) -> list[Twist2D]:
        limits = context.robot.limits
        commands = [Twist2D(v, w) for v in (self.speed, -self.speed, 0.0) for w in _TURNS_RADPS if v or w]
        return [command for command in dict.fromkeys(map(limits.clamp, commands)) if command != _STAND]


def _outline_that_is_free(context: BehaviorContext) -> tuple[FloatArray, float]:
    """Return the footprint, or the largest smaller outline that is free, and its distance from everything else [m]."""
    costmap = context.costmap
    pose = np.array(context.pose.as_tuple())
    for depth in _DEPTHS_M:
        outline = shrink_outline(costmap.footprint, depth) if depth else costmap.footprint
        if outline is None:
            break
        here = float(costmap.clearance(pose, cap=_MOST_M, outline=outline)[0])
        if here > 0.0:
            return outline, here
    raise BehaviorFailedError(
        f"the robot stands in something that is on the map at ({context.pose.x:.2f}, {context.pose.y:.2f})"
    )
