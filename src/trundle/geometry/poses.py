"""Poses, twists and angles: SI units, radians, REP-103 axes (x forward, y left, z up, yaw counter-clockwise)."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Self

import numpy as np
import numpy.typing as npt

from trundle.errors import AngleWarning, InputError
from trundle.values import as_array, as_number

_DEGREES = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg|°|rad)\s*", re.ASCII)

FORM = "radians like 1.57, or degrees like 90deg"
"""The accepted notations of an angle, for messages."""


def parse_angle(text: str) -> float:
    """Read an angle [rad]: a plain number, or a number with the unit `rad`, `deg` or `°`.

    Raises:
        ValueError: If it is anything else, or not finite.
    """
    found = _DEGREES.fullmatch(text)
    number = float(text if found is None else found[1])
    angle = math.radians(number) if found is not None and found[2] != "rad" else number
    if not math.isfinite(angle):
        raise ValueError(f"{text!r} is not finite")
    return angle


def is_in_degrees(angle: float) -> bool:
    """Return whether an angle [rad] is more than one turn, so it was probably meant in degrees."""
    return not -math.tau <= angle <= math.tau


def describe_degrees(angle: float) -> str:
    """Return the message for an angle that `is_in_degrees`."""
    return (
        f"{angle:.12g} is more than one turn, and angles are in radians: for degrees write {angle:.12g}deg "
        f"in a file or an option, or {math.radians(angle):.6g}"
    )


def warn_of_degrees(angle: float, what: str, *, stacklevel: int = 1) -> None:
    """Warn if an angle [rad] was probably meant in degrees; the message begins with `what`."""
    if is_in_degrees(angle):
        warnings.warn(f"{what} {describe_degrees(angle)}", AngleWarning, stacklevel=stacklevel + 1)


FloatArray = npt.NDArray[np.float64]
"""An array of float64; each use states its shape and unit."""

_HALF_TURN = math.pi
_put = object.__setattr__


def wrap_angle(angle: float) -> float:
    """Wrap an angle [rad] to (−π, π]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def wrap_angles(angles: npt.ArrayLike) -> FloatArray:
    """Wrap angles [rad], any shape, to (−π, π]."""
    values = as_array(angles, np.float64, "angles", copy=False)
    return -((-values + np.pi) % (2.0 * np.pi) - np.pi)


@dataclass(frozen=True, slots=True, init=False)
class Pose2D:
    """A pose in the plane: x, y [m], yaw [rad] wrapped to (−π, π]. As a transform it reads right to left: `T_map_base`.

    Raises:
        InputError: If a number is NaN or infinite.

    Warns:
        AngleWarning: If |yaw| is more than one turn, which suggests degrees.
    """

    x: float
    y: float
    yaw: float = 0.0

    def __init__(self, x: float, y: float, yaw: float = 0.0) -> None:
        # Made a dozen times in a control period: numbers that are right already are not converted.
        is_plain = type(x) is type(y) is type(yaw) is float and isfinite(x) and isfinite(y)
        if not (is_plain and -_HALF_TURN < yaw <= _HALF_TURN):
            x, y, yaw = as_number(x, "x of a pose"), as_number(y, "y of a pose"), as_number(yaw, "yaw of a pose")
            if not (isfinite(x) and isfinite(y) and isfinite(yaw)):
                raise InputError(f"a pose needs finite numbers, got x={x}, y={y}, yaw={yaw}")
            warn_of_degrees(yaw, "yaw", stacklevel=2)
            yaw = wrap_angle(yaw)
        _put(self, "x", x)
        _put(self, "y", y)
        _put(self, "yaw", yaw)

    @classmethod
    def of(cls, value: Pose2D | Sequence[float]) -> Pose2D:
        """Take a pose, or (x, y), or (x, y, yaw).

        Raises:
            InputError: If it is anything else.
        """
        if isinstance(value, Pose2D):
            return value
        try:
            numbers = list(value)
        except TypeError:
            raise InputError(f"a pose is (x, y) or (x, y, yaw), got {value!r}") from None
        if len(numbers) not in (2, 3):
            raise InputError(f"a pose is (x, y) or (x, y, yaw), got {len(numbers)} numbers: {numbers}")
        return cls(*numbers)

    def as_tuple(self) -> tuple[float, float, float]:
        """Return (x, y, yaw)."""
        return (self.x, self.y, self.yaw)

    def __matmul__(self, other: Pose2D) -> Pose2D:
        """Compose: `T_a_c = T_a_b @ T_b_c`."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            self.yaw + other.yaw,
        )

    def inverse(self) -> Pose2D:
        """Return `T_b_a` of `T_a_b`."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, -self.yaw)

    def transform_points(self, points: npt.ArrayLike) -> FloatArray:
        """Transform points [m], shape (N, 2), from this pose's frame to the frame it is given in."""
        array = as_array(points, np.float64, "points", copy=False)
        if array.shape[-1:] != (2,):
            raise InputError(f"points in the plane have shape (N, 2), got {array.shape}")
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return array @ np.array([[cos, sin], [-sin, cos]]) + (self.x, self.y)

    def distance_to(self, other: Pose2D | Goal) -> float:
        """Return the distance [m] between the two positions."""
        return math.hypot(other.x - self.x, other.y - self.y)


