"""MJCF and URDF files, read with MuJoCo's MjSpec: for worlds, and for robots.

MuJoCo only reads the file here: nothing is simulated.
"""

from __future__ import annotations

import logging
import math
import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast

import numpy as np

from trundle.errors import InputError
from trundle.files.mesh import read_mesh
from trundle.files.opening import check_regular, describe_unreadable, exists, is_file, parser_errors
from trundle.files.uris import describe_search, find_uri
from trundle.files.xacro import expand_xacro
from trundle.files.xml_elements import XmlElement, read_source, read_xml

if TYPE_CHECKING:
    import mujoco

GeometryChoice: TypeAlias = Literal["collision", "visual"]

logger = logging.getLogger(__name__)

# MuJoCo reads these formats without another library.
_AS_THEY_ARE = (".stl", ".obj")

_NUMBERS = {
    "box": (("size", 3, "above 0"),),
    "cylinder": (("radius", 1, "above 0"), ("length", 1, "above 0")),
    "sphere": (("radius", 1, "above 0"),),
    "mesh": (("scale", 3, "none of them 0"),),
    "origin": (("xyz", 3, "finite"), ("rpy", 3, "finite")),
}
"""Numeric attributes of URDF elements: how many numbers, and their allowed range."""


MAX_FILES = 1_000
"""Limit on included and attached files together."""

MAX_INCLUDES = 32
"""Limit on nested includes."""

MAX_ELEMENTS = 1_000_000
"""Limit on elements in all files, counted once per generated copy."""

MAX_SAMPLES = 20_000_000
"""Limit on the heights of a height field: MuJoCo gives no reason where it gets no memory for them."""

_COPIES = ("replicate", "composite", "flexcomp")
_FOLDERS = ("meshdir", "texturedir", "assetdir")


def log_warnings() -> None:
    """Make MuJoCo log its warnings; by default it writes a file MUJOCO_LOG.TXT in the working folder."""
    import mujoco

    mujoco.set_mju_user_warning(_log_warning)


def _log_warning(message: str | bytes) -> None:
    logger.warning("MuJoCo: %s", message if isinstance(message, str) else message.decode(errors="replace"))


def read_spec(
    path: Path, *, folders: tuple[Path, ...], error: type[InputError], geometry: GeometryChoice | None = None
) -> mujoco.MjSpec:
    """Read an MJCF or URDF file. Each URDF link stays a separate body, and its meshes are found and embedded.

    Args:
        path: The file.
        folders: Folders to search for package:// and model:// names, after the folders above the file.
        error: Type of the exception.
        geometry: For a URDF, read only its collision or only its visual geometry; by default both.

    Raises:
        InputError: Of the type `error`, if it cannot be read, is neither MJCF nor URDF, or a mesh is missing.
    """
    root = read_xml(path, error=error)
    if root.tag not in ("mujoco", "robot"):
        raise error(f"{path}: the root element is <{root.tag}>; MJCF has <mujoco> and URDF has <robot>")
    if root.tag == "mujoco":
        return read_mjcf(path, root, error=error)
    assets = _prepare_urdf(path, root, folders, error, geometry)
    text = ElementTree.tostring(root, encoding="unicode")
    return _parse(path, error, lambda mujoco: mujoco.MjSpec.from_string(text, assets=assets))


def read_mjcf(path: Path, root: XmlElement, *, error: type[InputError]) -> mujoco.MjSpec:
    """Read an MJCF file, or a part of one that others include.

    Args:
        path: The file.
        root: Its content.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if it cannot be read.
    """
    _check_mjcf(path, root, error=error)
    if path.suffix.lower() == ".xml":
        return _parse(path, error, lambda mujoco: mujoco.MjSpec.from_file(os.fspath(path)))
    # MuJoCo opens only .xml and .urdf: for .mjcf, pass it the text and the paths of the included files.
    folder = path.resolve().parent
    for element in root.iter("include"):
        element.set("file", os.fspath(folder / element.get("file", "")))
    text = ElementTree.tostring(root, encoding="unicode")
    spec = _parse(path, error, lambda mujoco: mujoco.MjSpec.from_string(text))
    spec.modelfiledir = os.fspath(folder)
    return spec


