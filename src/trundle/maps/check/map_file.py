"""A map's YAML file and its image: all mistakes at once, each with its line and column."""

from __future__ import annotations

import dataclasses
import difflib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
import yaml

from trundle.errors import MapError
from trundle.files.yaml_nodes import place
from trundle.maps.cells import FREE, Surface
from trundle.maps.check.finding import Finding, Kind
from trundle.maps.grid import OccupancyGrid
from trundle.maps.images.image import read_image
from trundle.maps.images.pixels import Pixels, compute_greys
from trundle.maps.occupancy import UNKNOWN_GREY, Compat, Mode, PixelRule, compute_cells, compute_table
from trundle.maps.ros_reader import find_image
from trundle.maps.ros_writer import FREE_THRESH, OCCUPIED_THRESH
from trundle.maps.ros_yaml import (
    MAX_RESOLUTION,
    MIN_RESOLUTION,
    Fields,
    RosMapDescription,
    describe_degrees,
    describe_resolution,
    parse_mode,
    parse_negate,
    parse_origin,
    parse_surface,
    read_fields,
)

_USUAL: dict[str, str] = {
    "image": "image: map.png",
    "mode": "mode: trinary",
    "resolution": "resolution: 0.05",
    "origin": "origin: [0.0, 0.0, 0.0]",
    "negate": "negate: 0",
    "occupied_thresh": f"occupied_thresh: {OCCUPIED_THRESH}",
    "free_thresh": f"free_thresh: {FREE_THRESH}",
    "surface": "surface: border",
}
"""Usual lines of a map's YAML."""

ValueT = TypeVar("ValueT")

_SUFFIXES = (".png", ".pgm", ".pnm", ".ppm", ".bmp")


@dataclass(frozen=True, slots=True)
class DescriptionCheck:
    """The result of reading a YAML file.

    Attributes:
        findings: Its mistakes.
        description: Its contents, with exchanged thresholds corrected; None where it cannot be used.
        corrected: The kinds of findings that were corrected.
    """

    findings: list[Finding]
    description: RosMapDescription | None
    corrected: tuple[Kind, ...] = ()


def check_description(path: str | os.PathLike[str]) -> DescriptionCheck:
    """Read a map's YAML file and list everything that is wrong with it."""
    try:
        fields = read_fields(path)
    except MapError as error:
        return DescriptionCheck([_yaml_error(error, _advise(str(error)))], None)
    findings = [*_check_keys(fields)]

    def read(key: str, value: Callable[[], ValueT]) -> ValueT | None:
        try:
            return value()
        except MapError as error:
            findings.append(_yaml_error(error, f"write `{_USUAL[key]}`, or what is true of this map"))
            return None

    surface: Surface | None = read("surface", lambda: parse_surface(fields))
    image = read("image", lambda: fields.text("image"))
    mode: Mode | None = read("mode", lambda: parse_mode(fields))
    origin = read("origin", lambda: parse_origin(fields))
    negate = read("negate", lambda: parse_negate(fields))
    occupied = read("occupied_thresh", lambda: fields.number("occupied_thresh", low=0.0, high=1.0))
    free = read("free_thresh", lambda: fields.number("free_thresh", low=0.0, high=1.0))
    if origin is not None:
        degrees = describe_degrees(fields)
        findings += [] if degrees is None else [Finding("yaml", "warning", degrees[0], None, degrees[1])]
    resolution = _read_resolution(fields, findings)
    corrected: tuple[Kind, ...] = ()
    if occupied is not None and free is not None and free > occupied:
        findings.append(_inverted(fields, free, occupied))
        free, occupied = occupied, free
        corrected = ("thresholds_inverted",)
    if image and mode and origin and negate is not None and occupied is not None and free is not None and resolution:
        rule = PixelRule(mode, negate, occupied, free)
        where = fields.place("free_thresh")
        return DescriptionCheck(
            findings, RosMapDescription(*image, resolution, origin, rule, where, surface or "border"), corrected
        )
    return DescriptionCheck(findings, None)


def _yaml_error(error: MapError, fix: str) -> Finding:
    return Finding("yaml", "error", str(error), None, fix)


