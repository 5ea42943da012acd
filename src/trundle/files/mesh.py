"""Mesh files, through trimesh: flattened to one frame, in metres, with z up."""

from __future__ import annotations

import importlib
import json
import math
import os
import struct
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, WorldError
from trundle.extras import missing_extra
from trundle.files.opening import (
    check_regular,
    describe_unreadable,
    exists,
    open_file,
    parser_errors,
    parser_reason,
    read_up_to,
)
from trundle.files.xml_elements import parse_xml, read_source
from trundle.geometry import FloatArray
from trundle.geometry.solids import Color, Mesh

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
"""Length of each unit [m]."""

MAX_BYTES = 1024**3
"""Size limit of a mesh file."""

_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
_GLTF = (".glb", ".gltf")
_LOST_EXTENSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing")


@dataclass(frozen=True, slots=True, eq=False)
class MeshPart:
    """One mesh of a file, with the file's transforms applied.

    Attributes:
        name: Name of its node in the file.
        geometry: Name of the mesh itself, which several nodes may share.
        vertices: [m], z up, shape (V, 3).
        faces: Indices into `vertices`, shape (F, 3).
        color: Colour from the file, or None.
    """

    name: str
    geometry: str
    vertices: FloatArray
    faces: npt.NDArray[np.int32]
    color: Color | None

    def scaled(self, scale: tuple[float, float, float]) -> Mesh:
        """Return it as a shape, scaled along the axes. Faces of a mirrored mesh are flipped to face outward."""
        return Mesh(self.vertices * np.asarray(scale), self.faces if np.prod(scale) > 0.0 else self.faces[:, ::-1])

    def centred(self) -> MeshPart:
        """Return a copy with the centre of its bounding box at the origin."""
        middle = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0
        return replace(self, vertices=self.vertices - middle)


def read_mesh(path: Path, *, up: str | None = None, unit: str | float | None = None) -> list[MeshPart]:
    """Read all meshes of a file (GLB, glTF, OBJ, STL, PLY, COLLADA); duplicate vertices are merged.

    Args:
        path: The file.
        up: The file's upward axis, "y" or "z"; by default that of the format (glTF: y; COLLADA: as in the file), or z
            for OBJ, STL and PLY, which do not store it.
        unit: The file's unit: m, cm, mm, km, in, ft, or its length in metres; by default that of the format
            (glTF: m; COLLADA: as in the file), or m for OBJ, STL and PLY, which do not store it.

    Raises:
        WorldError: If it cannot be read, has no faces, has vertices that are not finite numbers, or a scale of 0.
        InputError: If an option is out of range.
        MissingExtraError: If the library that reads it is not installed.
    """
    if up not in (None, "y", "z"):
        raise InputError(f"up is {up!r}; it must be 'y' or 'z'")
    factor = None if unit is None else _metres(unit)
    suffix = path.suffix.lower()
    file_up, file_unit = (
        ("y", 1.0) if suffix in _GLTF else _read_collada_asset(path) if suffix == ".dae" else ("z", 1.0)
    )
    turn = (_Y_UP if (up or file_up) == "y" else np.eye(3)) * (file_unit if factor is None else factor)
    parts = [_flatten(f"{path}: mesh {node.name!r}", node, turn) for node in _read_nodes(path)]
    if not parts:
        raise WorldError(f"{path}: contains no mesh with faces; export it as triangles, not as points or lines")
    return parts


class _Node(NamedTuple):
    """A node with a mesh, as read by trimesh: plain arrays, not yet checked."""

    name: str
    geometry: str
    transform: FloatArray
    vertices: FloatArray
    faces: npt.NDArray[np.int64]
    rgba: Any


