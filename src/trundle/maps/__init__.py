"""Occupancy grids: ROS map files, MovingAI maps, maps of worlds, and maps made of other maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names
from trundle.maps.cells import FREE, MAX_CELLS, OCCUPIED, UNKNOWN
from trundle.maps.grid import OccupancyGrid

if TYPE_CHECKING:
    from trundle.maps.convert import Conversion, Loss, convert_grid, find_file_losses
    from trundle.maps.height_field import HeightField
    from trundle.maps.masks import KeepoutMask, SpeedMask
    from trundle.maps.resample import resample_axis_aligned

# Rarely needed, and slower to import.
__getattr__ = lazy_names(
    __name__,
    {
        "Conversion": "trundle.maps.convert",
        "HeightField": "trundle.maps.height_field",
        "KeepoutMask": "trundle.maps.masks",
        "Loss": "trundle.maps.convert",
        "SpeedMask": "trundle.maps.masks",
        "convert_grid": "trundle.maps.convert",
        "find_file_losses": "trundle.maps.convert",
        "resample_axis_aligned": "trundle.maps.resample",
    },
)

__all__ = [
    "FREE",
    "MAX_CELLS",
    "OCCUPIED",
    "UNKNOWN",
    "Conversion",
    "HeightField",
    "KeepoutMask",
    "Loss",
    "OccupancyGrid",
    "SpeedMask",
    "convert_grid",
    "find_file_losses",
    "resample_axis_aligned",
]
