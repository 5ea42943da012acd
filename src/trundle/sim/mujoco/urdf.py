"""The joints of a URDF file, read from its XML: MuJoCo's importer drops fixed joints and the names around them."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Set
from pathlib import Path

from trundle.errors import RobotError
from trundle.files.xacro import expand_xacro
from trundle.files.xml_elements import XmlElement
from trundle.sim.mujoco.joint import TYPES, Joint

_WITHOUT_AXIS = ("fixed", "floating")
_WITH_LIMITS = ("revolute", "prismatic")


def urdf_joints(path: Path, robot: XmlElement, *, wheels: Set[str] = frozenset()) -> list[Joint]:
    """List the joints below a URDF's `<robot>`, in the order of the file.

    Args:
        path: Path of the file, for messages.
        robot: Its `<robot>`; plain xacro in it is expanded.
        wheels: Joints that a simulator drives, besides those that a transmission or ros2_control commands.

    Raises:
        RobotError: If a joint has no name, type, parent or child, an unknown type, or invalid numbers; or if the
            file uses more than plain xacro.
    """
    expand_xacro(path, robot, error=RobotError)
    driven = _driven_joints(robot) | wheels
    joints = [_joint(path, element, driven) for element in robot.findall("joint")]
    names = [joint.name for joint in joints]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise RobotError(f"{path}: two joints have the name {twice!r}")
    return joints


def _joint(path: Path, element: ElementTree.Element, driven: set[str]) -> Joint:
    name, kind = element.get("name"), element.get("type")
    if not name:
        raise RobotError(f"{path}: a joint has no name")
    where = f"{path}: joint {name!r}"
    if kind not in TYPES or kind == "ball":
        choices = ", ".join(choice for choice in TYPES if choice != "ball")
        raise RobotError(f"{where} has type {kind!r}; URDF has {choices}")
    links = {role: element.find(role) for role in ("parent", "child")}
    parent, child = ("" if link is None else link.get("link", "") for link in links.values())
    if not parent or not child:
        raise RobotError(f'{where} needs <parent link="…"/> and <child link="…"/>')
    return Joint(
        name=name,
        type=kind,
        axis=None if kind in _WITHOUT_AXIS else _axis(where, element.find("axis")),
        limits=_limits(where, element.find("limit")) if kind in _WITH_LIMITS else None,
        parent=parent,
        child=child,
        drives=name in driven,
    )


def _axis(where: str, element: ElementTree.Element | None) -> tuple[float, float, float]:
    """The unit axis; x by default, as in URDF."""
    if element is None:
        return (1.0, 0.0, 0.0)
    words = element.get("xyz", "1 0 0").split()
    numbers = [_number(f"{where}: axis", word) for word in words]
    length = math.hypot(*numbers)
    if len(numbers) != 3 or length < 1e-9:
        raise RobotError(f"{where}: axis must be three numbers, not all 0, got {' '.join(words)!r}")
    return (numbers[0] / length, numbers[1] / length, numbers[2] / length)


def _limits(where: str, element: ElementTree.Element | None) -> tuple[float, float] | None:
    if element is None:
        return None
    lower = _number(f"{where}: limit lower", element.get("lower", "0"))
    upper = _number(f"{where}: limit upper", element.get("upper", "0"))
    if lower > upper:
        raise RobotError(f"{where}: limit lower {lower:g} is above upper {upper:g}")
    return (lower, upper)


def _number(what: str, word: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise RobotError(f"{what} must be a finite number, got {word!r}")
    return number


def _driven_joints(robot: ElementTree.Element) -> set[str]:
    """Joints that a transmission or ros2_control commands."""
    driven: set[str] = set()
    for transmission in robot.iter("transmission"):
        driven |= {joint.get("name", "") for joint in transmission.findall("joint")}
    for control in robot.iter("ros2_control"):
        for joint in control.findall("joint"):
            if joint.find("command_interface") is not None:
                driven.add(joint.get("name", ""))
    return driven
