"""Geometry and colours of SDF, and the files that a world refers to: meshes, included models, built-in models."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from trundle.errors import WorldError
from trundle.files.mesh import MeshPart, read_mesh
from trundle.files.opening import is_file
from trundle.files.uris import describe_search, find_uri
from trundle.files.xml_elements import XmlElement, parse_xml, read_xml
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Sphere
from trundle.worlds.gazebo.elements import (
    VERSIONS,
    Place,
    child,
    children,
    read_flag,
    read_numbers,
    read_sizes,
    read_text,
)
from trundle.worlds.shapes import Part, capsule_parts, ellipsoid_mesh
from trundle.worlds.tessellate import cone_mesh, rectangle_mesh

_PLAIN_FLOOR = b"""
<sdf version='1.6'><model name='ground_plane'><static>true</static><link name='link'><collision name='collision'>
<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model></sdf>
"""
"""Definition of Gazebo's `Ground Plane`."""


class MissingFileError(WorldError):
    """A mesh or a model that a world refers to is missing."""


@dataclass(slots=True)
class Files:
    """Resolves URIs, and caches the meshes that were read.

    Attributes:
        folders: Folders to search for models and packages.
    """

    folders: tuple[Path, ...]
    _meshes: dict[Path, list[MeshPart]] = field(default_factory=dict[Path, list[MeshPart]])

    def find(self, uri: str, base: Path) -> Path | None:
        """Return the file or folder that a URI refers to, relative to the folder `base`; see `find_uri`."""
        return find_uri(uri, base, self.folders)

    def mesh(self, path: Path) -> list[MeshPart]:
        """Return the meshes of a file."""
        key = path.resolve()
        if key not in self._meshes:
            self._meshes[key] = read_mesh(path)
        return self._meshes[key]

    def advise(self) -> str:
        """Return the searched folders and what to do about a missing file, for messages."""
        return (
            f"searched: {describe_search(self.folders)}. Give its folder with --paths FOLDER (paths=…), or skip "
            "missing files with --set missing=skip"
        )


def find_model_file(path: Path | None) -> Path | None:
    """Return the SDF file of a model: the file itself, or the newest supported version that a model.config lists."""
    if path is None or is_file(path):
        return path
    config = path / "model.config"
    if is_file(config):
        named: list[tuple[int, Path]] = []
        for element in read_xml(config, error=WorldError).iter("sdf"):
            file, version = path / (element.text or "").strip(), element.get("version", "").strip()
            if is_file(file):
                named.append((VERSIONS.index(version) if version in VERSIONS else -1, file))
        if named:
            # The last of equally new ones, as in Gazebo.
            return max(reversed(named), key=lambda entry: entry[0])[1]
    return path / "model.sdf" if is_file(path / "model.sdf") else None


def is_plain_floor(uri: str) -> bool:
    """Return whether a URI is that of Gazebo's `Ground Plane`, by model:// or on Fuel."""
    return _plain_name(uri) == "ground plane"


def is_sun(uri: str) -> bool:
    """Return whether a URI is that of Gazebo's `Sun`, a light."""
    return _plain_name(uri) == "sun"


def read_plain_floor(file: Path) -> XmlElement:
    """Return Gazebo's `Ground Plane`, as if it were read from a file."""
    return parse_xml(file, _PLAIN_FLOOR, error=WorldError)


def _plain_name(uri: str) -> str:
    """Return the name of the model in a URI, in lower case with spaces; empty if the URI is not a model's."""
    path = re.sub(r"/(\d+|tip)$", "", unquote(uri).strip().rstrip("/"))
    scheme, mark, rest = path.partition("://")
    words = rest.split("/")
    if not mark or (scheme == "model" and len(words) != 1) or (scheme != "model" and "models" not in words):
        return ""
    return words[-1].lower().replace("_", " ")


_READ = ("box", "cylinder", "sphere", "capsule", "ellipsoid", "cone", "plane", "mesh")
_NOT_READ = ("heightmap", "image", "polyline")

# Gazebo's media/materials/scripts/gazebo.material: plain colours of the material scripts that worlds refer to.
_SCRIPT_COLORS: dict[str, tuple[float, float, float]] = {
    "Gazebo/Grey": (0.7, 0.7, 0.7),
    "Gazebo/DarkGrey": (0.175, 0.175, 0.175),
    "Gazebo/White": (1.0, 1.0, 1.0),
    "Gazebo/Black": (0.0, 0.0, 0.0),
    "Gazebo/Red": (1.0, 0.0, 0.0),
    "Gazebo/Green": (0.0, 1.0, 0.0),
    "Gazebo/Blue": (0.0, 0.0, 1.0),
    "Gazebo/Yellow": (1.0, 1.0, 0.0),
    "Gazebo/Orange": (1.0, 0.5, 0.0),
    "Gazebo/Purple": (1.0, 0.0, 1.0),
    "Gazebo/Turquoise": (0.0, 1.0, 1.0),
    "Gazebo/Wood": (0.6, 0.45, 0.3),
    "Gazebo/Bricks": (0.55, 0.3, 0.25),
}


