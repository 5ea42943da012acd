"""Occupancy grids: ROS map files, MovingAI maps, and maps of worlds."""

from trundle.maps.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "OccupancyGrid"]
