"""`JpsPlanner` and `JpsPlusPlanner`: the shortest way past cells of 253 and more, by names `jps` and `jps_plus`."""

from __future__ import annotations

from trundle.planning.binary_planner import BinaryPlanner


class JpsPlanner(BinaryPlanner):
    """Finds the shortest way with jump point search, or A* where the map is cluttered (`GridSearch`).

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
            "jps",
            "auto",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )


class JpsPlusPlanner(BinaryPlanner):
    """Finds the shortest way with jumps from a table, made once for a costmap: for maps that do not change.

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
            "jps_plus",
            "jps_plus",
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