def read_geometry(place: Place, element: XmlElement, files: Files) -> list[Part] | str:
    """Return shapes of a <geometry>; or a text that names the geometry that is left out.

    A plane is a rectangle, even if it is the floor.

    Raises:
        WorldError: If it cannot be used.
        MissingFileError: If its mesh is missing.
    """
    kinds = children(element, *_READ, "empty", *_NOT_READ)
    if len(kinds) != 1:
        there = ", ".join(f"<{item.tag}>" for item in element) or "nothing"
        place.fail(element, f"<geometry> needs one shape of {', '.join((*_READ, 'empty'))}; it has {there}")
    shape = kinds[0]
    match shape.tag:
        case "box":
            x, y, z = read_sizes(place, shape, "size", 3)
            return [Part(Box((x, y, z)))]
        case "cylinder":
            return [Part(Cylinder(*_radius_and_length(place, shape)))]
        case "sphere":
            return [Part(Sphere(*read_sizes(place, shape, "radius", 1)))]
        case "capsule":
            return capsule_parts(*_radius_and_length(place, shape))
        case "ellipsoid":
            x, y, z = read_sizes(place, shape, "radii", 3)
            return [Part(ellipsoid_mesh((x, y, z)))]
        case "cone":
            return [Part(cone_mesh(*_radius_and_length(place, shape)))]
        case "plane":
            return [_read_plane(place, shape)]
        case "mesh":
            return _read_mesh(place, shape, files)
        case "empty":
            return []
        case _:
            return f"<{shape.tag}>"


def _radius_and_length(place: Place, element: XmlElement) -> tuple[float, float]:
    (radius,), (length,) = (read_sizes(place, element, tag, 1) for tag in ("radius", "length"))
    return radius, length


def _read_plane(place: Place, element: XmlElement) -> Part:
    normal, size = child(element, "normal"), child(element, "size")
    x, y, z = (0.0, 0.0, 1.0) if normal is None else read_numbers(place, normal, 3)
    width, length = (1.0, 1.0) if size is None else read_numbers(place, size, 2, positive=True)
    if x == y == z == 0.0:
        place.fail(normal, "<normal> must not be 0 0 0")
    turn = Pose3D.from_rpy((0.0, 0.0, 0.0), (0.0, math.atan2(math.hypot(x, y), z), 0.0))
    return Part(rectangle_mesh(width, length), pose=Pose3D.planar(0.0, 0.0, 0.0, math.atan2(y, x)) @ turn)


def read_color(visual: XmlElement) -> Color | None:
    """Return the colour of a visual's material: diffuse, else ambient, else that of a Gazebo script, else None."""
    material = child(visual, "material")
    if material is None:
        return None
    for tag in ("diffuse", "ambient"):
        words = material.findtext(tag, "").split()
        try:
            numbers = [min(max(float(word), 0.0), 1.0) for word in words]
        except ValueError:
            continue
        if len(numbers) in (3, 4):
            red, green, blue, alpha = (*numbers, 1.0)[:4]
            return (red, green, blue, alpha)
    script = _SCRIPT_COLORS.get(material.findtext("script/name", "").strip())
    return None if script is None else (*script, 1.0)


def _read_mesh(place: Place, element: XmlElement, files: Files) -> list[Part]:
    uri = read_text(place, element, "uri")
    path = files.find(uri, place.file.parent)
    if path is None or not is_file(path):
        raise MissingFileError(
            f"{place.file}:{element.line}: model {place.model!r}: the mesh {uri!r} was not found; {files.advise()}"
        )
    scale = child(element, "scale")
    x, y, z = (1.0, 1.0, 1.0) if scale is None else read_numbers(place, scale, 3)
    if 0.0 in (x, y, z):
        place.fail(scale, f"<scale> must not be 0 along any axis, got {x:g} {y:g} {z:g}")
    try:
        parts = _pick_submesh(place, element, files.mesh(path))
    except WorldError as error:
        raise WorldError(f"{place.file}:{element.line}: model {place.model!r}: {error}") from error
    suffixes = [f"/{part.name}" if len(parts) > 1 else "" for part in parts]
    return [
        Part(part.scaled((x, y, z)), suffix, color=part.color) for part, suffix in zip(parts, suffixes, strict=True)
    ]


def _pick_submesh(place: Place, element: XmlElement, parts: list[MeshPart]) -> list[MeshPart]:
    submesh = child(element, "submesh")
    if submesh is None:
        return parts
    name = read_text(place, submesh, "name")
    picked = [part for part in parts if name in (part.name, part.geometry)]
    if not picked:
        raise WorldError(f"there is no submesh {name!r}; there are: {', '.join(sorted({part.name for part in parts}))}")
    if not read_flag(place, submesh, "center", default=False):
        return picked
    return [part.centred() for part in picked]
