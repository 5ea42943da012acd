"""Layers: what lidars see of obstacles that are not on the map, and the costmap with them.

A `LayeredCostmap` owns the static map, if there is one, the keep-out mask and the layers. Each call of `update` gives
the layers new scans and returns an immutable `Costmap`. Layers gather evidence in the odom frame, so that a correction
of the estimated pose moves what was sensed as a whole instead of smearing it.
"""

from trundle.costmap.layers.layer import EVERYWHERE, Layer, MapPart, OdomWindow
from trundle.costmap.layers.layered_costmap import LayeredCostmap, LayersSettings
from trundle.costmap.layers.obstacle_layer import ObstacleLayer, ObstacleLayerSettings

__all__ = [
    "EVERYWHERE",
    "Layer",
    "LayeredCostmap",
    "LayersSettings",
    "MapPart",
    "ObstacleLayer",
    "ObstacleLayerSettings",
    "OdomWindow",
]
