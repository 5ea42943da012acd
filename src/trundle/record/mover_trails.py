"""`MoverTrails`: where the movers of a run were, for its pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry import FloatArray
from trundle.pictures.colors import WARNING
from trundle.record.map_view import MapView
from trundle.sim import MoverState

_TRAIL_S = 8.0
_FAINT, _FILL = 200, 70


class MoverTrails:
    """Collects the movers of a run, one entry for each step."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._steps: list[tuple[MoverState, ...]] = []

    def __len__(self) -> int:
        return len(self._steps[-1]) if self._steps else 0

    def add(self, time: float, movers: Sequence[MoverState]) -> None:
        """Add where they are at a time [s]; a run without movers keeps nothing."""
        if movers:
            self._times.append(time)
            self._steps.append(tuple(movers))

    def trails(self) -> list[FloatArray]:
        """Of each mover, its places (x, y) [m] in the last eight seconds, shape (N, 2)."""
        recent = [
            step for time, step in zip(self._times, self._steps, strict=True) if time >= self._times[-1] - _TRAIL_S
        ]
        return [np.array([(state.pose.x, state.pose.y) for state in states]) for states in zip(*recent, strict=True)]

    def draw(self, view: MapView) -> None:
        """Draw the outlines of the movers at the end of the run, each with its trail."""
        if not self._steps:
            return
        for trail, state in zip(self.trails(), self._steps[-1], strict=True):
            view.line(trail, WARNING, 2)
            view.outline(state.pose, np.array(state.outline), WARNING, 2.0, alpha=_FAINT, fill=_FILL)
