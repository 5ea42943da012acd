"""The YAML file of a ROS map: its keys and their checks; each error has line and column."""

from __future__ import annotations

import contextlib
import math
import os
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import yaml

from trundle.errors import InputError, MapError, MapWarning
from trundle.files.kinds import MAP, describe_mismatch, kind_of_keys
from trundle.files.yaml_nodes import compose, keys_of, place
from trundle.geometry import Pose2D, wrap_angle
from trundle.geometry.poses import is_in_degrees, parse_angle
from trundle.maps.cells import MAX_ORIGIN, SURFACES, Surface
from trundle.maps.occupancy import MODES, Mode, PixelRule

# What lies beyond these is no map: the file is an image, or a number has slipped.
MAX_YAML_BYTES = 100_000
MIN_RESOLUTION, MAX_RESOLUTION = 1e-6, 1e3  # [m]
MAX_YAW = 1e6  # [rad]

USUAL_RESOLUTIONS = (0.005, 0.5)
"""Cells of an indoor map are between these [m]; finer and coarser ones are more often a slip of the point."""

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,9})?[ \t\r\n]*", re.ASCII)
_INTEGER = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]{1,7}|[0-9]{1,9})")
_TRUE = ("true", "yes", "on", "y")
_FALSE = ("false", "no", "off", "n")


@dataclass(frozen=True, slots=True)
class RosMapDescription:
    """Contents of a map's YAML file.

    Attributes:
        image: Name of the image, as written.
        image_place: `file:line:column` of that name.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of the lower-left pixel.
        rule: The conversion from pixels to cells.
        free_thresh_place: `file:line:column` of `free_thresh`.
        surface: Where surfaces lie in the occupied cells at the rim; a key of trundle's own, which ROS ignores.
    """

    image: str
    image_place: str
    resolution: float
    origin: Pose2D
    rule: PixelRule
    free_thresh_place: str
    surface: Surface = "border"


def load_description(path: str | os.PathLike[str]) -> RosMapDescription:
    """Read the YAML file of a ROS map.

    Raises:
        MapError: If it cannot be read, or a value is invalid.

    Warns:
        MapWarning: If the yaw of its origin is in degrees.
    """
    fields = read_fields(path)
    image, image_place = fields.text("image")
    rule = PixelRule(
        mode=parse_mode(fields),
        negate=parse_negate(fields),
        occupied_thresh=fields.number("occupied_thresh", low=0.0, high=1.0),
        free_thresh=fields.number("free_thresh", low=0.0, high=1.0),
    )
    if rule.free_thresh > rule.occupied_thresh:
        raise MapError(
            f"{fields.place('free_thresh')}: free_thresh {rule.free_thresh} is above occupied_thresh "
            f"{rule.occupied_thresh}: the two are probably swapped. Usual values are 0.196 and 0.65"
        )
    origin = parse_origin(fields)
    degrees = describe_degrees(fields)
    if degrees is not None:
        warnings.warn("; ".join(degrees), MapWarning, stacklevel=4)
    return RosMapDescription(
        image=image,
        image_place=image_place,
        resolution=fields.number("resolution", low=MIN_RESOLUTION, high=MAX_RESOLUTION),
        origin=origin,
        rule=rule,
        free_thresh_place=fields.place("free_thresh"),
        surface=parse_surface(fields),
    )


def read_fields(path: str | os.PathLike[str]) -> Fields:
    """Read the YAML file of a ROS map as its keys, without checking their values yet.

    Raises:
        MapError: If it cannot be read, is not a mapping, or is clearly another kind of file.
    """
    try:
        root = compose(path, max_bytes=MAX_YAML_BYTES, allow_duplicate_keys=True)
    except InputError as error:
        raise MapError(str(error)) from error
    kind = kind_of_keys(keys_of(root))
    if kind not in (None, MAP):
        raise MapError(describe_mismatch(str(Path(path)), kind, MAP))
    return Fields(root, str(Path(path)))


class Fields:
    """The keys of the document; the first of a repeated key counts, as in Nav2.

    Attributes:
        name: The file, for messages.
        nodes: The value of each key.
        keys: All keys in order, including repeated ones.
    """

    def __init__(self, root: yaml.Node, name: str) -> None:
        self.name = name
        if not isinstance(root, yaml.MappingNode):
            raise MapError(
                f"{place(root, name)}: not a map's YAML file: it must hold `image: …`, `resolution: …` and so on"
            )
        self.nodes: dict[str, yaml.Node] = {}
        self.keys: list[yaml.ScalarNode] = []
        for key, value in root.value:
            if isinstance(key, yaml.ScalarNode):
                self.keys.append(key)
                self.nodes.setdefault(key.value, value)

    def node(self, key: str) -> yaml.Node:
        """Return the value of a key; a missing one raises `MapError`."""
        if key not in self.nodes:
            near = next((other for other in self.nodes if other.lower() == key), None)
            hint = f" ({near!r} is written differently: keys are case-sensitive)" if near else ""
            raise MapError(
                f"{self.name}:1:1: the key {key!r} is missing{hint}; a map needs image, resolution, origin, negate, "
                "occupied_thresh and free_thresh"
            )
        return self.nodes[key]

    def place(self, key: str) -> str:
        """Return `file:line:column` of a key's value."""
        return place(self.node(key), self.name)

    def text(self, key: str) -> tuple[str, str]:
        """Return a key's text and its place."""
        node = self.node(key)
        if not isinstance(node, yaml.ScalarNode):
            raise MapError(f"{place(node, self.name)}: {key} must be text, got {_kind(node)}; write `{key}: …`")
        if node.value == "" or (node.style is None and node.value in ("~", "null", "Null", "NULL")):
            raise MapError(f"{place(node, self.name)}: {key} is blank; write a value")
        return node.value, place(node, self.name)

    def number(self, key: str, *, low: float, high: float) -> float:
        """Return a key's number within inclusive bounds."""
        value = parse_number(self.node(key), key, self.name)
        if not low <= value <= high:
            raise MapError(
                f"{self.place(key)}: {key} is {value:g}; it must be between {low:g} and {high:g}; correct it"
            )
        return value


