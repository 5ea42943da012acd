"""Telling robots with mecanum or omni wheels from those whose wheels only roll ahead, by what their model says.

In a URDF such wheels are often plain cylinders: only names, meshes, the simulator's plugin or its friction tell.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.errors import RobotError
from trundle.files.xml_elements import XmlElement, read_xml
from trundle.robots.model_parts import ModelWheel, read_wheel

_HOLONOMIC = re.compile(r"mecanum|swedish|omni(?!verse)", re.IGNORECASE)
_SIDEWAYS = re.compile(r"planar_?move|force_based_move", re.IGNORECASE)
"""Gazebo's plugins that push a robot's body in every direction. Robots with two plain wheels are given one, too."""

_ROLLERS = 4
"""A wheel with at least this many rotating parts of its own is treated as having rollers."""


def refuse_omni_wheels(path: Path, model: Any, data: Any, wheels: Sequence[ModelWheel]) -> None:
    """Refuse a robot whose model says that its wheels roll sideways as well.

    Args:
        path: The model's file.
        model: The compiled model.
        data: Its state, all joints at 0.
        wheels: Its drive wheels.

    Raises:
        RobotError: If it does; the message says by what.
    """
    root = read_xml(path, error=RobotError)
    for wheel in wheels:
        links = [str(model.body(body).name) for body in wheel.bodies]
        told = _by_name([wheel.joint, *links]) or _by_rollers(model, wheel)
        told = told or _by_mesh(root, links) or _by_friction(root, links)
        if told is not None:
            kind, why = told
            raise _refusal(path, f"the wheel of joint {wheel.joint!r} is {kind} wheel, {why}")
    plugin = _find_plugin(root, _SIDEWAYS if len(wheels) > 2 else None)
    if plugin is not None:
        raise _refusal(path, f"the robot has mecanum or omni wheels, by its plugin {plugin}")
    across = _find_across(path, model, data, wheels)
    if across is not None:
        raise _refusal(path, f"the wheel of joint {across!r} is an omni wheel, by its axis across that of the others")


def _refusal(path: Path, what: str) -> RobotError:
    return RobotError(
        f"{path}: {what}: it rolls sideways as well. trundle drives robots with a left and a right side of plain "
        "wheels, on one axle or several"
    )


def _by_name(names: Sequence[str]) -> tuple[str, str] | None:
    first = next((match for name in names if (match := _HOLONOMIC.search(name))), None)
    return None if first is None else (_kind(first), "by its name")


def _kind(match: re.Match[str]) -> str:
    return "an omni" if match.group().lower() == "omni" else "a mecanum"


def _by_rollers(model: Any, wheel: ModelWheel) -> tuple[str, str] | None:
    rollers = sum(int(model.jnt_bodyid[index]) in wheel.bodies for index in range(model.njnt)) - 1
    return ("a mecanum or omni", f"with {rollers} rollers") if rollers >= _ROLLERS else None


def _by_mesh(root: XmlElement, links: Sequence[str]) -> tuple[str, str] | None:
    for link in _elements(root, "link"):
        for mesh in _elements(link, "mesh") if link.get("name") in links else ():
            file = Path(mesh.get("filename", "")).name
            match = _HOLONOMIC.search(file)
            if match is not None:
                return _kind(match), f"by its mesh {file}"
    return None


def _by_friction(root: XmlElement, links: Sequence[str]) -> tuple[str, str] | None:
    """Return what Gazebo's friction tells: none at all, or less along a diagonal, as rollers at 45 degrees have it."""
    for gazebo in _elements(root, "gazebo"):
        if gazebo.get("reference") not in links:
            continue
        friction = [_number(gazebo, name) for name in ("mu1", "mu2")]
        if friction == [[0.0], [0.0]]:
            return "a mecanum or omni", "as it has no friction (mu1 and mu2 are 0)"
        along = _number(gazebo, "fdir1")
        if len(along) == 3 and min(abs(along[0]), abs(along[1])) > 0.5 * max(abs(along[0]), abs(along[1])):
            return "a mecanum", "by the diagonal of its friction (fdir1)"
    return None


def _find_plugin(root: XmlElement, more: re.Pattern[str] | None) -> str | None:
    """Return the plugin of a simulator or a controller that drives such wheels."""
    for plugin in _elements(root, "plugin"):
        for name in (plugin.get("filename", ""), plugin.get("name", "")):
            if _HOLONOMIC.search(name) or (more is not None and more.search(name)):
                return name
    return None


def _find_across(path: Path, model: Any, data: Any, wheels: Sequence[ModelWheel]) -> str | None:
    """Return the joint of a wheel that is fixed to the chassis and rolls across the drive wheels' direction."""
    import mujoco

    chosen = {wheel.joint for wheel in wheels}
    parents = {int(model.body_parentid[int(model.jnt_bodyid[model.joint(wheel.joint).id])]) for wheel in wheels}
    for index in range(model.njnt):
        name, body = str(model.joint(index).name), int(model.jnt_bodyid[index])
        is_hinge = model.jnt_type[index] == mujoco.mjtJoint.mjJNT_HINGE
        if name in chosen or not is_hinge or "wheel" not in name.lower() or "caster" in name.lower():
            continue
        if int(model.body_parentid[body]) not in parents:
            continue  # it turns on a swivel or a fork
        try:
            axis = read_wheel(path, model, data, name, None).axis
        except RobotError:
            continue
        if abs(float(np.dot(axis, wheels[0].axis))) < 0.9:
            return name
    return None


def _elements(root: XmlElement, tag: str) -> Iterator[XmlElement]:
    return cast("Iterator[XmlElement]", root.iter(tag))


def _number(element: XmlElement, tag: str) -> list[float]:
    """Return the numbers of a child, in its text or its attribute `value`; none if it is missing or has others."""
    child = element.find(tag)
    try:
        return [] if child is None else [float(word) for word in (child.text or child.get("value", "")).split()]
    except ValueError:
        return []
