"""`AStarPlanner`: the shortest way past cells of 253 and more, by name `astar`."""

from __future__ import annotations

from trundle.planning.binary_planner import BinaryPlanner


class AStarPlanner(BinaryPlanner):
    """Finds the shortest way with A* and a bucket queue, then checks and shortens it like `LeastCostPlanner`.

    Cells of 253 and more are blocked, and what the others cost does not count. For the options see `FootprintPlanner`.
    """

    name = "astar"
    method = "astar"