def _read_nodes(path: Path) -> list[_Node]:
    """Return the nodes with a mesh, sorted by name, as trimesh's order is that of a set; skip points and lines."""
    scene = _load_scene(path)
    with parser_errors(f"{path}: its node graph has a cycle or is not connected", WorldError):
        nodes = sorted(scene.graph.nodes_geometry, key=str)
        placed = [(node, *scene.graph[node]) for node in nodes]
    with parser_errors(f"{path}: its meshes cannot be read", WorldError):
        return [
            _Node(
                str(node if len(placed) > 1 else geometry).strip() or path.stem,
                str(geometry),
                np.asarray(transform, dtype=np.float64),
                np.asarray(mesh.vertices, dtype=np.float64),
                np.asarray(mesh.faces, dtype=np.int64),
                _read_rgba(mesh),
            )
            for node, transform, geometry in placed
            for mesh in (scene.geometry[geometry],)
            if getattr(mesh, "faces", None) is not None
        ]


def _flatten(where: str, node: _Node, turn: FloatArray) -> MeshPart:
    transform, vertices, faces = node.transform, node.vertices, node.faces
    if len(faces) == 0:
        raise WorldError(f"{where} has no faces")
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise WorldError(f"{where} has vertices or faces that are not three numbers each")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise WorldError(f"{where} has faces with vertex indices outside 0..{len(vertices) - 1}")
    if not np.isfinite(vertices[np.unique(faces)]).all():
        raise WorldError(f"{where} has vertices that are not finite numbers")
    linear = turn @ transform[:3, :3]
    size = np.linalg.norm(linear, axis=0)
    if not np.isfinite(transform).all() or size.min() <= 0.0 or abs(np.linalg.det(linear / size)) < 1e-9:
        raise WorldError(f"{where} has a scale of 0 or a transform that is not invertible")
    with np.errstate(over="ignore", invalid="ignore"):
        placed = np.nan_to_num(vertices) @ linear.T + turn @ transform[:3, 3]
    if not np.isfinite(placed).all() or np.ptp(placed, axis=0).max() <= 0.0:
        raise WorldError(f"{where} has no extent, or an infinite one")
    corners, index = np.unique(placed, axis=0, return_inverse=True)
    joined = index.reshape(-1)[faces]
    if np.linalg.det(linear) < 0.0:
        joined = joined[:, ::-1]
    # Drop triangles that the merge has collapsed to lines.
    kept = (joined[:, 0] != joined[:, 1]) & (joined[:, 1] != joined[:, 2]) & (joined[:, 2] != joined[:, 0])
    if not kept.any():
        raise WorldError(f"{where} has only faces without area")
    used, index = np.unique(joined[kept], return_inverse=True)
    return MeshPart(
        node.name, node.geometry, corners[used], index.reshape(-1, 3).astype(np.int32), _color_of(node.rgba)
    )


def _load_scene(path: Path) -> Any:
    try:
        import trimesh
    except ImportError as error:
        raise missing_extra("reading meshes", "trimesh", "mesh") from error
    try:
        size = check_regular(path)
    except OSError as error:
        raise WorldError(describe_unreadable(path, error)) from error
    if size > MAX_BYTES:
        raise WorldError(
            f"{path}: {size} bytes exceeds the limit of {MAX_BYTES} bytes for a mesh file; simplify the mesh"
        )
    if path.suffix.lower() in _GLTF:
        _check_gltf(path)
    if path.suffix.lower() == ".dae":
        _check_collada_reader()
    options = {"split_objects": True} if path.suffix.lower() == ".obj" else {}
    named = _named_files(path)
    try:
        scene = cast("Any", trimesh).load_scene(str(path), process=False, resolver=named, **options)
    except Exception as error:  # readers raise any exception on a broken file
        reason = named.refused or parser_reason(error)
        if isinstance(error, ImportError):  # trimesh asks for a library that guesses the text encoding
            reason = "it is not UTF-8 text"
        raise WorldError(f"{path}: cannot be read as a {path.suffix} file: {reason}") from error
    if named.refused:  # the reader went on without the missing file
        raise WorldError(f"{path}: {named.refused}")
    return scene


