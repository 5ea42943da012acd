"""What a robot observes, and where it believes to be: `Scan`, `Observation`, `Estimate`, `Hypothesis` and `Track`.

None of them holds the truth of a simulation. Frames are those of REP-105: `map`, `odom` (continuous, but it drifts) and
`base_link`.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, cast, get_args

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.values import as_array, as_number, check_kind

_KEPT_S = 10.0  # scans are older than this only if they are useless
_FORWARD_S = 0.1  # a scan may end a little after the last estimate; farther ahead a motion is anybody's guess
_SAME_FRAME = Pose2D(0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """One turn of a planar lidar, as the sensor reports it: no pose of the robot is in it.

    Where its beams began is known from the estimated pose at the scan's own time. Ranges follow REP-117: infinity for a
    beam without a return, minus infinity for one that met something closer than `range_min`, NaN for no measurement.

    Attributes:
        lidar: Name of the lidar.
        time: When its first beam was measured [s], on the clock of the run.
        mount: Pose of the sensor in base_link.
        height: Height of its beams above the floor [m].
        angles: Directions of the beams in the sensor's frame [rad], shape (N,), read-only.
        ranges: [m], shape (N,), read-only.
        range_min, range_max: Shortest and longest range that it measures [m].
        time_increment: Time from one beam to the next [s]; 0 where all are measured at once.

    Raises:
        InputError: If angles and ranges are not of one length, a direction is not finite, a range is negative but
            finite, or one of the other numbers is out of range.
    """

    lidar: str
    time: float
    mount: Pose2D
    height: float
    angles: FloatArray
    ranges: FloatArray
    range_min: float
    range_max: float
    time_increment: float = 0.0

    def __post_init__(self) -> None:
        what = f"scan of lidar {self.lidar!r}"
        for name in ("angles", "ranges"):
            values = as_array(getattr(self, name), np.float64, f"{name} of the {what}")
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        if self.angles.ndim != 1 or self.angles.shape != self.ranges.shape:
            raise InputError(
                f"{what}: it needs as many ranges as angles, in one dimension; got shapes {self.ranges.shape} and "
                f"{self.angles.shape}"
            )
        if not np.isfinite(self.angles).all():
            raise InputError(f"{what}: the angle of a beam is not finite")
        if (self.ranges[np.isfinite(self.ranges)] < 0.0).any():
            raise InputError(
                f"{what}: a range is negative; use minus infinity for a beam that met something too close, NaN for "
                "one without a measurement (REP-117)"
            )
        for name in ("time", "height", "range_min", "range_max", "time_increment"):
            number = as_number(getattr(self, name), f"{name} of the {what}")
            if not math.isfinite(number) or (number < 0.0 and name != "time"):
                raise InputError(f"{what}: {name} must be a finite number of 0 or more, got {number}")
            object.__setattr__(self, name, number)
        if not self.range_min < self.range_max:
            raise InputError(f"{what}: range_min {self.range_min:g} m is not below range_max {self.range_max:g} m")
        check_kind(self.mount, Pose2D, f"mount of the {what}", "Pose2D(x, y, yaw) in base_link")

    def __repr__(self) -> str:
        hits = int(np.isfinite(self.ranges).sum())
        return f"Scan({self.lidar!r}, {self.time:g} s, {len(self.ranges)} beams, {hits} hits)"

    def points(self) -> FloatArray:
        """Return where its beams with a return ended, base_link at the scan's time [m], shape (hits, 2).

        Ranges outside of `range_min` to `range_max` are left out.
        """
        hit = (self.ranges >= self.range_min) & (self.ranges <= self.range_max)
        angles, ranges = self.angles[hit] + self.mount.yaw, self.ranges[hit]
        points = np.empty((len(ranges), 2))
        points[:, 0] = self.mount.x + ranges * np.cos(angles)
        points[:, 1] = self.mount.y + ranges * np.sin(angles)
        return points


def make_scan(
    lidar: str,
    time: float,
    mount: Pose2D,
    height: float,
    angles: FloatArray,
    ranges: FloatArray,
    range_min: float,
    range_max: float,
    time_increment: float = 0.0,
) -> Scan:
    """Return a scan of values that are known to be right: they are neither checked nor copied.

    The arguments are the attributes of a `Scan`; the arrays become read-only.
    """
    angles.flags.writeable = ranges.flags.writeable = False
    scan, put = object.__new__(Scan), object.__setattr__
    put(scan, "lidar", lidar)
    put(scan, "time", time)
    put(scan, "mount", mount)
    put(scan, "height", height)
    put(scan, "angles", angles)
    put(scan, "ranges", ranges)
    put(scan, "range_min", range_min)
    put(scan, "range_max", range_max)
    put(scan, "time_increment", time_increment)
    return scan


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """All that a robot knows of its surroundings and its motion at one moment.

    Attributes:
        time: Now [s], on the clock of the run.
        twist: How the robot moves, by its odometry; base_link.
        odometry: Pose of base_link in the odom frame.
        scans: Scans that arrived since the last observation, oldest first; each with its own time.
    """

    time: float
    twist: Twist2D
    odometry: Pose2D
    scans: tuple[Scan, ...] = ()


LocalizationState: TypeAlias = Literal["localized", "ambiguous", "lost"]
"""What a localizer says of its estimate: `localized`, `ambiguous` where several places fit what the robot sees, and
`lost` where none does."""

LOCALIZATION_STATES: tuple[LocalizationState, ...] = get_args(LocalizationState)
"""All of them; where a state is a number, such as in a `Trajectory`, it is the index in here."""


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """One of the places where a robot may be.

    Attributes:
        pose: Pose of base_link in the map frame.
        weight: How likely the localizer takes it to be, 0 to 1.
        covariance: Covariance of (x, y, yaw) [m², rad²], shape (3, 3), or None if it is not known.
    """

    pose: Pose2D
    weight: float
    covariance: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """Where a robot believes to be.

    Attributes:
        time: Time of the estimate [s].
        pose: Pose of base_link in the map frame.
        covariance: Covariance of (x, y, yaw) [m², rad²], shape (3, 3), or None if it is not known.
        T_map_odom: Pose of the odom frame in the map frame: what a localizer corrects.
        state: Whether the robot is there: see `LocalizationState`. A localizer that cannot tell says `localized`.
        hypotheses: The places where it may be, most likely first; empty where the localizer has only the pose.
        particles: (x, y, yaw, weight) of the particles [m, rad, 1], map frame, shape (N, 4), read-only; None where the
            localizer has none.
    """

    time: float
    pose: Pose2D
    covariance: FloatArray | None = None
    T_map_odom: Pose2D = _SAME_FRAME
    state: LocalizationState = "localized"
    hypotheses: tuple[Hypothesis, ...] = ()
    particles: FloatArray | None = None

    @property
    def odom_pose(self) -> Pose2D:
        """Pose of base_link in the odom frame."""
        T_map_odom = self.T_map_odom
        if T_map_odom is _SAME_FRAME or T_map_odom == _SAME_FRAME:
            return self.pose
        return T_map_odom.inverse() @ self.pose


def describe_state(estimate: Estimate) -> str:
    """Return what a localizer says of its estimate in words: "localized", "ambiguous: 3 places" or "lost"."""
    places = len(estimate.hypotheses)
    return f"ambiguous: {places} places" if estimate.state == "ambiguous" and places > 1 else estimate.state


def pick_particles(particles: FloatArray, most: int) -> FloatArray:
    """Return so many particles at most, shape (N, 4): the same share of each place, by the weights."""
    if len(particles) <= most:
        return particles
    sums = np.cumsum(particles[:, 3])
    if not (np.isfinite(sums[-1]) and sums[-1] > 0.0):
        return particles[np.linspace(0, len(particles) - 1, most).astype(int)]
    at = np.searchsorted(sums, (np.arange(most) + 0.5) / most * sums[-1])
    return particles[np.unique(np.minimum(at, len(particles) - 1))]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Something that a tracker follows from scan to scan.

    Attributes:
        id: Number of the track; one track keeps it.
        time: Time of the state [s], on the clock of the scans.
        x, y: Centre [m], in the frame of the tracks that it belongs to: odom from a tracker, map from a navigator.
        vx, vy: Velocity of the centre in that frame [m/s].
        covariance: Covariance of (x, y, vx, vy) [m², m²/s, m²/s²], shape (4, 4), read-only.
        radius: Radius of a circle around the centre that has the width that was seen [m].
        confirmed: Whether scans have shown that it moves: it entered space, or left space, that was seen free. What is
            not confirmed may be part of a wall.
        moving: Whether it is confirmed and moves now.
    """

    id: int
    time: float
    x: float
    y: float
    vx: float
    vy: float
    covariance: FloatArray
    radius: float
    confirmed: bool = False
    moving: bool = False

    @property
    def speed(self) -> float:
        """Speed of the centre [m/s]."""
        return math.hypot(self.vx, self.vy)

    def at(self, time: float) -> tuple[float, float]:
        """Return where its centre is at a time [s], at constant velocity."""
        seconds = time - self.time
        return self.x + seconds * self.vx, self.y + seconds * self.vy

    def seen_from(self, frame: Pose2D) -> Track:
        """Return the track in the frame where its own has this pose: with `T_map_odom`, that is the map frame."""
        if frame == _SAME_FRAME:
            return self
        cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
        turn = np.array(((cos, -sin, 0.0, 0.0), (sin, cos, 0.0, 0.0), (0.0, 0.0, cos, -sin), (0.0, 0.0, sin, cos)))
        covariance = turn @ self.covariance @ turn.T
        covariance.flags.writeable = False
        return Track(
            self.id,
            self.time,
            frame.x + cos * self.x - sin * self.y,
            frame.y + sin * self.x + cos * self.y,
            cos * self.vx - sin * self.vy,
            sin * self.vx + cos * self.vy,
            covariance,
            self.radius,
            self.confirmed,
            self.moving,
        )