class Goal(tuple[float, ...]):
    """A goal for the robot: x, y [m] and a yaw [rad] in the map frame, or any yaw.

    A goal is a tuple, equal to the one that users write and records hold: (x, y, yaw), or (x, y) for any yaw.
    `Goal(x, y)` and `Goal(x, y, None)` accept any yaw. Code that is written for a pose can read a goal as well, by `x`,
    `y`, `yaw`, `as_tuple()` and `distance_to`; for everything else there is `pose`.

    Raises:
        InputError: If a number is NaN or infinite.

    Warns:
        AngleWarning: As `Pose2D`.
    """

    __slots__ = ()

    def __new__(cls, x: float, y: float, yaw: float | None = None) -> Self:
        """Check the numbers; see the class."""
        if yaw is not None:
            yaw = as_number(yaw, "yaw of a goal")
            warn_of_degrees(yaw, "yaw", stacklevel=2)
            yaw = wrap_angle(yaw) if math.isfinite(yaw) else yaw
        pose = Pose2D(x, y, 0.0 if yaw is None else yaw)
        return super().__new__(cls, (pose.x, pose.y) if yaw is None else pose.as_tuple())

    @classmethod
    def of(cls, value: Pose2D | Sequence[float]) -> Goal:
        """Take a goal, (x, y) for any yaw, (x, y, yaw), or a pose with its yaw.

        Raises:
            InputError: If it is anything else.
        """
        if isinstance(value, Goal):
            return value
        pose = Pose2D.of(value)
        yaw_free = not isinstance(value, Pose2D) and len(value) == 2
        return cls(pose.x, pose.y, None if yaw_free else pose.yaw)

    @property
    def x(self) -> float:
        """[m]."""
        return self[0]

    @property
    def y(self) -> float:
        """[m]."""
        return self[1]

    @property
    def yaw(self) -> float:
        """Yaw [rad]; 0 where any is accepted."""
        return 0.0 if self.yaw_free else self[2]

    @property
    def yaw_free(self) -> bool:
        """Whether any yaw is accepted."""
        return len(self) == 2

    @property
    def pose(self) -> Pose2D:
        """The goal as a pose; its yaw is 0 where any is accepted."""
        return Pose2D(*self)

    def as_tuple(self) -> tuple[float, float, float]:
        """Return (x, y, yaw), as of a pose; the goal itself is the tuple (x, y) where any yaw is accepted."""
        return (self.x, self.y, self.yaw)

    def distance_to(self, other: Pose2D | Goal) -> float:
        """Return the distance [m] between the two positions."""
        return self.pose.distance_to(other)

    def __getnewargs__(self) -> tuple[float, ...]:  # type: ignore[override]
        return tuple(self)

    def __repr__(self) -> str:
        yaw = "" if self.yaw_free else f", yaw={self[2]}"
        return f"Goal(x={self.x}, y={self.y}{yaw})"


@dataclass(frozen=True, slots=True, init=False)
class Twist2D:
    """A planar twist in base_link: v [m/s] forward, w [rad/s] counter-clockwise.

    Raises:
        InputError: If a number is NaN or infinite.
    """

    v: float = 0.0
    w: float = 0.0

    def __init__(self, v: float = 0.0, w: float = 0.0) -> None:
        if not type(v) is type(w) is float:
            v, w = as_number(v, "v of a twist"), as_number(w, "w of a twist")
        if not (isfinite(v) and isfinite(w)):
            raise InputError(f"a twist needs finite numbers, got v={v}, w={w}")
        _put(self, "v", v)
        _put(self, "w", w)

    def integrate(self, pose: Pose2D, dt: float) -> Pose2D:
        """Return the pose after driving this twist for `dt` [s] from `pose`, along the exact arc."""
        x, y, yaw = integrate_twist(pose.x, pose.y, pose.yaw, self.v, self.w, dt)
        return Pose2D(x, y, wrap_angle(yaw))


def integrate_twist(x: float, y: float, yaw: float, v: float, w: float, dt: float) -> tuple[float, float, float]:
    """Drive a constant twist (v [m/s], w [rad/s]) for `dt` [s] along its exact arc; the yaw is not wrapped."""
    turn = w * dt
    along, across = arc_shares(turn)
    cos, sin = math.cos(yaw), math.sin(yaw)
    step = v * dt
    return x + step * (cos * along - sin * across), y + step * (sin * along + cos * across), yaw + turn


def arc_shares(turn: float) -> tuple[float, float]:
    """Return shares of its length that an arc which turns by `turn` [rad] leads ahead and to the left."""
    # sin(a)/a and (1 - cos(a))/a, by series for small angles, where they would cancel.
    if abs(turn) < 1e-6:
        return 1.0 - turn * turn / 6.0, turn / 2.0
    return math.sin(turn) / turn, (1.0 - math.cos(turn)) / turn


def path_length(points: npt.ArrayLike) -> float:
    """Return the length [m] of a polyline, shape (N, 2); further columns are ignored."""
    return float(_steps(points).sum())


def arc_lengths(points: npt.ArrayLike) -> FloatArray:
    """Return the length [m] of a polyline, shape (N, 2) with N ≥ 1, up to each point, shape (N,); the first is 0."""
    return np.concatenate([[0.0], np.cumsum(_steps(points))])


def _steps(points: npt.ArrayLike) -> FloatArray:
    array = as_array(points, np.float64, "points", copy=False)
    if len(array) < 2:
        return np.zeros(0)
    steps = np.diff(array[:, :2], axis=0)
    return np.hypot(steps[:, 0], steps[:, 1])


def exactly(values: Sequence[float], count: int, what: str) -> list[float]:
    """Take exactly `count` numbers."""
    numbers = as_array(values, np.float64, what)
    if numbers.shape != (count,):
        raise InputError(f"{what} has {count} numbers, got shape {numbers.shape}")
    return numbers.tolist()


def format_pose(pose: Pose2D) -> str:
    """Return `(x, y, yaw)` in a few digits, for display."""
    return f"({pose.x:.6g}, {pose.y:.6g}, {pose.yaw:.4g})"
