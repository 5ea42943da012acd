"""`Evidence`: what earlier scans of a lidar say about the hits of a new one."""

from __future__ import annotations

from collections import deque

import numpy as np

from support.tracking_oracle.sweep import BoolArray, Sweep
from trundle.tracking.tracker import TrackerSettings

_AGES_S = (0.25, 0.5, 1.0)
_STILL_S = 0.4  # what was there before this is still
_LATE_S = 0.1
_KEPT_S = 1.2


class Evidence:
    """The scans of one lidar of the last second.

    Args:
        settings: Of the tracker.
    """

    def __init__(self, settings: TrackerSettings) -> None:
        self._margin = settings.same_surface
        self._sweeps: deque[Sweep] = deque()

    def add(self, sweep: Sweep) -> None:
        """Take a scan, the newest."""
        self._sweeps.append(sweep)
        while self._sweeps[0].time < sweep.time - _KEPT_S:
            self._sweeps.popleft()

    @property
    def latest(self) -> Sweep | None:
        """The newest scan."""
        return self._sweeps[-1] if self._sweeps else None

    def judge(self, sweep: Sweep) -> tuple[BoolArray, BoolArray]:
        """Which hits of a new scan are where an earlier one saw through, and which belong to what stands still.

        A hit belongs to what stands still if every scan of half a second or a second ago, as far as it saw that place,
        saw a surface there.
        """
        count = len(sweep.points)
        appeared, still = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        for age in _AGES_S:
            before = self._at(sweep.time - age)
            if before is None:
                continue
            through, there = before.compare(sweep.points, self._margin)
            appeared |= through
            if age >= _STILL_S:
                still |= there
        return appeared, still & ~appeared

    def _at(self, time: float) -> Sweep | None:
        """The latest scan from before a time [s], if it is not much older."""
        found = None
        for sweep in self._sweeps:
            if sweep.time > time + 1e-6:
                break
            found = sweep
        return found if found is not None and found.time >= time - _LATE_S else None
