"""A drive wheel of a model, measured: its place, axis, radius and mass."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trundle.errors import RobotError
from trundle.files.yaml_config import Plain
from trundle.geometry import FloatArray
from trundle.robots.model_shape import body_points


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
