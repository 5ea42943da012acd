"""The part of a tilted cylinder in a height band, seen from above."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose3D
from trundle.solids import Cylinder

TOLERANCE = 2e-7
"""The outline is inside the true one by at most this [m]."""


def slice_cylinder(shape: Cylinder, pose: Pose3D, low: float, high: float) -> FloatArray:
    """Points [m], shape (N, 2), whose convex hull is the cylinder between two heights, seen from above.

    The outline is the hull of the parts of the two rims between the heights and of the sections at the heights. Both
    are arcs of the angle φ around the axis, with φ = 0 at the top of the rim, sampled so finely that the chords
    stay within `TOLERANCE` of them.

    Args:
        shape: The cylinder.
        pose: Its pose; it must not be upright.
        low: The lower height [m].
        high: The upper height [m].
    """
    middle = np.asarray(pose.position)
    axis = pose.rotation()[:, 2]
    slope = math.hypot(axis[0], axis[1])
    upward = (np.array([0.0, 0.0, 1.0]) - axis[2] * axis) / slope
    sideways = np.cross(axis, upward)
    swing = shape.radius * slope  # Height of a rim's top above its middle.
    half = shape.length / 2.0

    def on_side(angles: FloatArray, along: FloatArray | float) -> FloatArray:
        around = np.cos(angles)[:, None] * upward + np.sin(angles)[:, None] * sideways
        points = middle + shape.radius * around + np.multiply.outer(np.broadcast_to(along, angles.shape), axis)
        return points[:, :2]

    parts: list[FloatArray] = []
    for end in (-half, half):
        base = middle[2] + end * axis[2]
        angles = _sample((low - base) / swing, (high - base) / swing, shape.radius)
        parts.append(on_side(angles, end))
    rise = abs(axis[2]) * half  # Height of an end's middle above the cylinder's.
    for height in (low, high):
        lift = height - middle[2]
        if rise <= TOLERANCE / 2.0:
            angles = _sample(lift / swing, lift / swing, shape.radius)
            parts += [on_side(angles, -half), on_side(angles, half)]
            continue
        angles = _sample((lift - rise) / swing, (lift + rise) / swing, shape.radius / abs(axis[2]))
        along = (lift - swing * np.cos(angles)) / axis[2]
        parts.append(on_side(angles, np.clip(along, -half, half)))
    return np.concatenate(parts)


def _sample(low: float, high: float, semi_axis: float) -> FloatArray:
    """Angles ±φ whose cosine is between two numbers, as fine as an ellipse of this semi-axis [m] needs; may be none."""
    if low > 1.0 or high < -1.0:
        return np.empty(0)
    first, last = math.acos(min(1.0, high)), math.acos(max(-1.0, low))
    step = math.sqrt(8.0 * TOLERANCE / semi_axis)
    angles = np.linspace(first, last, 2 + math.ceil((last - first) / step))
    return np.concatenate([angles, -angles])
