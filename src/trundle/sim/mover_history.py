"""`MoverHistory`: where the movers of a run were, for pictures with their trails."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from trundle.geometry import FloatArray
from trundle.sim.state import MoverState

TRAIL_S = 8.0
"""How far a trail reaches back [s]."""


class ShownMovers(NamedTuple):
    """The movers at one moment of a run.

    Attributes:
        states: State of each mover.
        trails: Trail of each: its places (x, y) [m] in the last eight seconds, the newest last, shape (N, 2).
    """

    states: tuple[MoverState, ...] = ()
    trails: tuple[FloatArray, ...] = ()


class MoverHistory:
    """Collects the movers of a run, one entry for each step."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._steps: list[tuple[MoverState, ...]] = []

    def __len__(self) -> int:
        return len(self._steps[-1]) if self._steps else 0

    def add(self, time: float, movers: Sequence[MoverState]) -> None:
        """Add where they are at a time [s]; without movers nothing is kept. A time that starts over is a new run."""
        if not movers:
            return
        if self._times and time < self._times[-1]:
            self._times.clear()
            self._steps.clear()
        self._times.append(time)
        self._steps.append(tuple(movers))

    def at(self, time: float) -> ShownMovers:
        """Return the movers at the last step up to a time [s], and no movers before the first one."""
        end = bisect.bisect_right(self._times, time + 1e-6)
        if end == 0:
            return ShownMovers()
        first = bisect.bisect_left(self._times, self._times[end - 1] - TRAIL_S)
        places = [[(state.pose.x, state.pose.y) for state in step] for step in self._steps[first:end]]
        trails: FloatArray = np.array(places).transpose(1, 0, 2)
        return ShownMovers(self._steps[end - 1], tuple(trails))

    def trails(self) -> list[FloatArray]:
        """Return the places (x, y) [m] of each mover in the last eight seconds, shape (N, 2)."""
        return list(self.at(self._times[-1]).trails) if self._times else []
