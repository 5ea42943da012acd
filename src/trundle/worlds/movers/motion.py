"""Motions: where a mover is, and how fast, as functions of time."""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, Protocol, TypeAlias, runtime_checkable

import numpy as np

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose2D, arc_lengths, wrap_angle
from trundle.values import as_array, as_number

Repeat: TypeAlias = Literal["once", "loop", "back_and_forth"]

_HEADING_S = 0.25
"""A mover without yaws of its own faces along its motion from this long before to this long after [s]."""

_TURN_S = 1e-3  # the difference in time that its speed of rotation is taken from
_STEPS = 16  # straight pieces from one point of a curved path to the next
_STILL = 1e-9  # [m]

Interpolation: TypeAlias = Literal["linear", "catmull_rom"]


class Curve:
    """A curve through points at times; before the first it stays there, and after the last, too.

    A Catmull-Rom spline (Catmull and Rom, A Class of Local Interpolating Splines, 1974) as cubic Hermite pieces: the
    velocity at a point is that from the one before to the one after. At the ends of an open curve it is that of the
    only piece there; a closed one goes on as it began.

    Args:
        times: Times of the points [s], ascending.
        points: Shape (N, D).
        interpolation: Between the points.
        closed: Whether the last point is the first again, and the spline is smooth there.
    """

    def __init__(
        self, times: Sequence[float], points: FloatArray, interpolation: Interpolation, *, closed: bool
    ) -> None:
        self._times = [float(time) for time in times]
        self._points: list[list[float]] = points.tolist()
        self._slopes: list[list[float]] | None = None
        if interpolation == "catmull_rom" and len(points) > 2:
            self._slopes = _slopes(np.asarray(times, dtype=np.float64), points, closed=closed).tolist()

    def at(self, time: float) -> tuple[list[float], list[float]]:
        """Return the position and velocity at a time [s]."""
        times, points = self._times, self._points
        if time < times[0] or len(times) == 1:
            return points[0], [0.0] * len(points[0])
        if time >= times[-1]:
            return points[-1], [0.0] * len(points[0])
        index = bisect.bisect_right(times, time) - 1
        span = times[index + 1] - times[index]
        s = (time - times[index]) / span
        first, last = points[index], points[index + 1]
        if self._slopes is None:
            place = [a + s * (b - a) for a, b in zip(first, last, strict=True)]
            return place, [(b - a) / span for a, b in zip(first, last, strict=True)]
        starting, ending = self._slopes[index], self._slopes[index + 1]
        s2, s3 = s * s, s * s * s
        place, velocity = [], []
        for a, b, m, n in zip(first, last, starting, ending, strict=True):
            place.append(
                (2.0 * s3 - 3.0 * s2 + 1.0) * a
                + (s3 - 2.0 * s2 + s) * span * m
                + (3.0 * s2 - 2.0 * s3) * b
                + (s3 - s2) * span * n
            )
            velocity.append(6.0 * (s2 - s) * (a - b) / span + (3.0 * s2 - 4.0 * s + 1.0) * m + (3.0 * s2 - 2.0 * s) * n)
        return place, velocity


def _slopes(times: FloatArray, points: FloatArray, *, closed: bool) -> FloatArray:
    """Return velocities of a Catmull-Rom spline at its points, shape (N, D)."""
    slopes = np.empty_like(points)
    slopes[1:-1] = (points[2:] - points[:-2]) / (times[2:] - times[:-2])[:, None]
    if closed:
        span = (times[1] - times[0]) + (times[-1] - times[-2])
        slopes[0] = slopes[-1] = (points[1] - points[-2]) / span
    else:
        slopes[0] = (points[1] - points[0]) / (times[1] - times[0])
        slopes[-1] = (points[-1] - points[-2]) / (times[-1] - times[-2])
    return slopes


class PlanarState(NamedTuple):
    """Pose and velocity in the map frame.

    Attributes:
        x, y, yaw: The pose [m, m, rad].
        vx, vy, w: Its derivatives [m/s, m/s, rad/s].
    """

    x: float
    y: float
    yaw: float
    vx: float
    vy: float
    w: float

    @property
    def pose(self) -> Pose2D:
        """The pose."""
        return Pose2D(self.x, self.y, wrap_angle(self.yaw))


@runtime_checkable
class Motion(Protocol):
    """A place for every time; the same time gives the same place."""

    @property
    def duration(self) -> float:
        """Time [s] after which the motion repeats, or has ended."""
        ...

    def at(self, time: float) -> PlanarState:
        """Return the pose and velocity at a time since the start of the run [s]."""
        ...