def _parse(path: Path, error: type[InputError], parse: Callable[[Any], mujoco.MjSpec]) -> mujoco.MjSpec:
    import mujoco

    log_warnings()
    with parser_errors(f"{path}: MuJoCo cannot read it", error):
        return parse(mujoco)


def compile_spec(path: Path, spec: mujoco.MjSpec, *, error: type[InputError]) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Compile a model and compute the poses of its bodies in the initial state.

    Raises:
        InputError: Of the type `error`, if MuJoCo cannot build it.
    """
    import mujoco

    with parser_errors(f"{path}: MuJoCo cannot build it", error):
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
    return model, data


def drop_textures(spec: mujoco.MjSpec) -> None:
    """Remove textures and skins, whose files may be missing; the materials' colours stay."""
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for assets in (spec.skins, spec.textures):
        for asset in list(assets):
            spec.delete(asset)


def _prepare_urdf(
    path: Path,
    robot: XmlElement,
    folders: tuple[Path, ...],
    error: type[InputError],
    geometry: GeometryChoice | None,
) -> dict[str, bytes]:
    """Adapt a URDF in place to MuJoCo's reader; return its meshes by their new names."""
    expand_xacro(path, robot, error=error)
    for extension in robot.findall("mujoco"):
        robot.remove(extension)
    for element in robot.iter():
        _check_numbers(f"{path}:{cast('XmlElement', element).line}", element, error)
    # By default MuJoCo fuses links on fixed joints, drops visual geometry and strips the folders of meshes.
    settings = {"fusestatic": "false", "discardvisual": "false", "strippath": "false", "balanceinertia": "true"}
    ElementTree.SubElement(ElementTree.SubElement(robot, "mujoco"), "compiler", settings)
    unwanted = {"collision": "visual", "visual": "collision"}.get(geometry or "")
    for link in robot.iter("link"):
        for element in link.findall(unwanted) if unwanted else []:
            link.remove(element)
    assets: dict[str, bytes] = {}
    names: dict[Path, str] = {}
    for element in robot.iter("mesh"):
        uri = element.get("filename", "").strip()
        where = f"{path}:{cast('XmlElement', element).line}"
        found = find_uri(uri, path.parent, folders)
        if found is None or not is_file(found):
            raise error(
                f"{where}: the mesh {uri!r} was not found; searched: {describe_search(folders)}. Give its folder with "
                "--paths FOLDER (paths=…)"
            )
        key = found.resolve()
        if key not in names:
            stem = f"{len(names)}-{found.stem}"
            names[key], content = _mesh_asset(where, found, stem, error)
            assets[names[key]] = content
        element.set("filename", names[key])
    return assets


def _check_numbers(where: str, element: ElementTree.Element, error: type[InputError]) -> None:
    """Check the numbers of a URDF's shapes and poses, which MuJoCo does not check or reports without the link."""
    for name, count, rule in _NUMBERS.get(element.tag, ()):
        text = element.get(name)
        if text is None:
            continue
        try:
            numbers = np.array([float(word) for word in text.split()])
        except ValueError:
            numbers = np.zeros(0)
        sound = numbers.shape == (count,) and bool(np.isfinite(numbers).all())
        if rule == "above 0":
            sound = sound and bool((numbers > 0.0).all())
        elif rule == "none of them 0":
            sound = sound and bool((numbers != 0.0).all())
        if not sound:
            what = "a number" if count == 1 else f"{count} numbers"
            raise error(f"{where}: {name} of <{element.tag}> must be {what}, {rule}, got {text[:80]!r}")


def _mesh_asset(where: str, path: Path, stem: str, error: type[InputError]) -> tuple[str, bytes]:
    """Return a mesh's name and content for MuJoCo, as binary STL if MuJoCo cannot read the format."""
    suffix = path.suffix.lower()
    if suffix in _AS_THEY_ARE:
        content = read_source(path, error=error)
        if not (suffix == ".stl" and content[:5] == b"solid"):
            return stem + suffix, content
    try:
        parts = read_mesh(path)
    except InputError as problem:
        raise error(f"{where}: {problem}") from problem
    corners = np.concatenate([part.vertices[part.faces] for part in parts])
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    triangles = np.zeros(len(corners), dtype=record)
    triangles["corners"] = corners
    return stem + ".stl", bytes(80) + np.uint32(len(corners)).tobytes() + triangles.tobytes()


