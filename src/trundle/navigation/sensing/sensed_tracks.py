"""`SensedTracks`: what moves around a navigator's robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from trundle.observation import Estimate, Scan, Track
from trundle.robots import Robot
from trundle.tracking import Tracker, TrackerSettings


class SensedTracks:
    """Follows what moves through a navigator's scans; the tracker is made at the first one.

    Args:
        robot: The robot.
        tracking: When something counts as moving; None for the defaults, False to follow nothing.
        warn: Whether to warn of scans that are left out.
    """

    def __init__(self, robot: Robot, tracking: TrackerSettings | Literal[False] | None, *, warn: bool) -> None:
        self._robot, self._warns = robot, warn
        self._settings = None if tracking is False else tracking
        self._is_on = tracking is not False
        self.reset()

    def reset(self) -> None:
        """Forget what was followed."""
        self._tracker: Tracker | None = None
        self._time: float | None = None
        self._may_go_back = True

    def begin(self) -> None:
        """Expect that the time may start over: there is a new goal."""
        self._may_go_back = True

    def update(self, scans: Sequence[Scan], estimate: Estimate) -> tuple[Track, ...]:
        """Take the scans that arrived since the last call; return all tracks, predicted to now, map frame."""
        if not self._is_on or (self._tracker is None and len(scans) == 0):
            return ()
        if self._tracker is None:
            self._tracker = Tracker(self._robot, self._settings, warn=self._warns)
        if self._time is not None and estimate.time < self._time and self._may_go_back:
            self._tracker.reset()
        self._time, self._may_go_back = estimate.time, False
        tracks = self._tracker.update(scans, estimate.time, estimate.odom_pose)
        return tuple(track.seen_from(estimate.T_map_odom) for track in tracks)