@dataclass(frozen=True, slots=True)
class Waypoints:
    """Points that are passed at times.

    Before the first time it stands at the first point. Without yaws it faces along its motion.

    Attributes:
        points: (t, x, y) or (t, x, y, yaw) each [s, m, m, rad], map frame; the times increase, from 0 or later.
        interpolation: "linear", straight and at constant speed from one to the next; or "catmull_rom", a smooth curve.
        repeat: "once" stays at the last point; "loop" starts again at the first one (where that is another place, it
            jumps there); "back_and_forth" returns as it came, in reverse.
        phase_s: How far the motion is when a run begins [s].

    Raises:
        WorldError: If a number is not finite, the times do not increase, or an option is none of these.
    """

    points: tuple[tuple[float, ...], ...]
    interpolation: Interpolation = "linear"
    repeat: Repeat = "once"
    phase_s: float = 0.0
    _track: _Track = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        points = _read_points(self.points, "waypoints", (3, 4), "(t, x, y) or (t, x, y, yaw)")
        _check_options(self.interpolation, self.repeat)
        if not 0.0 <= as_number(self.phase_s, "phase_s") < math.inf:
            raise WorldError(f"phase_s must be a time of 0 s or later, got {self.phase_s}")
        times = points[:, 0]
        if times[0] < 0.0:
            raise WorldError(f"the first waypoint is at {times[0]:g} s; a run begins at 0")
        late = np.flatnonzero(np.diff(times) <= 0.0)
        if len(late):
            first = int(late[0])
            raise WorldError(
                f"the times of waypoints must increase: number {first + 2} is at {times[first + 1]:g} s, and the one "
                f"before it at {times[first]:g} s"
            )
        object.__setattr__(self, "points", tuple(tuple(row) for row in points.tolist()))
        if points.shape[1] == 4:
            points[:, 3] = np.unwrap(points[:, 3])
        object.__setattr__(self, "_track", _Track(times.tolist(), points[:, 1:], self.interpolation, self.repeat))

    @property
    def duration(self) -> float:
        """Time [s] after which the motion repeats, or has ended."""
        return self._track.duration

    def at(self, time: float) -> PlanarState:
        """Return the pose and velocity at a time since the start of the run [s]."""
        return self._track.at(time + self.phase_s)


@dataclass(frozen=True, slots=True)
class AlongPath:
    """A path that is followed at constant speed, facing along it.

    Attributes:
        points: (x, y) each [m], map frame, two or more.
        speed: Speed along the path [m/s].
        interpolation: "linear", or "catmull_rom": a smooth curve through the points.
        repeat: "once" stays at the last point; "loop" continues to the first one; "back_and_forth" returns in reverse.
        start_s: When it starts [s].

    Raises:
        WorldError: If a number is not finite, the path has no length, the speed is not positive, or an option is none
            of these.
    """

    points: tuple[tuple[float, ...], ...]
    speed: float
    interpolation: Interpolation = "linear"
    repeat: Repeat = "once"
    start_s: float = 0.0
    _track: _Track = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        points = _read_points(self.points, "a path", (2,), "(x, y)")
        _check_options(self.interpolation, self.repeat)
        if not as_number(self.speed, "the speed of a mover") > 0.0 or not math.isfinite(self.speed):
            raise WorldError(f"the speed of a mover must be a positive number of m/s, got {self.speed}")
        if not 0.0 <= as_number(self.start_s, "start_s") < math.inf:
            raise WorldError(f"start_s must be a time of 0 s or later, got {self.start_s}")
        object.__setattr__(self, "points", tuple(tuple(row) for row in points.tolist()))
        if self.repeat == "loop" and not np.array_equal(points[0], points[-1]):
            points = np.vstack([points, points[:1]])
        points = points[np.r_[True, np.hypot(*np.diff(points, axis=0).T) > _STILL]]
        if len(points) < 2:
            raise WorldError("a path that a mover follows needs two points or more that are not the same")
        if self.interpolation == "catmull_rom":
            points = _refine(points)
        times = self.start_s + arc_lengths(points) / self.speed
        object.__setattr__(self, "_track", _Track(times.tolist(), points, "linear", self.repeat))

    @property
    def duration(self) -> float:
        """Time [s] after which the motion repeats, or has ended."""
        return self._track.duration

    def at(self, time: float) -> PlanarState:
        """Return the pose and velocity at a time since the start of the run [s]."""
        return self._track.at(time)


