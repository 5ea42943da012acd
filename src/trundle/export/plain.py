"""What the formats share: scenes, worlds without what other formats lack, and the text of XML."""

from __future__ import annotations

import pathlib
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from trundle.errors import OutputError, WorldError
from trundle.files.writing import make_folder
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.maps.masks import SpeedMask
from trundle.path import Path
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.shapes import Names
from trundle.worlds.walls import merge_cells

MOST_BOXES = 100_000
"""A map with more boxes than this for its blocked cells is refused: no program loads such a file in a useful time."""

_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class Scene:
    """A prepared scenario: world, robot, start and plans.

    Attributes:
        name: Shown in the exported file.
        world: The world.
        robot: The robot.
        start: Pose of base_link, map frame.
        paths: The planned paths to its goals, in order; empty if nothing was planned.
        speed_mask: Limits its speed, or None.
    """

    name: str
    world: World
    robot: Robot
    start: Pose2D
    paths: tuple[Path, ...] = ()
    speed_mask: SpeedMask | None = None


def plain_solids(world: World, *, reserved: tuple[str, ...] = ()) -> list[Solid]:
    """Return a world's solids, with blocked cells as boxes of the same space, named after their rows and columns.

    Args:
        world: The world.
        reserved: Names used by the format itself; a solid with such a name gets a number appended.

    Raises:
        WorldError: If the cells need more than MOST_BOXES boxes.
    """
    names = Names()
    for name in reserved:
        names.take(name)
    solids: list[Solid] = []
    for solid in world.solids:
        pieces = _boxes(solid, solid.shape) if isinstance(solid.shape, OccupancyCells) else [solid]
        solids += [replace(piece, name=names.take(piece.name)) for piece in pieces]
    return solids


def check_xml_names(what: str, names: list[str]) -> None:
    """Refuse names that an XML file cannot contain.

    Raises:
        WorldError: If one is empty or has a control character.
    """
    for name in names:
        if not name or _NOT_XML.search(name):
            raise WorldError(f"{what} cannot contain the name {name!r}: give a name of printable characters")


def check_encodable(names: Iterable[str]) -> None:
    """Refuse names that are not valid Unicode.

    Raises:
        WorldError: If one has half of a surrogate pair, as a file's name in another encoding has.
    """
    for name in names:
        try:
            name.encode()
        except UnicodeEncodeError as error:
            raise WorldError(f"the name {name!r} is not valid Unicode; rename the solid") from error


def mesh_folder(path: pathlib.Path) -> pathlib.Path:
    """Create the folder for the meshes of a file, `<stem>_meshes` beside it.

    Raises:
        OutputError: If the file's own folder does not exist, or cannot be written to.
    """
    if not path.parent.is_dir():
        raise OutputError(f"cannot write {path}: the folder {path.parent} does not exist")
    return make_folder(path.with_name(f"{path.stem}_meshes"))


def numbers(values: Iterable[float]) -> str:
    """Write numbers separated by spaces, each with the fewest digits that read back exactly."""
    return " ".join(_number(value) for value in np.asarray(list(values), dtype=np.float64).tolist())


def add(parent: ElementTree.Element, tag: str, text: str | None = None, **attributes: str) -> ElementTree.Element:
    """Add an element with a text and attributes."""
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text
    return element


def to_text(root: ElementTree.Element) -> str:
    """Write the text of a whole XML file, indented."""
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _boxes(solid: Solid, cells: OccupancyCells) -> list[Solid]:
    merged = merge_cells(cells.blocked.astype(np.uint8), most=MOST_BOXES)
    if merged is None:
        raise WorldError(
            f"the blocked cells of {solid.name!r} need more than {MOST_BOXES} boxes: make the map coarser, or export "
            "it as a map"
        )
    edge, height = cells.resolution, cells.height
    boxes: list[Solid] = []
    for row, row_end, col, col_end, _ in zip(*(column.tolist() for column in merged), strict=True):
        size = ((col_end - col) * edge, (row_end - row) * edge, height)
        middle = Pose3D(((col + col_end) * edge / 2.0, (row + row_end) * edge / 2.0, height / 2.0))
        name = f"{solid.name}[{row}:{row_end},{col}:{col_end}]"
        boxes.append(Solid(name, Box(size), solid.pose @ middle, solid.color, solid.kind))
    return boxes


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0") if text != "-0.0" else "0"
