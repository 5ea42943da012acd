"""Reading a ROS map: its YAML file and its image, as Nav2's map server does, with stricter checks of the values.

Nav2's costmaps ignore the yaw of `origin`, while RViz shows it. Here it is applied everywhere;
`trundle.maps.resample_axis_aligned` makes a map without it.
"""

from __future__ import annotations

import os
import warnings
from pathlib import Path

import numpy as np

from trundle.errors import MapError, MapWarning
from trundle.files.opening import is_file
from trundle.geometry import Pose2D
from trundle.maps.cells import FREE, PlacedCells
from trundle.maps.images.image import read_image
from trundle.maps.images.pixels import Pixels, compute_greys
from trundle.maps.occupancy import UNKNOWN_GREY, Compat, PixelRule, compute_cells, compute_table
from trundle.maps.ros_yaml import RosMapDescription, load_description
from trundle.values import as_path

_IMAGE_SUFFIXES = (".png", ".pgm", ".ppm", ".pbm", ".bmp", ".jpg", ".jpeg")


def load_map(
    path: str | os.PathLike[str],
    *,
    compat: Compat | None = None,
    allow_outside: bool = False,
    max_cells: int | None = None,
) -> PlacedCells:
    """Read the cells of a map; see `OccupancyGrid.load`."""
    source = Path(as_path(path, "a map's file", MapError))
    if compat not in (None, "humble"):
        raise MapError(f'compat is {compat!r}; it must be "humble" or None')
    suffix = source.suffix.lower()
    if suffix == ".map":
        from trundle.maps.movingai_cells import read_cells

        return PlacedCells(read_cells(source, max_cells), 1.0, Pose2D(0.0, 0.0, 0.0))
    if suffix in _IMAGE_SUFFIXES:
        raise MapError(f"{source} is an image; give the map's YAML file, which names the image and the resolution")
    description = load_description(source)
    pixels = read_image(find_image(source, description, allow_outside=allow_outside), max_cells=max_cells)
    _warn_of_unknown_as_free(pixels, description)
    cells = compute_cells(pixels, description.rule, compat)
    return PlacedCells(cells, description.resolution, description.origin, description.surface)


def find_image(source: Path, description: RosMapDescription, *, allow_outside: bool) -> Path:
    """Return the image that a map's YAML file names.

    Raises:
        MapError: If it does not exist, or lies outside the file's folder without `allow_outside`.
    """
    where, image = description.image_place, description.image
    try:
        folder = source.parent.resolve()
        found = (folder / image).resolve()
        inside = found.is_relative_to(folder)
        exists = is_file(found)
    except (OSError, RuntimeError, ValueError) as error:
        raise MapError(f"{where}: image {image[:100]!r} is not a valid file name ({error}); correct it") from error
    if not inside and not allow_outside:
        raise MapError(
            f"{where}: image {image[:100]!r} lies outside the map's folder {folder}; put it beside the YAML file, or "
            "allow it with allow_outside=True"
        )
    if not exists:
        raise MapError(f"{where}: the image file {found} does not exist; correct the name or put the file there")
    return found


def _warn_of_unknown_as_free(pixels: Pixels, description: RosMapDescription) -> None:
    rule: PixelRule = description.rule
    if rule.mode == "raw" or rule.negate or compute_table(rule)[UNKNOWN_GREY] != FREE:
        return
    count = int(np.count_nonzero(compute_greys(pixels) == UNKNOWN_GREY))
    if count:
        warnings.warn(
            f"{description.free_thresh_place}: free_thresh {rule.free_thresh:g} is above the darkness of unknown "
            f"cells (grey 205, 0.196): {count} of them load as free. Use 0.196",
            MapWarning,
            stacklevel=4,
        )
