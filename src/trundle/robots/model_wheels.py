"""Finding the drive wheels of a model, their sizes, and base_link between them; telling omni wheels apart."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.errors import RobotError, RobotWarning, UnknownNameError
from trundle.files.xml_elements import XmlElement, read_xml
from trundle.files.yaml_config import Plain
from trundle.geometry import FloatArray
from trundle.robots.model_shape import ModelWheel, positive_metres, read_wheel

_ALIKE = 0.02
"""Largest relative difference between the radii of wheels on one side: that of rounded numbers and coarse meshes."""

_BESIDE = 0.05
"""Largest offset [m] between wheels of one side, laterally and in height."""

_OPPOSITE = 0.02
"""Largest offset [m] of a wheel ahead of the opposite one."""


@dataclass(frozen=True, slots=True)
class Frame:
    """base_link in the model's world frame."""

    origin: FloatArray
    rotation: FloatArray

    def local(self, points: FloatArray) -> FloatArray:
        """Return points [m] in base_link."""
        return (points - self.origin) @ self.rotation


@dataclass(frozen=True, slots=True)
class Layout:
    """The drive wheels, and base_link under the middle of them.

    Attributes:
        axles: Left and right wheel of each axle, the foremost first.
        radius: Radius of the wheels [m].
        track: Distance between the wheels of an axle [m].
        frame: base_link.
    """

    axles: tuple[tuple[ModelWheel, ModelWheel], ...]
    radius: float
    track: float
    frame: Frame

    @property
    def wheels(self) -> tuple[ModelWheel, ...]:
        """All wheels."""
        return tuple(wheel for axle in self.axles for wheel in axle)


def read_layout(path: Path, model: Any, data: Any, drive: dict[str, Plain]) -> Layout:
    """Find the drive wheels of a model. Wheels in a row on one side all belong to the drive.

    Args:
        path: Path of the file, for messages.
        model: The compiled model.
        data: Its state, all joints at 0.
        drive: The given settings of the drive.

    Raises:
        RobotError: If the wheels cannot be identified, do not form pairs, or do not roll straight ahead.
        UnknownNameError: If a joint is not there.
    """
    names = _name_joints(path, model, drive)
    given = drive.get("wheel_radius")
    sides = [[read_wheel(path, model, data, joint, given) for joint in side] for side in names]
    chosen = {joint for side in names for joint in side}
    if len(sides[0]) == len(sides[1]) == 1:
        found = [_behind(path, model, data, side[0], chosen, given) for side in sides]
        if len(found[0]) == len(found[1]):
            sides = [[*side, *more] for side, more in zip(sides, found, strict=True)]
    refuse_omni_wheels(path, model, data, [*sides[0], *sides[1]])
    axles = _pair(path, sides[0], sides[1])
    if len(axles) > 1 and "axles" not in drive:
        warnings.warn(
            f"{path}: the robot has {len(axles)} wheels a side, and is taken as skid-steer: plain wheels, those of a "
            "side at one speed. trundle does not drive robots with mecanum or omni wheels",
            RobotWarning,
            stacklevel=4,
        )
    return _lay_out(path, model, data, axles, drive)


def hinge_names(model: Any) -> list[str]:
    """Return the names of the revolute joints."""
    import mujoco

    return [
        str(model.joint(index).name)
        for index in range(model.njnt)
        if model.jnt_type[index] == mujoco.mjtJoint.mjJNT_HINGE and model.joint(index).name
    ]


def root_of(model: Any, joint: str) -> int:
    """Return the root body of the robot that a joint belongs to."""
    return int(model.body_rootid[int(model.jnt_bodyid[model.joint(joint).id])])


def wheels_named(joints: Sequence[str], side: str) -> list[str]:
    """Return the joints whose names clearly say that they are wheels of a side, "left" or "right"."""
    return [
        joint
        for joint in joints
        if side in joint.lower() and "wheel" in joint.lower() and "caster" not in joint.lower()
    ]


def _name_joints(path: Path, model: Any, drive: dict[str, Plain]) -> tuple[list[str], list[str]]:
    """Return joints of the left and right wheels: as given, or found by their names."""
    hinges = hinge_names(model)
    found: list[list[str]] = []
    for side in ("left", "right"):
        name = drive.get(f"{side}_joint")
        if name is None:
            matches = wheels_named(hinges, side)
            if not matches:
                raise RobotError(_which_joints(path, hinges))
            found.append(matches)
            continue
        if not isinstance(name, str) or name not in hinges:
            raise UnknownNameError(f"revolute joint of {path}:", str(name), hinges)
        found.append([name])
    left, right = found
    if left == right:
        raise RobotError(f"{path}: left_joint and right_joint are both {left[0]!r}; name two joints")
    if len(left) != len(right):
        raise RobotError(_which_joints(path, hinges))
    return left, right


def _which_joints(path: Path, hinges: list[str]) -> str:
    return (
        f"{path}: which joints drive the robot? Its revolute joints are: {', '.join(hinges) or 'none'}. Name two of "
        "them: left_joint and right_joint of Robot.from_model, or a robot's YAML with "
        f"model: {path.name} and drive: {{left_joint: …, right_joint: …}}"
    )