def _advise(message: str) -> str:
    """Return advice for a text that is not YAML, or not a map's YAML."""
    if "'\\t'" in message:
        return "write spaces for the tab"
    if "another document" in message:
        return "keep one document: take out what follows ---"
    if "not a map's YAML file" in message:
        return f"write one `key: value` a line, with a space after the colon: {', '.join(_USUAL)}"
    return "correct the line; quotes, brackets and colons must come in pairs with what they belong to"


def _check_keys(fields: Fields) -> list[Finding]:
    findings: list[Finding] = []
    seen: dict[str, yaml.ScalarNode] = {}
    for key in fields.keys:
        where = place(key, fields.name)
        if key.value in seen:
            first = seen[key.value].start_mark.line + 1
            findings.append(
                Finding(
                    "yaml",
                    "warning",
                    f"{where}: the key {key.value!r} is given twice: Nav2 takes the first (line {first}), most other "
                    "readers the last",
                    None,
                    "keep one of the two",
                )
            )
            continue
        seen[key.value] = key
        near = difflib.get_close_matches(key.value.lower(), _USUAL, n=1, cutoff=0.8)
        if key.value in _USUAL:
            continue
        if near and near[0] not in fields.nodes:
            message = f"{where}: the key {key.value!r} is not known and is ignored; {near[0]!r} is probably meant"
            findings.append(Finding("yaml", "warning", message, None, f"write {near[0]}"))
        else:
            message = f"{where}: the key {key.value!r} is none of a map's: Nav2 ignores it"
            findings.append(
                Finding("yaml", "info", message, None, "nothing, if another tool reads it; else take it out")
            )
    return findings


def _read_resolution(fields: Fields, findings: list[Finding]) -> float | None:
    try:
        resolution = fields.number("resolution", low=MIN_RESOLUTION, high=MAX_RESOLUTION)
    except MapError as error:
        node = fields.nodes.get("resolution")
        kind: Kind = "resolution" if isinstance(node, yaml.ScalarNode) and _is_number(node.value) else "yaml"
        findings.append(Finding(kind, "error", str(error), None, "write the edge of a cell in metres, most often 0.05"))
        return None
    unlikely = describe_resolution(fields)
    if unlikely is not None:
        findings.append(Finding("resolution", "warning", unlikely[0], None, unlikely[1]))
    return resolution


def _is_number(text: str) -> bool:
    """Return whether a text is a number, infinity and NaN included, as YAML writes them (.inf, .nan) or Python does."""
    try:
        float(text.strip().lower().replace(".nan", "nan").replace(".inf", "inf"))
    except ValueError:
        return False
    return True


def _inverted(fields: Fields, free: float, occupied: float) -> Finding:
    return Finding(
        "thresholds_inverted",
        "error",
        f"{fields.place('free_thresh')}: free_thresh {free:g} is above occupied_thresh {occupied:g}: the two are "
        "exchanged, and what is grey loads as free",
        None,
        f"exchange them: occupied_thresh {free:g}, free_thresh {occupied:g} (usual are {OCCUPIED_THRESH} and "
        f"{FREE_THRESH})",
    )


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
            return Reading(
                OccupancyGrid(cells, description.resolution, description.origin, description.surface), [], ()
            )
        except MapError as error:
            advice = "write the edge of a cell in metres, most often 0.05"
            return Reading(None, [Finding("resolution", "error", f"{source}: {error}", None, advice)], ())
    meant = dataclasses.replace(rule, free_thresh=FREE_THRESH)
    cells = compute_cells(pixels, meant, compat)
    grid = OccupancyGrid(cells, description.resolution, description.origin, description.surface)
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
    """Return which image beside the YAML file is probably meant."""
    beside = sorted(file.name for file in source.parent.iterdir() if file.suffix.lower() in _SUFFIXES)
    near = [name for name in beside if name != image and Path(name).stem in (Path(image).stem, source.stem)]
    near += difflib.get_close_matches(image, [name for name in beside if name != image], n=1)
    if near:
        return f"write `image: {near[0]}`, which is there, or write the image again"
    return "correct `image`, or write the image again as PNG or PGM"


def _find_trapped(pixels: Pixels, rule: PixelRule) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]] | None:
    """Return the cells, row 0 at the bottom, of the grey of unknown that load as free; None if there are none."""
    if rule.mode == "raw" or rule.negate or compute_table(rule)[UNKNOWN_GREY] != FREE:
        return None
    trapped = compute_greys(pixels)[::-1] == UNKNOWN_GREY
    return trapped if trapped.any() else None
