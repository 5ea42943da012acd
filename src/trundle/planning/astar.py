"""`AStarPlanner`: the shortest way past cells of 253 and more, by name `astar`."""

from __future__ import annotations

from trundle.planning.footprint_planner import FootprintPlanner


class AStarPlanner(FootprintPlanner):
    """Ignores costs below 253 and finds the shortest way, then checks and shortens it like `LeastCostPlanner`.

    `Path.cost` is its length [m]. For the options see `FootprintPlanner`.
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
            neutral_cost=1.0,
            cost_weight=0.0,
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
