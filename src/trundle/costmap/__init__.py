"""Costmaps: traversal cost of each cell for one robot, and whether its footprint touches something."""

from trundle.costmap.costmap import Costmap
from trundle.costmap.inflation import FREE_SPACE, INSCRIBED, LETHAL, NO_INFORMATION
from trundle.costmap.settings import CostmapSettings
from trundle.costmap.unknown import DEFAULT_UNKNOWN_COST, UNKNOWN_POLICIES, UnknownPolicy

__all__ = [
    "DEFAULT_UNKNOWN_COST",
    "FREE_SPACE",
    "INSCRIBED",
    "LETHAL",
    "NO_INFORMATION",
    "UNKNOWN_POLICIES",
    "Costmap",
    "CostmapSettings",
    "UnknownPolicy",
]
