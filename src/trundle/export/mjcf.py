"""Worlds, robots and both together as MJCF, MuJoCo's format."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, WorldError
from trundle.export.plain import Scene, add, check_xml_names, numbers, plain_solids, to_text
from trundle.files.writing import write_text
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere
from trundle.robots import Robot
from trundle.sim.convex import Pieces, take_apart
from trundle.sim.mujoco.model import build_spec, robot_spec
from trundle.sim.mujoco.robot_parts import BASE
from trundle.sim.mujoco.world_parts import FLOOR, GROUP_PIECES, at_least_four
from trundle.worlds import World
from trundle.worlds.floors import lower_solid
from trundle.worlds.mjcf import PIECE


def export_world(world: World, path: Path, *, robot: Robot | None = None) -> None:
    """Write a world, or with a robot the whole model that trundle simulates.

    Without a robot each solid is one geom of its name, meshes with their vertices in the file. MuJoCo collides only
    convex bodies: any other mesh is only visual, and collides as hidden convex pieces; see `trundle.sim.convex`. The
    floor is a plane, at z = 0 or where the world's ground is.

    Raises:
        WorldError: If a name or a mesh cannot be written, or there are too many cells.
        OutputError: If the file cannot be written.
    """
    if robot is not None:
        _write_spec(build_spec(world, robot), path)
        return
    solids = plain_solids(world, reserved=(FLOOR,))
    check_xml_names("MJCF", [world.name, *(solid.name for solid in solids)])
    root = ElementTree.Element("mujoco", model=world.name)
    add(root, "compiler", angle="radian", autolimits="true")
    add(root, "statistic", extent="10")
    asset = add(root, "asset")
    texture = {"type": "2d", "builtin": "flat", "mark": "edge", "width": "256", "height": "256"}
    add(asset, "texture", None, name="world:floor", rgb1="0.66 0.67 0.68", markrgb="0.57 0.58 0.60", **texture)
    add(asset, "material", None, name="world:floor", texture="world:floor", texuniform="true", texrepeat="1 1")
    body = add(root, "worldbody")
    add(body, "light", None, type="directional", dir="0.25 0.2 -1", pos="0 0 20", diffuse="0.6 0.6 0.6")
    ground = world.ground_z or 0.0
    place = {"pos": numbers((0.0, 0.0, ground))} if ground else {}
    add(body, "geom", None, name=FLOOR, type="plane", size="0 0 0.05", material="world:floor", **place)
    pieces = _take_apart(solids, ground)
    for solid in solids:
        _add_solid(asset, body, solid, pieces.get(solid.name))
    text = to_text(root)
    try:
        mujoco.MjSpec.from_string(text).compile()
    except ValueError as error:
        raise WorldError(f"MuJoCo cannot represent the world {world.name!r}: {error}") from error
    write_text(path, text)


def export_robot(robot: Robot, path: Path) -> None:
    """Write a robot: bodies with masses and inertias, joints, colliders, visuals and the servos of its wheels.

    Raises:
        OutputError: If the file cannot be written.
    """
    _write_spec(robot_spec(robot, floor=True), path)


def export_scene(scene: Scene, path: Path) -> None:
    """Write the whole model that trundle simulates, with the robot at its start.

    Raises:
        WorldError: If the world cannot be written.
        OutputError: If the file cannot be written.
    """
    spec = build_spec(scene.world, scene.robot)
    start = Pose3D.planar(scene.start.x, scene.start.y, 0.0, scene.start.yaw)
    base = spec.body(BASE)
    base.pos, base.quat = start.position, start.quaternion
    _write_spec(spec, path)


def _write_spec(spec: mujoco.MjSpec, path: Path) -> None:
    try:
        spec.compile()
    except ValueError as error:
        raise InputError(f"MuJoCo cannot represent the model {spec.modelname!r}: {error}") from error
    write_text(path, spec.to_xml())


def _add_solid(
    asset: ElementTree.Element, body: ElementTree.Element, solid: Solid, pieces: Pieces | None = None
) -> None:
    place = {
        "name": solid.name,
        "pos": numbers(solid.pose.position),
        "quat": numbers(solid.pose.quaternion),
        "rgba": numbers(solid.color),
    }
    match solid.shape:
        case Box(size):
            add(body, "geom", None, type="box", size=numbers(edge / 2.0 for edge in size), **place)
        case Cylinder(radius, length):
            add(body, "geom", None, type="cylinder", size=numbers((radius, length / 2.0)), **place)
        case Sphere(radius):
            add(body, "geom", None, type="sphere", size=numbers((radius,)), **place)
        case Mesh() as mesh:
            _add_mesh(asset, solid.name, mesh.vertices, mesh.faces)
            if pieces is not None and not pieces.whole:
                place |= {"contype": "0", "conaffinity": "0"}
                _add_pieces(asset, body, solid.name, pieces)
            add(body, "geom", None, type="mesh", mesh=solid.name, **place)
        case _:
            raise WorldError(f"MJCF cannot represent the shape of {solid.name!r}")


def _take_apart(solids: Sequence[Solid], ground: float) -> dict[str, Pieces]:
    """Return the convex collision pieces of meshes above the ground."""
    pieces = take_apart([lower_solid(solid, ground) for solid in solids], ceiling=math.inf)
    up = (0.0, 0.0, ground)
    return {
        name: replace(found, hulls=[hull._replace(corners=hull.corners + up) for hull in found.hulls])
        for name, found in pieces.items()
    }


def _add_pieces(asset: ElementTree.Element, body: ElementTree.Element, name: str, pieces: Pieces) -> None:
    for index, (corners, _) in enumerate(pieces.hulls):
        piece = f"{name}{PIECE}{index}"
        _add_mesh(asset, piece, corners)
        add(body, "geom", None, name=piece, type="mesh", mesh=piece, group=str(GROUP_PIECES))


def _add_mesh(
    asset: ElementTree.Element, name: str, vertices: FloatArray, faces: npt.NDArray[np.int32] | None = None
) -> None:
    given = {} if faces is None else {"face": " ".join(map(str, faces.ravel().tolist()))}
    add(asset, "mesh", None, name=name, vertex=numbers(at_least_four(vertices).ravel()), inertia="shell", **given)