def parse_number(node: yaml.Node, what: str, name: str) -> float:
    """Return a finite number, quoted or not, in decimal or scientific notation."""
    text = node.value if isinstance(node, yaml.ScalarNode) else _kind(node)
    if not isinstance(node, yaml.ScalarNode) or _NUMBER.fullmatch(text) is None:
        raise MapError(
            f"{place(node, name)}: {what} is {_shorten(text)}; it must be a finite number like 0.05 or 5e-2; correct it"
        )
    value = float(text)
    if not math.isfinite(value):
        raise MapError(f"{place(node, name)}: {what} {_shorten(text)} is too large for a number; correct it")
    return value


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.ScalarNode):
        return "one value"
    return "a list" if isinstance(node, yaml.SequenceNode) else "a mapping"


def _shorten(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:40] + "…") if text else "blank"


def parse_origin(fields: Fields) -> Pose2D:
    """Read `origin`: x [m], y [m], yaw [rad]."""
    node = fields.node("origin")
    if not isinstance(node, yaml.SequenceNode) or len(node.value) != 3:
        got = f"{len(node.value)} values" if isinstance(node, yaml.SequenceNode) else _kind(node)
        raise MapError(f"{place(node, fields.name)}: origin must be [x, y, yaw] in metres and radians, got {got}")
    x, y = (
        parse_number(item, f"origin's {what}", fields.name) for item, what in zip(node.value, ("x", "y"), strict=False)
    )
    yaw = _parse_yaw(node.value[2], fields.name)
    for item, what, value, most in zip(
        node.value, ("x", "y", "yaw"), (x, y, yaw), (MAX_ORIGIN, MAX_ORIGIN, MAX_YAW), strict=True
    ):
        if abs(value) > most:
            raise MapError(
                f"{place(item, fields.name)}: origin's {what} is {value:g}; it must be between {-most:g} and {most:g}; "
                "correct it"
            )
    return Pose2D(x, y, wrap_angle(yaw))


def _parse_yaw(node: yaml.Node, name: str) -> float:
    """Return the origin's yaw [rad]; `90deg` is read, too, though ROS does not."""
    if isinstance(node, yaml.ScalarNode) and _NUMBER.fullmatch(node.value) is None:
        with contextlib.suppress(ValueError):
            return parse_angle(node.value)
    return parse_number(node, "origin's yaw", name)


def describe_degrees(fields: Fields) -> tuple[str, str] | None:
    """Return the problem and the correct notation if the origin's yaw is in degrees, else None."""
    node = fields.node("origin").value[2]
    yaw = _parse_yaw(node, fields.name)
    where, right = place(node, fields.name), f"{math.radians(yaw):.6g}"
    if is_in_degrees(yaw):
        message = f"{where}: origin's yaw is {yaw:g} rad, more than one turn: it is read in radians, and was "
        return f"{message}probably meant in degrees", f"write {right}"
    if _NUMBER.fullmatch(node.value) is None:
        return f"{where}: origin's yaw is {node.value}, which ROS does not read", f"write {yaw:.6g}"
    return None


def describe_resolution(fields: Fields) -> tuple[str, str] | None:
    """Return the problem and what to do if the cell size is unlikely in metres, else None."""
    resolution = fields.number("resolution", low=MIN_RESOLUTION, high=MAX_RESOLUTION)
    low, high = USUAL_RESOLUTIONS
    if low <= resolution <= high:
        return None
    message = f"{fields.place('resolution')}: a cell of {resolution:g} m is unlikely: most maps have between {low:g} "
    return f"{message}and {high:g} m", "check the unit: it is metres per cell, most often 0.05"


def parse_mode(fields: Fields) -> Mode:
    """Read `mode`; trinary by default."""
    if "mode" not in fields.nodes:
        return "trinary"
    text, where = fields.text("mode")
    for mode in MODES:
        if text.lower() == mode:
            return mode
    raise MapError(f"{where}: mode is {_shorten(text)}; it must be one of {', '.join(MODES)}; correct it")


def parse_surface(fields: Fields) -> Surface:
    """Read `surface`; "border" by default."""
    if "surface" not in fields.nodes:
        return "border"
    text, where = fields.text("surface")
    for surface in SURFACES:
        if text == surface:
            return surface
    raise MapError(f"{where}: surface is {_shorten(text)}; it must be one of {', '.join(SURFACES)}; correct it")


def parse_negate(fields: Fields) -> bool:
    """Read `negate`: an integer or a YAML boolean."""
    text, where = fields.text("negate")
    if _INTEGER.fullmatch(text):
        return int(text, 16 if "x" in text.lower() else 10) != 0
    for words, value in ((_TRUE, True), (_FALSE, False)):
        if any(text in (word, word.upper(), word.capitalize()) for word in words):
            return value
    raise MapError(f"{where}: negate is {_shorten(text)}; it must be 0 or 1 (or false, true); correct it")
