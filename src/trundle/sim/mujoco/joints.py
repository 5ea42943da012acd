"""The joints of a robot, or of an MJCF, URDF or USD file."""

from __future__ import annotations

import math
import os
import warnings
import xml.etree.ElementTree as ElementTree
from collections.abc import Set
from pathlib import Path

import mujoco
from pydantic import ValidationError

from trundle.errors import InputError, RobotError, RobotWarning
from trundle.files.model_spec import compile_spec, read_mjcf
from trundle.files.xacro import expand_xacro
from trundle.files.xml_elements import XmlElement, read_xml
from trundle.guard import ReadCall, read_guarded, read_limits
from trundle.robots import DifferentialDrive, Robot
from trundle.robots.from_model import read_robot
from trundle.robots.model_wheels import wheels_named
from trundle.sim.mujoco.joint import Joint
from trundle.sim.mujoco.model import robot_spec
from trundle.sim.mujoco.robot_parts import traction_joints
from trundle.worlds.usd import need_usd

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "ball")
"""URDF's joint types, and MuJoCo's ball joint, which URDF does not have."""

_SUFFIXES = (".xml", ".mjcf", ".urdf", ".xacro")
_USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")


def list_joints(
    source: Robot | str | os.PathLike[str],
    *,
    trusted: bool | None = None,
    time_limit_s: float | None = None,
    memory_limit_gb: float | None = None,
) -> list[Joint]:
    """List joints, in the order of the description.

    Args:
        source: A robot, the path of an MJCF (.xml, .mjcf), URDF or USD file, or anything `Robot.load` takes. The meshes
            and textures of a file may be missing.
        trusted: As in `World.load`.
        time_limit_s: As in `World.load`.
        memory_limit_gb: As in `World.load`.

    Returns:
        The joints. For a `Robot`, the free joint of base_link is not listed.

    Raises:
        RobotError: If the file is missing, too large, not XML, neither MJCF nor URDF, or MuJoCo cannot build it.
        UnknownNameError: If it is neither a path nor the name of a robot.
        MissingExtraError: If it is a USD file, and usd-core is not installed.
    """
    given = {"trusted": trusted, "time_limit_s": time_limit_s, "memory_limit_gb": memory_limit_gb}
    limits = read_limits(**given)
    if isinstance(source, Robot) or Path(source).suffix.lower() not in (*_SUFFIXES, *_USD_SUFFIXES):
        robot = Robot.load(source, **given)
        hidden = set(traction_joints(robot)) - {wheel.joint for wheel in robot.drive.wheels}
        joints = _model_joints(robot_spec(robot).compile())
        return [joint for joint in joints if joint.type != "floating" and joint.name not in hidden]
    imports = ("trundle.sim.mujoco.usd",) if Path(source).suffix.lower() in _USD_SUFFIXES else ("mujoco",)
    call = ReadCall(
        "trundle.sim.mujoco.joints:read_joints",
        (Path(source),),
        what=os.fspath(source),
        error=RobotError,
        limits=limits,
        imports=imports,
    )
    return read_guarded(call, stacklevel=2)


def read_joints(path: Path) -> list[Joint]:
    """List the joints of a file, in this process; see `list_joints`."""
    if path.suffix.lower() in _USD_SUFFIXES:
        need_usd("reading USD")
        from trundle.sim.mujoco.usd import usd_joints

        return usd_joints(path)
    root = read_xml(path, error=RobotError)
    if root.tag == "robot":
        return urdf_joints(path, root, wheels=_wheel_joints(path, root))
    if root.tag in ("mujoco", "mujocoinclude"):
        spec = read_mjcf(path, root, error=RobotError)
        _drop_assets(spec)
        return _model_joints(compile_spec(path, spec, error=RobotError)[0])
    raise RobotError(f"{path}: the root element is <{root.tag}>; MJCF has <mujoco> and URDF has <robot>")


