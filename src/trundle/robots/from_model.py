"""A robot from its URDF or MJCF model: its settings are derived from geometry, joints and masses.

The model is read with MuJoCo's MjSpec, with all joints at 0. It is not simulated: the simulators build their own model
of the resulting `Robot`, so that it drives alike in all of them.

Derived values, in base_link (on the floor, midway between the drive wheels, x forward, perpendicular to the axle):

- wheel radius, width and mass from the geometry and mass of the wheels' bodies; the track from the wheels' centres;
- the footprint as the convex hull of the collision geometry from above, with few corners (`model_shape`);
- height, clearance, mass, centre of mass and inertia of everything but the drive wheels;
- wheels one behind the other on each side as axles of one drive, with base_link under their middle (`model_wheels`);
- other parts that touch the floor as frictionless balls; if the robot would tip over, a ball is added at its front or
  back, with a warning;
- the maximum speed from the velocity limits of a URDF's wheel joints.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from trundle.errors import RobotError, RobotWarning
from trundle.files.model_spec import compile_spec, drop_textures, read_spec
from trundle.files.opening import check_regular, describe_unreadable
from trundle.files.xacro import expand_xacro
from trundle.files.xml_elements import read_xml
from trundle.files.yaml_config import Plain
from trundle.geometry import FloatArray, convex_hull
from trundle.robots.model_shape import body_points, simplify_outline
from trundle.robots.model_wheels import Frame, read_layout, root_of

_TOUCHES = 0.006
"""Parts this near to the floor [m] support the robot: more takes a low chassis for a caster, less misses casters that
a model leaves a little above the floor."""

_BALL_MASS = 0.01  # [kg]: of balls that stand for parts whose mass the chassis already has

_LARGEST = 1000.0
"""Limit on the size of a robot [m]."""

# Slow and gentle: walking pace.
_ASSUMED_LIMITS: dict[str, Plain] = {
    "linear_speed": 1.0,
    "angular_speed": 2.0,
    "linear_acceleration": 1.0,
    "angular_acceleration": 3.0,
}


def read_robot(path: Path, given: dict[str, Plain], folders: tuple[Path, ...]) -> dict[str, Plain]:
    """Derive the settings of a `Robot` from a model.

    Args:
        path: A URDF or MJCF file.
        given: The settings that will override derived ones, all optional; `drive` should name the joints.
        folders: Folders to search for package:// names, after those above the file.

    Raises:
        RobotError: If the file cannot be read, or does not describe a robot with two drive wheels.
        UnknownNameError: If a joint does not exist.
    """
    try:
        check_regular(path)
    except OSError as error:
        raise RobotError(describe_unreadable(path, error)) from error
    drive = given.get("drive", {})
    if not isinstance(drive, dict):
        raise RobotError(f"{path}: drive must be a mapping, got {drive!r}")
    model, data, name = _compile(path, folders)
    layout = read_layout(path, model, data, drive)
    radius, frame, wheels = layout.radius, layout.frame, layout.wheels
    joints = wheels[0].joint, wheels[1].joint
    bodies = np.flatnonzero(model.body_rootid == root_of(model, joints[0]))
    rolling = frozenset[int]().union(*(wheel.bodies for wheel in wheels))
    chassis = [int(body) for body in bodies if int(body) not in rolling]
    points = {body: [frame.local(part) for part in body_points(model, data, body)] for body in bodies.tolist()}
    parts = [part for found in points.values() for part in found]
    if not parts:
        raise RobotError(f"{path}: none of its links has a shape; give the chassis a <collision>, or a <geom> in MJCF")
    everything = np.vstack(parts)
    if not (np.abs(everything) < _LARGEST).all():  # also catches NaN
        raise RobotError(f"{path}: its geometry must be within {_LARGEST:g} m of its wheels: correct its sizes")

    height = float(everything[:, 2].max())
    casters, clearance = _read_underside([part for body in chassis for part in points[body]], radius)
    mass, center, inertia = _read_inertia(path, model, data, frame, chassis)
    outline = simplify_outline(convex_hull(everything[:, :2]))
    axles = [(float(frame.local(left.center)[0]), left, right) for left, right in layout.axles]
    casters = _keep_upright(path, casters, center, outline, radius, [x for x, _, _ in axles])
    shafts: list[Plain] = [{"x": x, "left_joint": one.joint, "right_joint": other.joint} for x, one, other in axles]
    read: dict[str, Plain] = {
        "name": name,
        "drive": {
            "axles": shafts if len(shafts) > 1 else [],
            "wheel_radius": radius,
            "track_width": layout.track,
            "left_joint": joints[0],
            "right_joint": joints[1],
            "wheel_width": max(0.005, sum(wheel.width for wheel in wheels) / len(wheels)),
            "wheel_mass": sum(wheel.mass for wheel in wheels) / len(wheels),
        },
        "footprint": outline.tolist(),
        "body": {
            "mass": mass - _BALL_MASS * len(casters),
            "height": height,
            "clearance": min(clearance, 0.5 * height),
            "center_of_mass": center.tolist(),
            "inertia": inertia.tolist(),
        },
        "casters": casters,
    }
    if "limits" not in given:
        read["limits"] = _read_limits(path, joints, radius, layout.track)
    return read


def _compile(path: Path, folders: tuple[Path, ...]) -> tuple[Any, Any, str]:
    """Return the compiled model with its collision geometry, or its visual geometry if it has none."""
    spec = read_spec(path, folders=folders, error=RobotError, geometry="collision")
    if not any(geom.contype or geom.conaffinity for geom in spec.geoms):
        spec = read_spec(path, folders=folders, error=RobotError, geometry="visual")
        for geom in spec.geoms:
            geom.contype = 1
    drop_textures(spec)
    model, data = compile_spec(path, spec, error=RobotError)
    name = str(spec.modelname)
    return model, data, path.stem if name in ("", "MuJoCo Model") else name


def _read_underside(parts: list[FloatArray], radius: float) -> tuple[list[Plain], float]:
    """Return parts that touch the floor besides the drive wheels, as balls, and the clearance of the rest [m]."""
    spots: list[FloatArray] = []
    lowest: list[float] = []
    for points in parts:
        low = float(points[:, 2].min())
        if low > _TOUCHES:
            lowest.append(low)
            continue
        spot = points[points[:, 2] < low + 1e-3, :2]
        middle = (spot.min(axis=0) + spot.max(axis=0)) / 2.0
        if all(np.hypot(*(middle - other)) > 0.02 for other in spots):
            spots.append(middle)
    ball = min(0.03, radius / 2.0)
    casters: list[Plain] = [_ball(float(x), float(y), ball) for x, y in spots]
    return casters, min(lowest, default=min(0.03, radius))


def _ball(x: float, y: float, radius: float) -> dict[str, Plain]:
    return {"x": x, "y": y, "radius": radius, "mass": _BALL_MASS}


def _read_inertia(
    path: Path, model: Any, data: Any, frame: Frame, bodies: list[int]
) -> tuple[float, FloatArray, FloatArray]:
    """Read the mass of some bodies, their centre of mass in base_link, and moments of inertia about it."""
    masses = np.array([model.body_mass[body] for body in bodies])
    mass = float(masses.sum())
    if mass < 1e-2:
        raise RobotError(f"{path}: the chassis has no mass; give its links an <inertial>")
    places = frame.local(np.array([data.xipos[body] for body in bodies]))
    center = masses @ places / mass
    moment = np.zeros((3, 3))
    for body, body_mass, place in zip(bodies, masses, places, strict=True):
        turn = frame.rotation.T @ data.ximat[body].reshape(3, 3)
        off = place - center
        moment += turn @ np.diag(model.body_inertia[body]) @ turn.T
        moment += body_mass * (float(off @ off) * np.eye(3) - np.outer(off, off))
    return mass, center, np.maximum(np.diag(moment), 1e-6)


def _keep_upright(
    path: Path, casters: list[Plain], center: FloatArray, outline: FloatArray, radius: float, axles: list[float]
) -> list[Plain]:
    """Add a ball in front or behind if the centre of mass is not supported."""
    ahead = [float(caster["x"]) for caster in casters if isinstance(caster, dict) and isinstance(caster["x"], float)]
    ahead += axles
    added: list[Plain] = []
    words: list[str] = []
    for word, sign in (("front", 1.0), ("back", -1.0)):
        reach = max([0.0, *(sign * x for x in ahead)])
        if reach <= sign * float(center[0]) + 0.005:
            x = 0.85 * float((sign * outline[:, 0]).max())
            added.append(_ball(sign * max(x, sign * float(center[0]) + 0.01), 0.0, min(0.03, radius / 2.0)))
            words.append(word)
    if words:
        warnings.warn(
            f"{path}: nothing supports the {' and the '.join(words)} of the robot; a frictionless ball is added "
            "there. Define casters in a robot's YAML to place them",
            RobotWarning,
            stacklevel=5,
        )
    return [*casters, *added]


def _read_limits(path: Path, joints: tuple[str, str], radius: float, track: float) -> dict[str, Plain]:
    """Return speeds from the velocity limits of a URDF's wheel joints, if both have one; accelerations are assumed."""
    speeds: list[float] = []
    root = read_xml(path, error=RobotError)
    expand_xacro(path, root, error=RobotError)
    for joint in root.iter("joint"):
        limit = joint.find("limit")
        if joint.get("name") in joints and limit is not None:
            try:
                speeds.append(float(limit.get("velocity", "")))
            except ValueError:
                continue
    limits = dict(_ASSUMED_LIMITS)
    if len(speeds) == 2 and 0.0 < min(speeds) < 1e3:
        limits["linear_speed"] = min(speeds) * radius
        limits["angular_speed"] = 2.0 * min(speeds) * radius / track
        what = "its accelerations"
    else:
        what = "its maximum speeds and accelerations"
    warnings.warn(
        f"{path}: the model does not define {what}; assumed: "
        + ", ".join(f"{key} {value:.3g}" for key, value in limits.items() if isinstance(value, float))
        + ". Give limits to override these",
        RobotWarning,
        stacklevel=4,
    )
    return limits
