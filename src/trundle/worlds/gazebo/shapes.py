"""Geometry and colours of SDF."""

from __future__ import annotations

import math

from trundle.errors import WorldError
from trundle.files.mesh import MeshPart
from trundle.files.opening import is_file
from trundle.files.xml_elements import XmlElement
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Sphere
from trundle.worlds.gazebo.elements import Place, child, children, read_flag, read_numbers, read_sizes, read_text
from trundle.worlds.gazebo.files import Files, MissingFileError
from trundle.worlds.shapes import Part, capsule_parts, ellipsoid_mesh
from trundle.worlds.tessellate import cone_mesh, rectangle_mesh

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