def _named_files(path: Path) -> Any:
    """Open the files that a mesh file refers to: regular files in its folder and below."""
    from trimesh.resolvers import FilePathResolver

    class NamedFiles(FilePathResolver):
        refused = ""

        def absolute(self, name: str) -> Path:
            found = super().absolute(name)
            if not exists(found):
                return found
            try:
                if check_regular(found) > MAX_BYTES:
                    raise OSError(f"more than {MAX_BYTES} bytes")
            except OSError as problem:
                self.refused = f"it refers to {name!r}, which cannot be read: {problem.strerror or problem}"
                raise ValueError(self.refused) from problem
            return found

    return NamedFiles(str(path))


def _check_collada_reader() -> None:
    """Refuse COLLADA if trimesh has no reader for it: its own errors do not name the missing library."""
    try:
        importlib.import_module("collada")
    except ImportError as error:
        raise missing_extra("reading .dae files", "pycollada", "mesh") from error


def _check_gltf(path: Path) -> None:
    """Refuse files that trimesh would read as empty or only in part, and headers with a wrong file size."""
    with open_file(path) as file:
        size = os.fstat(file.fileno()).st_size
        head = file.read(20)
        if head[:4] == b"glTF" and len(head) == 20:
            _, _, whole, length = struct.unpack_from("<4sIII", head)
            if whole > size or length > size - len(head):
                raise WorldError(
                    f"{path}: truncated: its header declares more bytes than the file has ({size}); "
                    "copy or export it again"
                )
        else:
            file.seek(0)
            length = size
        content = read_up_to(file, length)
    try:
        used = json.loads(content).get("extensionsUsed", [])
    except RecursionError as error:
        raise WorldError(f"{path}: its JSON is nested too deeply to be read") from error
    except (ValueError, AttributeError, TypeError):
        return  # trimesh reports what is wrong with it
    if not isinstance(used, list):
        raise WorldError(f"{path}: extensionsUsed must be a list of names")
    lost = [name for name in _LOST_EXTENSIONS if name in used]
    if lost:
        raise WorldError(f"{path}: it uses {', '.join(lost)}, which is not supported; export it without")


def _read_collada_asset(path: Path) -> tuple[str, float]:
    """Return the upward axis and the unit [m] of a COLLADA file. Document types are refused before trimesh reads it."""
    root = parse_xml(path, read_source(path, error=WorldError), error=WorldError)
    up, unit = "y", 1.0
    for element in root.iter():
        tag = element.tag.rpartition("}")[2].rpartition(":")[2]
        if tag == "up_axis":
            up = {"Z_UP": "z", "Y_UP": "y"}.get((element.text or "").strip(), "")
            if not up:
                raise WorldError(f"{path}: up_axis is {element.text!r}; it must be Y_UP or Z_UP")
        elif tag == "unit" and "meter" in element.attrib:
            unit = _metres(element.attrib["meter"])
    return up, unit


def _metres(unit: str | float) -> float:
    if isinstance(unit, str) and unit in UNITS:
        return UNITS[unit]
    try:
        metres = float(unit)
    except ValueError:
        metres = math.nan
    if not (math.isfinite(metres) and metres > 0.0):
        raise InputError(f"unit is {unit!r}; it must be one of {', '.join(UNITS)}, or a positive number of metres")
    return metres


def _read_rgba(mesh: Any) -> Any:
    """Return a mesh's colour, channels 0 to 255: that of its material, or the mean of its faces."""
    visual = getattr(mesh, "visual", None)
    kind = getattr(visual, "kind", None)
    if visual is None or kind is None:
        return None
    if kind == "texture":
        return getattr(getattr(visual, "material", None), "main_color", None)
    return np.asarray(visual.face_colors, dtype=np.float64).mean(axis=0)


def _color_of(rgba: Any) -> Color | None:
    if np.shape(rgba) != (4,):
        return None
    red, green, blue, alpha = (float(np.clip(channel, 0.0, 255.0)) / 255.0 for channel in rgba)
    return (red, green, blue, alpha)
