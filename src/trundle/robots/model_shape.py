"""A compiled model, measured: its drive wheels, its geometry as points, and outlines with few corners."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trundle.errors import RobotError
from trundle.files.yaml_config import Plain
from trundle.geometry import FloatArray, convex_hull

MOST_CORNERS = 24
"""The most corners of a footprint: collision checks take time in proportion to them."""

_AROUND = 64  # points of a circle: a footprint is then short by 0.12 % of a radius


def simplify_outline(hull: FloatArray) -> FloatArray:
    """Drop nearly straight corners of a convex outline, and enclose it in one with fewer corners if it has many.

    Args:
        hull: Corners [m], counter-clockwise, shape (N, 2).

    Returns:
        Corners that enclose the hull to within 0.1 mm, shape (at most `MOST_CORNERS`, 2).
    """
    outline = _without_flat_corners(hull)
    if len(outline) <= MOST_CORNERS:
        return outline
    angles = np.arange(MOST_CORNERS) * (2.0 * math.pi / MOST_CORNERS)
    normals = np.c_[np.cos(angles), np.sin(angles)]
    reach = (hull @ normals.T).max(axis=0)
    following = np.roll(np.arange(MOST_CORNERS), -1)
    pairs = np.stack([normals, normals[following]], axis=1)
    corners = np.linalg.solve(pairs, np.stack([reach, reach[following]], axis=1)[..., None])[..., 0]
    return _without_flat_corners(convex_hull(np.round(corners, 9)))


def _without_flat_corners(outline: FloatArray, tolerance: float = 1e-4) -> FloatArray:
    points = outline
    while len(points) > 3:
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
        along = after - before
        off = np.abs(along[:, 0] * (points - before)[:, 1] - along[:, 1] * (points - before)[:, 0])
        off /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)
        flattest = int(np.argmin(off))
        if off[flattest] > tolerance:
            break
        points = np.delete(points, flattest, axis=0)
    return points


def body_points(model: Any, data: Any, body: int) -> list[FloatArray]:
    """Return points [m] whose hulls are a body's collision geometry, an array of shape (N, 3) per geom, world frame."""
    found: list[FloatArray] = []
    first, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
    for geom in range(first, first + count):
        if not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        points = _geom_points(model, geom)
        if len(points):
            found.append(points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
    return found


def _geom_points(model: Any, geom: int) -> FloatArray:
    import mujoco

    x, y, z = model.geom_size[geom].tolist()
    angles = np.arange(_AROUND) * (2.0 * math.pi / _AROUND)
    ring = np.c_[np.cos(angles), np.sin(angles), np.zeros(_AROUND)]
    tilts = np.linspace(-math.pi / 2.0, math.pi / 2.0, _AROUND // 2 + 1)
    ball = np.vstack([np.c_[ring[:, :2] * math.cos(tilt), np.full(_AROUND, math.sin(tilt))] for tilt in tilts])
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_BOX:
            signs = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)]) * 2.0 - 1.0
            return signs * (x, y, z)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return ball * x
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return ball * (x, y, z)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return np.vstack([ring * x + (0.0, 0.0, end) for end in (-y, y)])
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return np.vstack([ball * x + (0.0, 0.0, end) for end in (-y, y)])
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            return np.asarray(model.mesh_vert[first : first + count], dtype=np.float64)
        case _:
            return np.zeros((0, 3))


@dataclass(frozen=True, slots=True)
class ModelWheel:
    """A drive wheel of a model: its joint, its centre [m] and axis in the model's world frame, and its sizes."""

    joint: str
    center: FloatArray
    axis: FloatArray
    radius: float
    width: float
    mass: float
    bodies: frozenset[int]


def read_wheel(path: Path, model: Any, data: Any, joint: str, given_radius: Plain) -> ModelWheel:
    """Derive a wheel's sizes from its body's geometry and mass.

    Raises:
        RobotError: If its joint is not level, or it has no geometry and no radius is given.
    """
    index = int(model.joint(joint).id)
    body = int(model.jnt_bodyid[index])
    bodies = {body}
    for other in range(body + 1, int(model.nbody)):
        if int(model.body_parentid[other]) in bodies:
            bodies.add(other)
    axis = np.array(data.xaxis[index], dtype=np.float64)
    anchor = np.array(data.xanchor[index], dtype=np.float64)
    parts = [part for member in sorted(bodies) for part in body_points(model, data, member)]
    if abs(axis[2]) > 0.05:
        raise RobotError(f"{path}: joint {joint!r} is not a wheel: its axis {axis.round(3).tolist()} is not horizontal")
    mass = float(sum(model.body_mass[member] for member in bodies))
    if not parts and given_radius is not None:
        return ModelWheel(
            joint, anchor, axis, positive_metres(path, "wheel_radius", given_radius), 0.05, mass, frozenset(bodies)
        )
    if not parts:
        raise RobotError(
            f"{path}: the wheel of joint {joint!r} has no geometry to read its radius from; give wheel_radius, or give "
            "the wheel's link a <collision> with a cylinder or a sphere"
        )
    offset = np.vstack(parts) - anchor
    along = offset @ axis
    middle = (along.min() + along.max()) / 2.0
    radius = float(np.linalg.norm(offset - np.outer(along, axis), axis=1).max())
    return ModelWheel(joint, anchor + middle * axis, axis, radius, float(np.ptp(along)), mass, frozenset(bodies))


def positive_metres(path: Path, key: str, value: Plain) -> float:
    """Return a given length [m].

    Raises:
        RobotError: If it is no positive number.
    """
    if not isinstance(value, int | float) or not (math.isfinite(value) and value > 0.0):
        raise RobotError(f"{path}: {key} must be a positive number of metres, got {value!r}")
    return float(value)
