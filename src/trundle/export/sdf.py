"""Worlds as SDF 1.9, Gazebo's format."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

from trundle.errors import WorldError
from trundle.export.plain import add, check_xml_names, mesh_folder, numbers, plain_solids, to_text
from trundle.files.writing import write_text
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere
from trundle.worlds import World
from trundle.worlds.shapes import Names


def export_world(world: World, path: Path) -> None:
    """Write a world: each solid is a static model of its name, with one collision and one visual in its colour.

    Meshes are OBJ files in a folder beside it, `<stem>_meshes`. In names `::`, which SDF reserves, is
    written as `/`, and `world` and `__…__`, which it reserves, get a number appended.

    Raises:
        WorldError: If a name cannot be written, or there are too many cells.
        OutputError: If a file cannot be written.
    """
    names = Names()
    solids = [replace(solid, name=_take_name(names, solid.name)) for solid in plain_solids(world)]
    check_xml_names("SDF", [world.name, *(solid.name for solid in solids)])
    root = ElementTree.Element("sdf", version="1.9")
    home = add(root, "world", None, name=world.name)
    _add_sun(home)
    _add_floor(home, {solid.name for solid in solids}, world.ground_z or 0.0)
    files = _write_meshes(path, solids)
    for solid in solids:
        link = _add_model(home, solid.name, solid.pose)
        for tag in ("collision", "visual"):
            shape = add(link, tag, None, name=tag)
            _add_geometry(add(shape, "geometry"), solid, files)
            if tag == "visual":
                _add_color(shape, solid.color)
    write_text(path, to_text(root))


def _take_name(names: Names, name: str) -> str:
    plain = name.replace("::", "/")
    # sdformat refuses a file with a model of this name.
    if plain == "world" or re.fullmatch("__.*__", plain, re.DOTALL):
        names.take(plain)
    return names.take(plain)


def _add_sun(home: ElementTree.Element) -> None:
    light = add(home, "light", None, type="directional", name="sun")
    add(light, "cast_shadows", "true")
    add(light, "pose", "0 0 20 0 0 0")
    add(light, "diffuse", "0.8 0.8 0.8 1")
    add(light, "direction", "0.25 0.2 -1")


def _add_floor(home: ElementTree.Element, taken: set[str], height: float) -> None:
    name = "floor"
    while name in taken:
        name += "_"
    link = _add_model(home, name, Pose3D((0.0, 0.0, height)))
    for tag in ("collision", "visual"):
        shape = add(link, tag, None, name=tag)
        plane = add(add(shape, "geometry"), "plane")
        add(plane, "normal", "0 0 1")
        add(plane, "size", "100 100")
        if tag == "visual":
            _add_color(shape, (0.66, 0.67, 0.68, 1.0))


def _add_model(home: ElementTree.Element, name: str, pose: Pose3D) -> ElementTree.Element:
    model = add(home, "model", None, name=name)
    add(model, "static", "true")
    w, x, y, z = pose.quaternion
    add(model, "pose", numbers((*pose.position, x, y, z, w)), rotation_format="quat_xyzw")
    return add(model, "link", None, name="link")


def _add_geometry(geometry: ElementTree.Element, solid: Solid, files: dict[str, str]) -> None:
    match solid.shape:
        case Box(size):
            add(add(geometry, "box"), "size", numbers(size))
        case Cylinder(radius, length):
            shape = add(geometry, "cylinder")
            add(shape, "radius", numbers((radius,)))
            add(shape, "length", numbers((length,)))
        case Sphere(radius):
            add(add(geometry, "sphere"), "radius", numbers((radius,)))
        case Mesh():
            add(add(geometry, "mesh"), "uri", files[solid.name])
        case _:
            raise WorldError(f"SDF cannot represent the shape of {solid.name!r}")


def _add_color(visual: ElementTree.Element, color: tuple[float, float, float, float]) -> None:
    material = add(visual, "material")
    add(material, "ambient", numbers(color))
    add(material, "diffuse", numbers(color))


def _write_meshes(path: Path, solids: list[Solid]) -> dict[str, str]:
    """Write the meshes; return each solid's file relative to the SDF's folder."""
    meshes = [(solid.name, solid.shape) for solid in solids if isinstance(solid.shape, Mesh)]
    if not meshes:
        return {}
    folder = mesh_folder(path)
    files: dict[str, str] = {}
    for number, (name, mesh) in enumerate(meshes, start=1):
        file = f"{number:04d}-{re.sub(r'[^A-Za-z0-9_.-]+', '_', name)[:60]}.obj"
        vertices = "\n".join(f"v {numbers(vertex)}" for vertex in mesh.vertices)
        faces = "\n".join(f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist())
        write_text(folder / file, f"{vertices}\n{faces}\n")
        files[name] = f"{folder.name}/{file}"
    return files
