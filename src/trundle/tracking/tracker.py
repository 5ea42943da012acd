"""`Tracker`: follows what moves through scans."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from trundle._core import ScanTracker
from trundle.costmap.layers.scan_placer import PlacedScan, PlacedScans, ScanPlacer
from trundle.errors import InputError, SensorWarning
from trundle.files.yaml_config import Config, NotNegative, Positive
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Estimate, Scan, Track, check_scans
from trundle.robots import Robot
from trundle.values import as_number, check_kind

_BODY_M = 0.02  # around the footprint: hits of the robot's own body scatter by the noise of its lidars


class TrackerSettings(Config):
    """What a tracker takes for something that moves, and how long it remembers it.

    Attributes:
        max_range: Hits farther away than this are left out [m].
        max_size: Larger things are parts of the building [m].
        min_points: Number of points of a scan from which they count as something.
        same_surface: Points of two scans that are this close belong to one surface [m]; several times the noise of the
            lidars.
        acceleration: Acceleration of the movers that are followed [m/s²]: by how much their velocity changes in a
            second, one standard deviation.
        min_speed: Speed below which something stands [m/s].
        confirm_scans: Number of scans that must show that something moves before its track is confirmed.
        hidden_s: How long a confirmed track is kept while something hides it [s], at most: one whose velocity has just
            changed is forgotten earlier.
        aside_s: How long a confirmed track is kept while it is outside the field of view of every lidar [s], at most.
        source_timeout: Scans that are older than this are ignored [s].

    Raises:
        InputError: If a value is out of range.
    """

    max_range: Positive = 15.0
    max_size: Positive = 3.0
    min_points: Annotated[int, Field(ge=2)] = 3
    same_surface: Positive = 0.07
    acceleration: Positive = 0.6
    min_speed: NotNegative = 0.2
    confirm_scans: Annotated[int, Field(ge=1)] = 2
    hidden_s: NotNegative = 0.8
    aside_s: NotNegative = 1.5
    source_timeout: Positive = 1.0


class Tracker:
    """Follows what moves through scans: clusters that are matched to Kalman filters of constant velocity.

    A track is confirmed by what the scans saw through: something moves that is where an earlier scan saw free space,
    or that has left a place through which the scans now see. A wall of which the robot sees another part does neither.

    Args:
        robot: The robot; points inside its footprint are its own body.
        settings: The settings. If None, the defaults apply.
        warn: Whether to warn of scans that are left out; a navigator's layers do that already.

    Attributes:
        settings: The same.
        tracks: The latest, odom frame.

    Raises:
        InputError: If one of these is of another kind.
    """

    def __init__(self, robot: Robot, settings: TrackerSettings | None = None, *, warn: bool = True) -> None:
        check_kind(robot, Robot, "a tracker's robot", "Robot.load(name) makes one")
        self.settings = TrackerSettings() if settings is None else settings
        check_kind(self.settings, TrackerSettings, "a tracker's settings", "TrackerSettings(max_range=10.0) makes them")
        self._body = robot.planar.padded(_BODY_M).outline
        self._placer = ScanPlacer(robot, self.settings.source_timeout, warn=warn)
        self._warns = warn
        self.reset()

    def __repr__(self) -> str:
        moving = sum(track.moving for track in self.tracks)
        return f"Tracker({len(self.tracks)} tracks, {moving} moving)"

    def reset(self) -> None:
        """Forget all scans and tracks, at the start of a run."""
        self._placer.reset()
        self._time: float | None = None
        self._frame: object = None
        self._forget()

    def _forget(self) -> None:
        self._kernel = ScanTracker(_as_numbers(self.settings), np.ascontiguousarray(self._body))
        self._lidars: dict[str, int] = {}
        self.tracks: tuple[Track, ...] = ()

    def update(self, scans: Sequence[Scan], time: float, odometry: Pose2D | Sequence[float]) -> tuple[Track, ...]:
        """Take the scans that arrived by now, and return what is followed, predicted to now, in the odom frame.

        Args:
            scans: Scans since the last call, of each lidar oldest first; the order of the lidars makes no difference.
            time: Now [s], on the clock of the scans.
            odometry: Pose of base_link in the odom frame now.

        Raises:
            InputError: If the time is no finite number, or one of the others is of another kind.

        Warns:
            SensorWarning: If scans are left out, or all tracks are forgotten as the time went back or the pose jumped.
        """
        now = as_number(time, "time of a tracker")
        if not math.isfinite(now):
            raise InputError(f"time must be a finite number of seconds, got {time!r}")
        taken, estimate = check_scans(scans), Estimate(now, Pose2D.of(odometry))
        self._go_on(now)
        return self.take(self._placer.place(taken, estimate))

    def take(self, placed: PlacedScans) -> tuple[Track, ...]:
        """Do as `update` with scans that somebody has placed for several users."""
        now = placed.estimate.time
        self._go_on(now)
        if self._frame is not None and placed.frame is not self._frame:
            self._forget()
        self._time, self._frame = now, placed.frame
        taken = [one for one in placed.scans if not self._placer.is_stale(one.scan, now)]
        for one in sorted(taken, key=lambda one: (one.scan.time, one.scan.lidar)):
            self._see(one)
        self.tracks = self._predict(now)
        return self.tracks

    def _go_on(self, now: float) -> None:
        """Forget all tracks where the time goes back."""
        if self._time is None or now >= self._time:
            return
        if self._warns:
            message = f"the time went back from {self._time:g} s to {now:g} s: all tracks are forgotten"
            warnings.warn(message, SensorWarning, stacklevel=3)
        self.reset()

    def _see(self, placed: PlacedScan) -> None:
        scan = placed.scan
        lidar, mount = self._lidars.setdefault(scan.lidar, len(self._lidars)), scan.mount
        sensor = np.array((mount.x, mount.y, mount.yaw, scan.range_min, scan.range_max))
        self._kernel.see(lidar, scan.time, placed.ranges, scan.angles, placed.poses, sensor)

    def _predict(self, now: float) -> tuple[Track, ...]:
        """Return all that is followed, as it is at a time [s]."""
        ids, flags, states, covariances = self._kernel.tracks(now)
        if len(ids) == 0:
            return ()
        covariances.flags.writeable = False
        return tuple(
            Track(number, now, x, y, vx, vy, covariance, radius, bool(confirmed), bool(moving))
            for number, (confirmed, moving), (x, y, vx, vy, radius), covariance in zip(
                ids.tolist(), flags.tolist(), states.tolist(), covariances, strict=True
            )
        )


def _as_numbers(settings: TrackerSettings) -> FloatArray:
    """Return the settings in the kernel's order."""
    return np.array(
        [
            *(settings.max_range, settings.max_size, settings.min_points, settings.same_surface),
            *(settings.acceleration, settings.min_speed, settings.confirm_scans, settings.hidden_s, settings.aside_s),
        ],
        dtype=np.float64,
    )