class _Track:
    """A curve in time, which ends, starts again or turns back."""

    def __init__(self, times: list[float], points: FloatArray, interpolation: Interpolation, repeat: Repeat) -> None:
        closed = repeat == "loop" and bool(np.array_equal(points[0, :2], points[-1, :2]))
        self._curve = Curve(times, points, interpolation, closed=closed)
        self._begin, self._length = times[0], times[-1] - times[0]
        self._repeat, self._closed = repeat, closed
        self._yaws = points.shape[1] == 3
        self._facings = None if self._yaws else _facings(points)
        self._times = times
        self.duration = self._begin + self._length * (2.0 if repeat == "back_and_forth" else 1.0)

    def at(self, time: float) -> PlanarState:
        along, sign = self._along(time)
        place, velocity = self._curve.at(along)
        if self._yaws:
            x, y, yaw = place
            vx, vy, w = velocity
        else:
            (x, y), (vx, vy) = place, velocity
            yaw = self._heading(along)
            w = 0.0
            if vx or vy:
                w = wrap_angle(self._heading(along + _TURN_S) - self._heading(along - _TURN_S)) / (2.0 * _TURN_S)
        return PlanarState(x, y, yaw, sign * vx, sign * vy, sign * w)

    def _along(self, time: float) -> tuple[float, float]:
        """Return the time on the curve, and whether it is followed forwards (1) or backwards (−1)."""
        since = time - self._begin
        if since <= 0.0 or self._length <= 0.0 or self._repeat == "once":
            return time, 1.0
        if self._repeat == "loop":
            return self._begin + math.fmod(since, self._length), 1.0
        since = math.fmod(since, 2.0 * self._length)
        if since <= self._length:
            return self._begin + since, 1.0
        return self._begin + 2.0 * self._length - since, -1.0

    def _heading(self, along: float) -> float:
        """Return the direction of the curve at a time, smoothed at corners."""
        before, after = along - _HEADING_S, along + _HEADING_S
        if self._closed:
            end = self._begin + self._length
            before = before + self._length if before < self._begin else before
            after = after - self._length if after > end else after
        first, last = self._curve.at(before)[0], self._curve.at(after)[0]
        dx, dy = last[0] - first[0], last[1] - first[1]
        if math.hypot(dx, dy) > _STILL:
            return math.atan2(dy, dx)
        facings = self._facings or [0.0]
        index = int(np.searchsorted(self._times, along, side="right")) - 1
        return facings[min(max(index, 0), len(facings) - 1)]


def _facings(points: FloatArray) -> list[float]:
    """Return the heading on each piece of a curve: along it; where it stands, as before, and at first as later."""
    steps = np.diff(points[:, :2], axis=0)
    moved = np.flatnonzero(np.hypot(steps[:, 0], steps[:, 1]) > _STILL)
    if len(moved) == 0:
        return [0.0]
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    last = np.maximum(np.searchsorted(moved, np.arange(len(steps)), side="right") - 1, 0)
    return angles[moved[last]].tolist()


def _refine(points: FloatArray) -> FloatArray:
    """Return points close to one another on the smooth curve through points, shape (N, 2)."""
    times = arc_lengths(points)
    closed = bool(np.array_equal(points[0], points[-1]))
    curve = Curve(times.tolist(), points, "catmull_rom", closed=closed)
    count = _STEPS * (len(points) - 1)
    at = np.interp(np.arange(count + 1) / _STEPS, np.arange(len(points)), times)
    return np.array([curve.at(float(time))[0] for time in at])


def _read_points(points: Sequence[Sequence[float]], what: str, widths: tuple[int, ...], form: str) -> FloatArray:
    try:
        array = as_array(points, np.float64, what, WorldError)
    except WorldError:
        raise WorldError(f"{what} must be {form}, all alike") from None
    if array.ndim != 2 or len(array) == 0 or array.shape[1] not in widths:
        raise WorldError(f"{what} must be {form}, all alike, got an array of shape {array.shape}")
    if not np.isfinite(array).all():
        raise WorldError(
            f"{what} must be finite numbers; number {int(np.argwhere(~np.isfinite(array))[0][0]) + 1} is not"
        )
    return array


def _check_options(interpolation: str, repeat: str) -> None:
    if interpolation not in ("linear", "catmull_rom"):
        raise WorldError(f'interpolation is {interpolation!r}; use "linear" or "catmull_rom"')
    if repeat not in ("once", "loop", "back_and_forth"):
        raise WorldError(f'repeat is {repeat!r}; use "once", "loop" or "back_and_forth"')
