"""`JpsPlanner` and `JpsPlusPlanner`: the shortest way past cells of 253 and more, by names `jps` and `jps_plus`."""

from __future__ import annotations

from trundle.planning.binary_planner import BinaryPlanner


class JpsPlanner(BinaryPlanner):
    """Finds the shortest way with jump point search, or A* where the map is cluttered (`GridSearch`).

    Cells of 253 and more are blocked, and what the others cost does not count. For the options see `FootprintPlanner`.
    """

    name = "jps"
    method = "auto"


class JpsPlusPlanner(BinaryPlanner):
    """Finds the shortest way with jumps from a table, made once for a costmap: for maps that do not change.

    Cells of 253 and more are blocked, and what the others cost does not count. For the options see `FootprintPlanner`.
    """

    name = "jps_plus"
    method = "jps_plus"
