"""`AStarPlanner`: the shortest way past cells of 253 and more, by name `astar`."""

from __future__ import annotations

from trundle.planning.binary_planner import BinaryPlanner


class AStarPlanner(BinaryPlanner):
    """Finds the shortest way with A* and a bucket queue, then checks and shortens it like `LeastCostPlanner`.

    Cells of 253 and more are blocked, and what the others cost does not count. For the options see `BinaryPlanner`.
    """

    def __init__(
        self,
        *,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
    ) -> None:
        super().__init__(
            "astar",
            "astar",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
