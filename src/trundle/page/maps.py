"""Maps and costmaps as pictures for the page."""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.maps import OccupancyGrid
from trundle.maps.frame import GridFrame
from trundle.maps.images.png import encode_png
from trundle.page.encoding import rounded
from trundle.pictures.cells import merge_cells

UNKNOWN_GREY, FREE_GREY = 205, 254
"""Of cells of a map; occupied ones are 0, as in ROS maps."""

_MOST_CELLS = 4_000_000


def grid_png(grid: OccupancyGrid) -> dict[str, Any]:
    """A map as {"png", "resolution", "origin", "width", "height"}: 8-bit grey, row 0 at the top.

    Occupied cells are 0, free ones 254 and unknown ones 205, as in ROS maps. A map of more than 4 million cells gets
    larger cells, of which each has the most occupied of those that it holds.
    """
    occupancy = np.clip(grid.data, 0, 100).astype(np.float32)
    grey = (FREE_GREY - np.rint(occupancy * (FREE_GREY / 100.0))).astype(np.uint8)
    grey[grid.data < 0] = UNKNOWN_GREY
    values, factor = _shrunk(255 - grey)
    return _picture(grid, 255 - values, factor)


def costmap_png(costmap: Costmap, *, base: Costmap | None = None) -> dict[str, Any]:
    """A costmap as {"png", "resolution", "origin", "width", "height"}: grey values are Nav2's costs, row 0 at the top.

    A costmap of more than 4 million cells gets larger cells, of which each has the largest cost of those that it holds.

    Args:
        costmap: The costmap.
        base: One of the same extent: then the picture holds how much higher the costs are, modulo 256.
    """
    values, factor = _shrunk(costmap.data)
    if base is not None:
        values = values - _shrunk(base.data)[0]
    return _picture(costmap, values, factor)


def _picture(frame: GridFrame, values: npt.NDArray[np.uint8], factor: int) -> dict[str, Any]:
    return {
        "png": base64.b64encode(encode_png(np.ascontiguousarray(values[::-1]))).decode(),
        "resolution": frame.resolution * factor,
        "origin": rounded(frame.origin.as_tuple(), 6),
        "width": int(values.shape[1]),
        "height": int(values.shape[0]),
    }


def _shrunk(values: npt.NDArray[np.uint8]) -> tuple[npt.NDArray[np.uint8], int]:
    """Values in cells of so many times the size that they are few enough, and that factor."""
    factor = math.ceil(math.sqrt(values.size / _MOST_CELLS))
    return (merge_cells(np.arange(256, dtype=np.uint8), values, factor) if factor > 1 else values), factor
