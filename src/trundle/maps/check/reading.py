"""Reading a map's image by its rule, and findings where cells load with another meaning than intended."""

from __future__ import annotations

import dataclasses
import difflib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from trundle.errors import MapError
from trundle.maps.cells import FREE
from trundle.maps.check.finding import Finding, Kind
from trundle.maps.grid import OccupancyGrid
from trundle.maps.images.image import read_image
from trundle.maps.images.pixels import Pixels, compute_greys
from trundle.maps.occupancy import UNKNOWN_GREY, Compat, PixelRule, compute_cells, compute_table
from trundle.maps.ros_reader import find_image
from trundle.maps.ros_writer import FREE_THRESH
from trundle.maps.ros_yaml import RosMapDescription

_SUFFIXES = (".png", ".pgm", ".pnm", ".ppm", ".bmp")


class Reading(NamedTuple):
    """The map as intended, or None where its image cannot be read; the findings; and the kinds corrected."""

    grid: OccupancyGrid | None
    findings: list[Finding]
    corrected: tuple[Kind, ...]


def read_map(
    source: Path,
    description: RosMapDescription,
    *,
    compat: Compat | None = None,
    allow_outside: bool = False,
    max_cells: int | None = None,
) -> Reading:
    """Read a map's image; unknown cells that would load as free are read as unknown."""
    try:
        pixels = read_image(find_image(source, description, allow_outside=allow_outside), max_cells=max_cells)
    except MapError as error:
        message, place = str(error), description.image_place
        located = message if message.startswith(place) else f"{place}: {message}"
        return Reading(None, [Finding("yaml", "error", located, None, _advise_image(source, description.image))], ())
    rule = description.rule
    trapped = _find_trapped(pixels, rule)
    if trapped is None:
        cells = compute_cells(pixels, rule, compat)
        try:
            return Reading(OccupancyGrid(cells, description.resolution, description.origin), [], ())
        except MapError as error:
            advice = "write the edge of a cell in metres, most often 0.05"
            return Reading(None, [Finding("resolution", "error", f"{source}: {error}", None, advice)], ())
    meant = dataclasses.replace(rule, free_thresh=FREE_THRESH)
    grid = OccupancyGrid(compute_cells(pixels, meant, compat), description.resolution, description.origin)
    rows, cols = np.nonzero(trapped)
    middle = len(rows) // 2
    x, y = grid.cell_to_world(rows[middle], cols[middle])
    finding = Finding(
        "unknown_loads_free",
        "error",
        f"{description.free_thresh_place}: free_thresh {rule.free_thresh:g} is above the darkness of unknown cells "
        f"(grey {UNKNOWN_GREY}, 0.196): {len(rows)} unknown cells load as free",
        (float(x), float(y)),
        f"write free_thresh: {FREE_THRESH}",
    )
    return Reading(grid, [finding], ("unknown_loads_free",))


def _advise_image(source: Path, image: str) -> str:
    """Which image beside the YAML file is probably meant."""
    beside = sorted(file.name for file in source.parent.iterdir() if file.suffix.lower() in _SUFFIXES)
    near = [name for name in beside if name != image and Path(name).stem in (Path(image).stem, source.stem)]
    near += difflib.get_close_matches(image, [name for name in beside if name != image], n=1)
    if near:
        return f"write `image: {near[0]}`, which is there, or write the image again"
    return "correct `image`, or write the image again as PNG or PGM"


def _find_trapped(pixels: Pixels, rule: PixelRule) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]] | None:
    """Cells, row 0 at the bottom, of the grey of unknown that load as free; None where there is none."""
    if rule.mode == "raw" or rule.negate or compute_table(rule)[UNKNOWN_GREY] != FREE:
        return None
    trapped = compute_greys(pixels)[::-1] == UNKNOWN_GREY
    return trapped if trapped.any() else None
