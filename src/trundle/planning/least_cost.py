"""`LeastCostPlanner`: the cheapest way over a costmap, by name `least_cost`."""

from __future__ import annotations

from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.geometry import FloatArray
from trundle.planning.footprint_planner import FootprintOptions, FootprintPlanner, cell_weights

NEUTRAL_COST = 50.0
"""Weight of a free cell: `COST_NEUTRAL` of Nav2's NavFn planner."""

COST_WEIGHT = 0.8
"""Weight of one unit of cost: `COST_FACTOR` of Nav2's NavFn planner."""


class LeastCostPlanner(FootprintPlanner):
    """Weighs length against the costs of the cells, as Nav2's NavFn does: 50 + 0.8 · cost per length.

    The vertices of the shortcut are then moved off the cells' centres to where the way is cheapest. `Path.cost` is the
    integral of the weight along the path [m], constant in a cell.

    Args:
        neutral_cost: Weight of a free cell.
        cost_weight: Weight of one unit of cost.
        options: Those of `FootprintPlanner`.

    Raises:
        InputError: If an option is out of range.
    """

    name = "least_cost"

    def __init__(
        self,
        *,
        neutral_cost: float = NEUTRAL_COST,
        cost_weight: float = COST_WEIGHT,
        **options: Unpack[FootprintOptions],
    ) -> None:
        super().__init__(**options)
        self._line_weights = cell_weights(neutral_cost, cost_weight)

    def _straighten(self, costs: npt.NDArray[np.uint8], points: FloatArray) -> tuple[FloatArray, float]:
        straight, _ = super()._straighten(costs, points)
        return _core.relax(costs, self._line_weights, straight)
