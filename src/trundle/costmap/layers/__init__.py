"""Layers: what lidars see of obstacles that are not on the map, and the costmap with them.

A `LayeredCostmap` owns the static map, if there is one, the keep-out mask and the layers. Each call of `update` gives
the layers new scans and returns an immutable `Costmap`. Layers gather evidence in the map frame: what was sensed stays
where the estimate of its time put it. Only an estimate that jumps makes them forget what lies near the robot.
"""

from trundle.costmap.layers.layer import EVERYWHERE, Layer, MapPart, MapWindow
from trundle.costmap.layers.layered_costmap import LayeredCostmap, LayersSettings
from trundle.costmap.layers.obstacle_layer import ObstacleLayer, ObstacleLayerSettings
from trundle.costmap.layers.scan_placer import PlacedScan, PlacedScans, ScanPlacer

__all__ = [
    "EVERYWHERE",
    "Layer",
    "LayeredCostmap",
    "LayersSettings",
    "MapPart",
    "MapWindow",
    "ObstacleLayer",
    "ObstacleLayerSettings",
    "PlacedScan",
    "PlacedScans",
    "ScanPlacer",
]
