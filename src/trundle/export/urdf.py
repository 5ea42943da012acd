"""Robots as URDF, for ROS, Isaac Sim's importer and PyBullet."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

from trundle.export.plain import add, mesh_folder, numbers, to_text
from trundle.files.writing import write_text
from trundle.geometry import FloatArray
from trundle.robots import Caster, Robot
from trundle.sim.mujoco.model import robot_spec
from trundle.sim.mujoco.robot_parts import named_wheels

_TYRE = (0.05, 0.05, 0.055, 1.0)
_STEEL = (0.62, 0.64, 0.66, 1.0)


def export_robot(robot: Robot, path: Path) -> None:
    """Write a robot: links with masses and inertias, joints by their names, and what collides.

    base_link has the chassis' mass. The wheels' joints are `continuous`; a caster without joints is a ball on a fixed
    joint, which slides (URDF has no friction: give it 0 where it is loaded); a lidar is a link without mass. A chassis
    that is no box is an OBJ file in a folder beside the URDF, `<stem>_meshes`.

    Raises:
        OutputError: If a file cannot be written.
    """
    write_text(path, _describe(robot, path))


def describe_robot(robot: Robot) -> str:
    """Return a robot as the text of a URDF, as `export_robot` writes it, but without files beside it.

    A chassis that is no box is the box around it.
    """
    return _describe(robot, None)


def _describe(robot: Robot, path: Path | None) -> str:
    # Masses and inertias are those of the simulated model.
    model = robot_spec(robot, looks=False).compile()
    root = ElementTree.Element("robot", name=re.sub(r"\s+", "_", robot.name))
    base = _add_link(root, model, "base_link")
    _add_chassis(base, robot, path)
    drive = robot.drive
    for wheel, name in named_wheels(robot):
        link = _add_link(root, model, name)
        _add_roller(link, drive.wheel_radius, drive.wheel_width)
        at = (wheel.x, wheel.side * drive.track_width / 2.0, drive.wheel_radius)
        _add_joint(root, wheel.joint, "continuous", "base_link", name, at, axis=(0.0, 1.0, 0.0))
    carrier = _add_caster_frame(root, model, robot)
    for index, caster in enumerate(robot.casters):
        _add_caster(root, model, caster, f"caster_{index}", carrier)
    for name, lidar in robot.lidars.items():
        frame = name if "lidar" in name else f"lidar_{name}"
        add(root, "link", None, name=frame)
        at = (lidar.x, lidar.y, lidar.z)
        _add_joint(root, f"{frame}_joint", "fixed", "base_link", frame, at, yaw=lidar.yaw)
    return to_text(root)


def _add_link(root: ElementTree.Element, model: mujoco.MjModel, name: str) -> ElementTree.Element:
    body = model.body(name)
    link = add(root, "link", None, name=name)
    inertial = add(link, "inertial")
    add(inertial, "origin", None, xyz=numbers(body.ipos), rpy="0 0 0")
    add(inertial, "mass", None, value=numbers([float(body.mass[0])]))
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, body.iquat)
    turn = rotation.reshape(3, 3)
    tensor = turn @ np.diag(body.inertia) @ turn.T
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    add(inertial, "inertia", None, **{key: numbers([tensor[cell]]) for key, cell in entries.items()})
    return link


def _add_chassis(link: ElementTree.Element, robot: Robot, path: Path | None) -> None:
    outline, low, high = robot.outline, robot.body.clearance, robot.body.height
    corner, opposite = outline.min(axis=0), outline.max(axis=0)
    is_box = len(outline) == 4 and bool(((outline == corner) | (outline == opposite)).all())
    file = None if is_box or path is None else _write_prism(path, outline, low, high)
    for tag in ("visual", "collision"):
        shape = add(link, tag, None, name=f"chassis_{tag}")
        middle = (*((corner + opposite) / 2.0).tolist(), (low + high) / 2.0) if file is None else (0.0, 0.0, 0.0)
        add(shape, "origin", None, xyz=numbers(middle), rpy="0 0 0")
        geometry = add(shape, "geometry")
        if file is None:
            add(geometry, "box", None, size=numbers((*(opposite - corner), high - low)))
        else:
            add(geometry, "mesh", None, filename=file)
        if tag == "visual":
            _add_color(shape, "chassis", (*robot.body.color, 1.0))


def _write_prism(path: Path, outline: FloatArray, low: float, high: float) -> str:
    """Write the chassis, its outline extruded upwards, as an OBJ; returns its name relative to the URDF."""
    folder = mesh_folder(path)
    count = len(outline)
    corners = [(x, y, z) for z in (low, high) for x, y in outline.tolist()]
    faces: list[tuple[int, ...]] = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    faces += [tuple(range(count))[::-1], tuple(range(count, 2 * count))]
    lines = [f"v {numbers(corner)}" for corner in corners]
    lines += ["f " + " ".join(str(index + 1) for index in face) for face in faces]
    write_text(folder / "chassis.obj", "\n".join(lines) + "\n")
    return f"{folder.name}/chassis.obj"


class _Carrier(NamedTuple):
    """The link that casters are on, and where its origin lies in base_link [m]."""

    link: str
    x: float
    z: float


def _add_caster_frame(root: ElementTree.Element, model: mujoco.MjModel, robot: Robot) -> _Carrier:
    """Add what carries the casters, with a revolute joint; URDF has no springs. Else base_link carries them."""
    frame = robot.caster_frame
    if frame is None:
        return _Carrier("base_link", 0.0, 0.0)
    _add_link(root, model, "caster_frame")
    at = (frame.x, 0.0, frame.z)
    joint = _add_joint(root, frame.joint, "revolute", "base_link", "caster_frame", at, axis=(1.0, 0.0, 0.0))
    low, high = numbers([-frame.limit]), numbers([frame.limit])
    add(joint, "limit", None, lower=low, upper=high, effort="1e6", velocity="10")
    add(joint, "dynamics", None, damping=numbers([frame.damping]), friction=numbers([frame.friction]))
    return _Carrier("caster_frame", frame.x, frame.z)


def _add_caster(root: ElementTree.Element, model: mujoco.MjModel, caster: Caster, name: str, carrier: _Carrier) -> None:
    at = (caster.x - carrier.x, caster.y, caster.radius - carrier.z)
    if caster.swivel_joint is None or caster.wheel_joint is None:
        link = _add_link(root, model, name)
        for tag in ("visual", "collision"):
            shape = add(link, tag)
            add(add(shape, "geometry"), "sphere", None, radius=numbers([caster.radius]))
            if tag == "visual":
                _add_color(shape, name, _STEEL)
        _add_joint(root, f"{name}_joint", "fixed", carrier.link, name, at)
        return
    fork = f"{name}_fork"
    _add_link(root, model, fork)
    _add_joint(root, caster.swivel_joint, "continuous", carrier.link, fork, at, axis=(0.0, 0.0, 1.0))
    _add_roller(_add_link(root, model, name), caster.radius, caster.width)
    behind = (-caster.trail, 0.0, 0.0)
    _add_joint(root, caster.wheel_joint, "continuous", fork, name, behind, axis=(0.0, 1.0, 0.0))


def _add_roller(link: ElementTree.Element, radius: float, width: float) -> None:
    """Add a cylinder along y, to be seen and to collide."""
    for tag in ("visual", "collision"):
        shape = add(link, tag)
        add(shape, "origin", None, xyz="0 0 0", rpy=numbers((math.pi / 2.0, 0.0, 0.0)))
        add(add(shape, "geometry"), "cylinder", None, radius=numbers([radius]), length=numbers([width]))
        if tag == "visual":
            _add_color(shape, "tyre", _TYRE)


def _add_color(visual: ElementTree.Element, name: str, color: tuple[float, ...]) -> None:
    add(add(visual, "material", None, name=name), "color", None, rgba=numbers(color))


def _add_joint(
    root: ElementTree.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    at: tuple[float, float, float],
    *,
    axis: tuple[float, float, float] | None = None,
    yaw: float = 0.0,
) -> ElementTree.Element:
    joint = add(root, "joint", None, name=name, type=kind)
    add(joint, "parent", None, link=parent)
    add(joint, "child", None, link=child)
    add(joint, "origin", None, xyz=numbers(at), rpy=numbers((0.0, 0.0, yaw)))
    if axis is not None:
        add(joint, "axis", None, xyz=numbers(axis))
    return joint
