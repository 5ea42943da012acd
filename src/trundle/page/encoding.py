"""Arrays, maps and JSON values in the form that the page reads."""

from __future__ import annotations

import base64
import gzip
import io
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, NO_INFORMATION, Costmap
from trundle.maps import OccupancyGrid
from trundle.maps.frame import GridFrame
from trundle.maps.images.png import encode_png
from trundle.pictures.cells import merge_cells

_KINDS = {"f4": "<f4", "u4": "<u4", "i2": "<i2", "u1": "|u1"}


def pack_array(values: npt.ArrayLike, kind: str) -> dict[str, Any]:
    """Pack an array as {"b64", "dtype", "shape"}, little-endian.

    Args:
        values: The array.
        kind: "f4", "u4", "i2" or "u1".
    """
    array = np.ascontiguousarray(values, dtype=_KINDS[kind])
    return {"b64": base64.b64encode(array.tobytes()).decode(), "dtype": kind, "shape": list(array.shape)}


def unpack_array(value: Mapping[str, Any]) -> npt.NDArray[Any]:
    """Return the array that `pack_array` packed."""
    content = base64.b64decode(value["b64"], validate=True)
    return np.frombuffer(content, dtype=_KINDS[value["dtype"]]).reshape(value["shape"])


def pack_json(value: object) -> dict[str, str]:
    """Pack a JSON value as {"gzip": base64}; the same value gives the same text."""
    return {"gzip": base64.b64encode(gzip.compress(to_json(value).encode(), 9, mtime=0)).decode()}


def unpack_json(value: Mapping[str, Any], *, most_bytes: int) -> Any:
    """Return the value that `pack_json` packed.

    Raises:
        ValueError: If it is damaged, or larger than `most_bytes`.
    """
    try:
        packed = base64.b64decode(value["gzip"], validate=True)
        with gzip.GzipFile(fileobj=io.BytesIO(packed)) as stream:
            content = stream.read(most_bytes + 1)
    except (OSError, EOFError, TypeError, KeyError) as error:
        raise ValueError(f"a packed block is damaged: {error}") from error
    if len(content) > most_bytes:
        raise ValueError(f"a packed block is larger than {most_bytes} bytes")
    return json.loads(content)


def to_json(value: object) -> str:
    """Write a value as JSON without spaces, in ASCII."""
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


def rounded(values: Iterable[float], digits: int = 4) -> list[float]:
    """Round numbers for JSON to so many decimals."""
    return [round(float(value), digits) for value in values]


def finite(value: float | None, digits: int = 4) -> float | None:
    """Round a number for JSON; return None if it is not finite."""
    return round(float(value), digits) if value is not None and math.isfinite(value) else None


UNKNOWN_GREY, FREE_GREY = 205, 254
"""Grey values of unknown and free cells of a map; occupied ones are 0, as in ROS maps."""

_MOST_CELLS = 4_000_000


def grid_png(grid: OccupancyGrid) -> dict[str, Any]:
    """Return a map as {"png", "resolution", "origin", "width", "height"}: 8-bit grey, row 0 at the top.

    Occupied cells are 0, free ones 254 and unknown ones 205, as in ROS maps. A map of more than 4 million cells gets
    larger cells, of which each has the most occupied of those that it holds.
    """
    occupancy = np.clip(grid.data, 0, 100).astype(np.float32)
    grey = (FREE_GREY - np.rint(occupancy * (FREE_GREY / 100.0))).astype(np.uint8)
    grey[grid.data < 0] = UNKNOWN_GREY
    values, factor = _shrunk(255 - grey)
    return _picture(grid, 255 - values, factor)


def costmap_png(costmap: Costmap, *, base: Costmap | None = None) -> dict[str, Any]:
    """Return a costmap as {"png", "resolution", "origin", "width", "height"}, row 0 at the top.

    The grey values are Nav2's costs; unknown cells are 255, whether or not the robot plans through them.
    A costmap of more than 4 million cells gets larger cells, of which each has the largest cost of those that it holds.

    Args:
        costmap: The costmap.
        base: One of the same extent: then the picture holds how much higher the costs are, modulo 256.
    """
    values, factor = _shrunk(_costs(costmap))
    if base is not None:
        values = values - _shrunk(_costs(base))[0]
    return _picture(costmap, values, factor)


def _costs(costmap: Costmap) -> npt.NDArray[np.uint8]:
    if costmap.unseen is None:
        return costmap.data
    return np.where(costmap.unseen & (costmap.data < INSCRIBED), np.uint8(NO_INFORMATION), costmap.data)


def _picture(frame: GridFrame, values: npt.NDArray[np.uint8], factor: int) -> dict[str, Any]:
    return {
        "png": base64.b64encode(encode_png(np.ascontiguousarray(values[::-1]))).decode(),
        "resolution": frame.resolution * factor,
        "origin": rounded(frame.origin.as_tuple(), 6),
        "width": int(values.shape[1]),
        "height": int(values.shape[0]),
    }


def _shrunk(values: npt.NDArray[np.uint8]) -> tuple[npt.NDArray[np.uint8], int]:
    """Merge cells until there are few enough; return their values, and the factor by which they are larger."""
    factor = math.ceil(math.sqrt(values.size / _MOST_CELLS))
    return (merge_cells(np.arange(256, dtype=np.uint8), values, factor) if factor > 1 else values), factor
