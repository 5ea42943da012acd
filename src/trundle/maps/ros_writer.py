"""Writing a ROS map: the image, and the YAML file that names it, both written atomically."""

from __future__ import annotations

import json
import os
import re
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.files.writing import output_path
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, CellGrid, Cells
from trundle.maps.map_files import save_pair
from trundle.maps.occupancy import MODES, UNKNOWN_GREY, Mode, PixelRule, compute_table
from trundle.maps.values import VALUES, count_values, round_trinary

OCCUPIED_THRESH = 0.65
FREE_THRESH = 0.196

_FREE_GREY = 254
_OCCUPIED_GREY = 0
_RAW_UNKNOWN = 255
_PLAIN_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")


def save_map(
    grid: CellGrid,
    path: str | os.PathLike[str],
    *,
    mode: Mode = "trinary",
    image_format: Literal["png", "pgm"] = "png",
) -> None:
    """Write a map; see `OccupancyGrid.save`."""
    target = output_path(path)
    suffix = target.suffix.lower()
    if suffix == ".map":
        from trundle.maps.movingai_cells import write_cells

        if mode != "trinary":
            raise MapError(f"{target}: a MovingAI map has no mode {mode}, only free and blocked; save as .yaml")
        write_cells(grid.data, target)
        return
    if suffix not in (".yaml", ".yml"):
        raise MapError(
            f"a map is saved under the name of its YAML file, got {target}; end the name in .yaml, or .map for MovingAI"
        )
    if mode not in MODES:
        raise MapError(f"mode is {mode!r}; it must be one of {', '.join(MODES)}")
    if image_format not in ("png", "pgm"):
        raise MapError(f"image_format is {image_format!r}; it must be png or pgm")
    if mode == "scale" and image_format == "pgm":
        raise MapError("mode scale needs transparency for unknown cells, which PGM lacks; save as png")
    samples = compute_samples(grid, mode)
    if image_format == "pgm":
        from trundle.maps.images.pnm import encode_pgm

        content = encode_pgm(samples)
    else:
        from trundle.maps.images.png import encode_png

        content = encode_png(samples)
    save_pair(target, f".{image_format}", content, lambda image: _compose_yaml(grid, image, mode))


def compute_samples(grid: CellGrid, mode: Mode) -> npt.NDArray[np.uint8]:
    """8-bit samples of a map's image, top row first: greys (rows, cols), or (rows, cols, 4) in mode scale.

    As Nav2's map saver: trinary applies its thresholds; scale writes free as bright and unknown as transparent; raw
    writes the values, with unknown as 255.
    """
    index = np.ascontiguousarray(grid.data[::-1]) + 1
    greys = _compute_greys(mode)[index]
    if mode != "scale":
        return greys
    opacity = np.where(index == 0, 0, 255).astype(np.uint8)
    return np.stack([greys, greys, greys, opacity], axis=-1)


def choose_mode(grid: CellGrid) -> Mode:
    """The mode that keeps every cell of a map: trinary if there are no values between free and occupied, else raw."""
    return "trinary" if count_values(grid.data)[~np.isin(VALUES, (UNKNOWN, FREE, OCCUPIED))].sum() == 0 else "raw"


def read_back(mode: Mode) -> Cells:
    """Each of `VALUES` after it was written in a mode and read back, shape (102,)."""
    values = compute_table(PixelRule(mode, False, OCCUPIED_THRESH, FREE_THRESH))[_compute_greys(mode)]
    if mode == "scale":
        values[0] = UNKNOWN  # Transparent.
    return values


def _compute_greys(mode: Mode) -> npt.NDArray[np.uint8]:
    """The grey of each of `VALUES`, shape (102,)."""
    if mode == "trinary":
        trinary = round_trinary(VALUES)
        table = np.where(trinary == OCCUPIED, _OCCUPIED_GREY, np.where(trinary == FREE, _FREE_GREY, UNKNOWN_GREY))
    elif mode == "scale":
        table = np.floor((100.0 - VALUES) / 100.0 * 255.0 + 0.5)
        table[0] = 128
    else:
        table = np.where(VALUES == UNKNOWN, _RAW_UNKNOWN, VALUES.astype(np.int16))
    return table.astype(np.uint8)


def _compose_yaml(grid: CellGrid, image: str, mode: Mode) -> str:
    # Full precision: Nav2's saver rounds to three decimals, which moves a map of 0.0125 m cells by metres.
    name = image if _PLAIN_NAME.fullmatch(image) else json.dumps(image)
    x, y, yaw = grid.origin.as_tuple()
    return (
        f"image: {name}\n"
        f"mode: {mode}\n"
        f"resolution: {grid.resolution!r}\n"
        f"origin: [{x!r}, {y!r}, {yaw!r}]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESH}\n"
        f"free_thresh: {FREE_THRESH}\n"
    )
