"""Occupancy grids: ROS map files, MovingAI maps, and maps of worlds."""

from trundle.maps.grid import FREE, MAX_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid
from trundle.maps.resample import resample_axis_aligned

__all__ = ["FREE", "MAX_CELLS", "OCCUPIED", "UNKNOWN", "OccupancyGrid", "resample_axis_aligned"]