def _check_mjcf(path: Path, root: XmlElement, *, error: type[InputError]) -> None:
    """Check an MJCF file and those that it includes or attaches, before MuJoCo reads them.

    MuJoCo's reader recurses into a model that attaches itself until it crashes, blocks on pipes, and creates any number
    of copies.

    Args:
        path: The file.
        root: Its content.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if a file includes itself, is not a regular file or not XML, or a limit is
            exceeded; the message has file and line.
    """
    _MjcfCheck(error, path.parent).check(path, root, ())


@dataclass(slots=True)
class _MjcfCheck:
    """Walks through an MJCF file and those that it includes.

    Attributes:
        error: Type of the exception.
        home: Folder of the main file.
        files: Number of files visited.
        elements: Number of elements, counted once per generated copy.
    """

    error: type[InputError]
    home: Path
    files: int = 0
    elements: int = 0
    _folders: list[Path] = field(default_factory=list[Path])

    def check(self, path: Path, root: XmlElement, above: tuple[Path, ...]) -> None:
        """Check a file; `above` are the files that include it."""
        above = (*above, path.resolve())
        self._folders += [
            self.home / folder
            for compiler in root.iter("compiler")
            for folder in map(compiler.get, _FOLDERS)
            if folder is not None
        ]
        for element, copies in _elements_with_copies(root, 1):
            where = f"{path}:{element.line}"
            self.elements += copies
            if self.elements > MAX_ELEMENTS:
                raise self.error(f"{where}: this generates more than {MAX_ELEMENTS} elements; use fewer copies")
            if element.tag == "hfield":
                self._check_heights(where, element)
            name = element.get("file")
            if name is None:
                continue
            found = self._find(path, name)
            if found is None:
                continue  # if MuJoCo needs it, MuJoCo reports that it is missing
            try:
                check_regular(found)
            except OSError as problem:
                raise self.error(f"{where}: {describe_unreadable(found, problem)}") from problem
            if element.tag in ("include", "model"):
                self._enter(where, found, above)

    def _check_heights(self, where: str, element: XmlElement) -> None:
        """Check the size of a height field; MuJoCo checks all else of it."""
        try:
            rows, cols = (int(element.get(name, "0")) for name in ("nrow", "ncol"))
        except ValueError:
            return  # MuJoCo reports it
        if min(rows, cols) < 0 or rows * cols > MAX_SAMPLES:
            raise self.error(
                f"{where}: a height field has up to {MAX_SAMPLES} heights, got nrow {rows} and ncol {cols}; "
                "make it coarser, or correct the numbers"
            )

    def _enter(self, where: str, file: Path, above: tuple[Path, ...]) -> None:
        if file.resolve() in above:
            raise self.error(f"{where}: {file.name} includes itself; take one of its includes out")
        self.files += 1
        if self.files > MAX_FILES or len(above) > MAX_INCLUDES:
            raise self.error(
                f"{where}: this model includes more than {MAX_FILES} files, or nests them more than {MAX_INCLUDES} deep"
            )
        if file.suffix.lower() in (".xml", ".mjcf", ".urdf"):
            self.check(file, read_xml(file, error=self.error), above)

    def _find(self, path: Path, name: str) -> Path | None:
        folders = (path.parent, self.home, *self._folders)
        return next((folder / name for folder in folders if exists(folder / name)), None)


def _elements_with_copies(root: XmlElement, copies: int) -> Iterator[tuple[XmlElement, int]]:
    """Yield all elements, each with its number of generated copies."""
    stack = [(root, copies)]
    while stack:
        element, times = stack.pop()
        if element.tag in _COPIES:
            times *= _count_copies(element)
        yield element, times
        stack.extend((cast("XmlElement", child), times) for child in element)


def _count_copies(element: XmlElement) -> int:
    """Return the number of copies that an element generates; 1 if MuJoCo cannot parse it."""
    try:
        return max(1, math.prod(int(word) for word in element.get("count", "1").split()))
    except ValueError:
        return 1