def _wheel_joints(path: Path, root: XmlElement) -> frozenset[str]:
    """Return joints of the wheels that `trundle drive` drives in a URDF; empty for an arm.

    If the robot cannot be driven, for example without its meshes, they are found by name.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        try:
            drive = DifferentialDrive.model_validate(read_robot(path, {}, ())["drive"])
        except (InputError, ValidationError):
            names = [joint.get("name", "") for joint in root.iter("joint") if joint.get("type") == "continuous"]
            return frozenset(name for side in ("left", "right") for name in wheels_named(names, side))
    return frozenset(wheel.joint for wheel in drive.wheels)


def _drop_assets(spec: mujoco.MjSpec) -> None:
    """Replace every mesh by a small ball, because joints do not depend on meshes."""
    for geom in spec.geoms:
        if geom.meshname or geom.hfieldname:
            geom.meshname = geom.hfieldname = ""
            geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
            geom.size = (0.01, 0.0, 0.0)
            geom.fromto = (float("nan"),) * 6
        geom.material = ""
    for body in spec.bodies:
        body.mass, body.explicitinertial = 1.0, True
        body.inertia, body.ipos = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
        body.fullinertia = (float("nan"),) * 6
    for assets in (spec.skins, spec.materials, spec.meshes, spec.hfields, spec.textures):
        for asset in list(assets):
            spec.delete(asset)


def _model_joints(model: mujoco.MjModel) -> list[Joint]:
    driven = _driven(model)
    return [_model_joint(model, index, index in driven) for index in range(model.njnt)]


def _model_joint(model: mujoco.MjModel, index: int, drives: bool) -> Joint:
    body = int(model.jnt_bodyid[index])
    limits = (float(model.jnt_range[index][0]), float(model.jnt_range[index][1])) if model.jnt_limited[index] else None
    x, y, z = (float(number) for number in model.jnt_axis[index])
    match mujoco.mjtJoint(int(model.jnt_type[index])):
        case mujoco.mjtJoint.mjJNT_HINGE:
            kind = "continuous" if limits is None else "revolute"
        case mujoco.mjtJoint.mjJNT_SLIDE:
            kind = "prismatic"
        case mujoco.mjtJoint.mjJNT_BALL:
            kind = "ball"
        case _:
            kind = "floating"
    return Joint(
        name=model.joint(index).name,
        type=kind,
        axis=(x, y, z) if kind in ("continuous", "revolute", "prismatic") else None,
        limits=limits,
        parent=model.body(int(model.body_parentid[body])).name,
        child=model.body(body).name,
        drives=drives,
    )


def _driven(model: mujoco.MjModel) -> set[int]:
    """Return joints that an actuator moves, directly or through a tendon that couples joints."""
    driven: set[int] = set()
    for kind, target in zip(model.actuator_trntype, model.actuator_trnid[:, 0], strict=True):
        if kind in (mujoco.mjtTrn.mjTRN_JOINT.value, mujoco.mjtTrn.mjTRN_JOINTINPARENT.value):
            driven.add(int(target))
        elif kind == mujoco.mjtTrn.mjTRN_TENDON.value:
            first = int(model.tendon_adr[target])
            for wrap in range(first, first + int(model.tendon_num[target])):
                if model.wrap_type[wrap] == mujoco.mjtWrap.mjWRAP_JOINT.value:
                    driven.add(int(model.wrap_objid[wrap]))
    return driven


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
        raise RobotError(f"{path}: two joints have the name {twice!r}; rename one of them")
    return joints


def _joint(path: Path, element: ElementTree.Element, driven: set[str]) -> Joint:
    name, kind = element.get("name"), element.get("type")
    if not name:
        raise RobotError(f"{path}: a joint has no name; give each <joint> a name")
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
    """Return the unit axis; x by default, as in URDF."""
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
    """Return joints that a transmission or ros2_control commands."""
    driven: set[str] = set()
    for transmission in robot.iter("transmission"):
        driven |= {joint.get("name", "") for joint in transmission.findall("joint")}
    for control in robot.iter("ros2_control"):
        for joint in control.findall("joint"):
            if joint.find("command_interface") is not None:
                driven.add(joint.get("name", ""))
    return driven
