"""`MoverTrails`: where the movers of a run were, for its pictures."""

from __future__ import annotations

import numpy as np

from trundle.pictures.colors import WARNING
from trundle.record.map_view import MapView
from trundle.sim.mover_history import MoverHistory

_FAINT, _FILL = 200, 70


class MoverTrails(MoverHistory):
    """Collects the movers of a run, one entry for each step, and draws them."""

    def draw(self, view: MapView) -> None:
        """Draw the outlines of the movers at the end of the run, each with its trail."""
        if not self._times:
            return
        shown = self.at(self._times[-1])
        for trail, state in zip(shown.trails, shown.states, strict=True):
            view.line(trail, WARNING, 2)
            view.outline(state.pose, np.array(state.outline), WARNING, 2.0, alpha=_FAINT, fill=_FILL)