class PoseBuffer:
    """Poses of the last ten seconds by their times, to place what was measured in the past.

    Poses between two times are interpolated; up to 0.1 s after the last one the motion is continued.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all poses."""
        self._times: list[float] = []
        self._poses: list[Pose2D] = []
        self._last_answer: tuple[float, Pose2D] | None = None

    def add(self, time: float, pose: Pose2D) -> None:
        """Add the newest pose.

        Raises:
            InputError: If the time [s] is not after the last one.
        """
        if self._times and not time > self._times[-1]:
            raise InputError(f"times must increase: a pose at {time:g} s came after one at {self._times[-1]:g} s")
        self._times.append(time)
        self._poses.append(pose)
        self._last_answer = None
        if self._times[0] < time - 2.0 * _KEPT_S:
            first = bisect.bisect_left(self._times, time - _KEPT_S)
            del self._times[:first], self._poses[:first]

    @property
    def last_time(self) -> float | None:
        """Time of the newest pose [s], or None without a pose."""
        return self._times[-1] if self._times else None

    def at(self, time: float) -> Pose2D | None:
        """Return the pose at a time [s]; None before the first pose and more than 0.1 s after the last one."""
        if self._last_answer is not None and self._last_answer[0] == time:  # lidars often measure at one time
            return self._last_answer[1]
        times = self._times
        if not times or time < times[0] - 1e-9 or time > times[-1] + _FORWARD_S:
            return None
        if len(times) == 1:
            return self._poses[0]
        after = min(max(1, bisect.bisect_left(times, time)), len(times) - 1)
        first, last = self._poses[after - 1], self._poses[after]
        share = (time - times[after - 1]) / (times[after] - times[after - 1])
        pose = Pose2D(
            first.x + share * (last.x - first.x),
            first.y + share * (last.y - first.y),
            wrap_angle(first.yaw + share * wrap_angle(last.yaw - first.yaw)),
        )
        self._last_answer = time, pose
        return pose


def check_scans(scans: Sequence[Scan]) -> tuple[Scan, ...]:
    """Return scans that come from outside, checked.

    Raises:
        InputError: If they are no sequence of scans.
    """
    if type(scans) is tuple:
        for scan in scans:
            if type(scan) is not Scan:
                break
        else:
            return scans
    advice = "give a list of them, scans=[scan]"
    check_kind(scans, Sequence, "scans", advice)
    for scan in scans:
        check_kind(cast("object", scan), Scan, "a scan", advice)
    return tuple(scans)
