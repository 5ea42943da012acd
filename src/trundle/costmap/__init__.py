"""Costmaps: traversal cost of each cell for one robot, and whether its footprint touches something.

`layers` adds what lidars see.
"""

from trundle.costmap.costmap import Costmap
from trundle.costmap.costmap_settings import CostmapSettings
from trundle.costmap.costs import (
    DEFAULT_UNKNOWN_COST,
    FREE_SPACE,
    INSCRIBED,
    LETHAL,
    NO_INFORMATION,
    UNKNOWN_POLICIES,
    UnknownPolicy,
)
from trundle.costmap.layers import (
    EVERYWHERE,
    Layer,
    LayeredCostmap,
    LayersSettings,
    MapPart,
    MapWindow,
    ObstacleLayer,
    ObstacleLayerSettings,
)

__all__ = [
    "DEFAULT_UNKNOWN_COST",
    "EVERYWHERE",
    "FREE_SPACE",
    "INSCRIBED",
    "LETHAL",
    "NO_INFORMATION",
    "UNKNOWN_POLICIES",
    "Costmap",
    "CostmapSettings",
    "Layer",
    "LayeredCostmap",
    "LayersSettings",
    "MapPart",
    "MapWindow",
    "ObstacleLayer",
    "ObstacleLayerSettings",
    "UnknownPolicy",
]