def _behind(
    path: Path, model: Any, data: Any, wheel: ModelWheel, chosen: set[str], given_radius: Plain
) -> list[ModelWheel]:
    """Return wheels similar to one, in front of it and behind it on the same side."""
    found: list[ModelWheel] = []
    for joint in hinge_names(model):
        index = int(model.joint(joint).id)
        axis = np.array(data.xaxis[index], dtype=np.float64)
        inside = int(model.jnt_bodyid[index]) in wheel.bodies
        if joint in chosen or inside or "wheel" not in joint.lower() or abs(float(axis @ wheel.axis)) < 0.99:
            continue
        try:
            other = read_wheel(path, model, data, joint, given_radius)
        except RobotError:
            continue
        off = other.center - wheel.center
        beside = abs(float(off @ wheel.axis)) <= _BESIDE and abs(float(off[2])) <= _BESIDE
        if beside and abs(other.radius - wheel.radius) <= _ALIKE * wheel.radius:
            found.append(other)
    return found


def _pair(
    path: Path, left: Sequence[ModelWheel], right: Sequence[ModelWheel]
) -> tuple[tuple[ModelWheel, ModelWheel], ...]:
    """Return each left wheel with the one opposite, the foremost first."""
    across = np.mean([wheel.center for wheel in left], axis=0) - np.mean([wheel.center for wheel in right], axis=0)
    axis = left[0].axis * (1.0 if float(left[0].axis @ across) >= 0.0 else -1.0)
    forward = np.array([axis[1], -axis[0], 0.0])
    sides = [sorted(side, key=lambda wheel: -float(wheel.center @ forward)) for side in (left, right)]
    axles = tuple(zip(*sides, strict=True))
    for first, second in axles:
        _check_axle(path, first, second)
        if len(axles) > 1 and abs(float((first.center - second.center) @ forward)) > _OPPOSITE:
            raise RobotError(
                f"{path}: the wheels of {first.joint!r} and {second.joint!r} are not opposite each other; each left "
                "wheel needs a right one on its axle"
            )
    return axles


def _check_axle(path: Path, left: ModelWheel, right: ModelWheel) -> None:
    across = left.center - right.center
    distance = float(np.linalg.norm(across))
    if distance < 1e-3:
        raise RobotError(
            f"{path}: the wheels of {left.joint!r} and {right.joint!r} are in one place; correct their origins"
        )
    if min(abs(left.axis @ across), abs(right.axis @ across)) < 0.99 * distance:
        raise RobotError(
            f"{path}: {left.joint!r} and {right.joint!r} do not rotate about one axis; a differential drive needs the "
            "left and the right wheel on one axle"
        )


def _lay_out(
    path: Path, model: Any, data: Any, axles: tuple[tuple[ModelWheel, ModelWheel], ...], drive: dict[str, Plain]
) -> Layout:
    wheels = [wheel for axle in axles for wheel in axle]
    radii = [wheel.radius for wheel in wheels]
    given_radius, given_track = drive.get("wheel_radius"), drive.get("track_width")
    if given_radius is None and max(radii) - min(radii) > 0.01 * max(radii):
        raise RobotError(
            f"{path}: the wheels have radii of {', '.join(f'{radius:g}' for radius in radii[:-1])} and {radii[-1]:g} "
            "m; they must be equal: give wheel_radius"
        )
    middle_radius = sum(radii) / len(radii)
    radius = middle_radius if given_radius is None else positive_metres(path, "wheel_radius", given_radius)
    left, right = (np.mean([axle[side].center for axle in axles], axis=0) for side in (0, 1))
    across = left - right
    tracks = [float(np.linalg.norm(one.center - other.center)) for one, other in axles]
    track = sum(tracks) / len(tracks) if given_track is None else positive_metres(path, "track_width", given_track)
    y_axis = np.array([across[0], across[1], 0.0]) / math.hypot(across[0], across[1])
    rotation = np.column_stack([[y_axis[1], -y_axis[0], 0.0], y_axis, [0.0, 0.0, 1.0]])
    first, second = axles[0]
    ahead = data.xmat[root_of(model, first.joint)].reshape(3, 3)[:, 0]
    if float(ahead @ rotation[:, 0]) < -0.5:
        raise RobotError(
            f"{path}: {first.joint!r} is on the right side of the model and {second.joint!r} on the left: the robot "
            "would drive backwards; swap the two"
        )
    # The floor is at the bottom of the wheels' geometry, even if a different radius is given for their speeds.
    floor = np.array([0.0, 0.0, middle_radius])
    return Layout(axles, radius, track, Frame((left + right) / 2.0 - floor, rotation))


_HOLONOMIC = re.compile(r"mecanum|swedish|omni(?!verse)", re.IGNORECASE)
_SIDEWAYS = re.compile(r"planar_?move|force_based_move", re.IGNORECASE)
"""Gazebo's plugins that push a robot's body in every direction. Robots with two plain wheels are given one, too."""

_ROLLERS = 4
"""A wheel with at least this many rotating parts is treated as having rollers."""


def refuse_omni_wheels(path: Path, model: Any, data: Any, wheels: Sequence[ModelWheel]) -> None:
    """Refuse a robot whose model says that its wheels roll sideways as well.

    In a URDF such wheels are often plain cylinders: only names, meshes, the simulator's plugin or its friction tell.

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
