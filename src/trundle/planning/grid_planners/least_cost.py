"""`LeastCostPlanner`: any-angle, minimum-cost paths over a costmap, by name `least_cost`."""

from __future__ import annotations

from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_paths import STATUSES
from trundle.planning.grid_planners.footprint_planner import (
    FootprintOptions,
    FootprintPlanner,
    cell_weights,
    to_grid,
    to_map,
)
from trundle.planning.queries.ends import End

NEUTRAL_COST = 50.0
"""Weight of a free cell: `COST_NEUTRAL` of Nav2's NavFn planner."""

COST_WEIGHT = 0.8
"""Weight of one unit of cost: `COST_FACTOR` of Nav2's NavFn planner."""


class LeastCostPlanner(FootprintPlanner):
    """Weighs length against the costs of the cells, as Nav2's NavFn does: 50 + 0.8 · cost per length.

    `Path.cost` is the integral of the weight along the path [m], constant in a cell. A wavefront spreads from the start
    over the cells (fast marching: Tsitsiklis, 1995; Sethian, 1996), in triangles between their centres as in Field D*
    (Ferguson and Stentz, 2006), and the path descends it, through any point of a cell. It is not the exact optimum,
    but mostly within 0.3 % of it. Only cells where the cheapest path may be are searched: a lower bound on blocks of
    4 × 4 cells discards those that cannot be part of a path cheaper than the one found.

    Args:
        neutral_cost: Weight of a free cell.
        cost_weight: Weight of one unit of cost.
        options: Options of `FootprintPlanner`.

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
        self._kernel = _core.LeastCost(self._line_weights)

    def _find_path(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        ends = to_grid(costmap, np.array([[end.pose.x, end.pose.y] for end in (start, goal)]))
        status, points, cost = self._kernel.find(costs, start.cell, goal.cell, ends, patience.seconds, patience.flag)
        match STATUSES[status]:
            case "timeout" | "cancelled" as why:
                raise patience.stopped(why)
            case "unreachable":
                return None
        vertices = to_map(costmap, points)
        vertices[0], vertices[-1] = (start.pose.x, start.pose.y), (goal.pose.x, goal.pose.y)
        return vertices, cost * costmap.resolution
