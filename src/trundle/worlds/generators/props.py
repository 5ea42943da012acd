"""What generated objects are made of: parts in an object's own frame, which are placed as solids, and their colours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Shape, Solid

WOOD: Color = (0.72, 0.55, 0.34, 1.0)
DARK_WOOD: Color = (0.58, 0.42, 0.25, 1.0)
CHARCOAL: Color = (0.16, 0.17, 0.19, 1.0)
RUBBER: Color = (0.09, 0.09, 0.10, 1.0)
STEEL: Color = (0.42, 0.44, 0.47, 1.0)


@dataclass(frozen=True, slots=True)
class Part:
    """One solid of an object, in the object's own frame: origin on the floor, x forward.

    Attributes:
        name: Unique within its object.
        shape: Its shape.
        pose: Pose in the object's frame.
        color: Red, green, blue, alpha, each 0..1.
        kind: Kind of the solid.
    """

    name: str
    shape: Shape
    pose: Pose3D
    color: Color
    kind: str


def place(parts: Sequence[Part], prefix: str, x: float, y: float, yaw: float) -> list[Solid]:
    """Place an object at (x, y) [m] in the map frame, rotated by yaw [rad]; its solids are named `prefix_part`."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    half_cos, half_sin = math.cos(yaw / 2.0), math.sin(yaw / 2.0)
    solids = []
    for part in parts:
        px, py, pz = part.pose.position
        qw, qx, qy, qz = part.pose.quaternion
        pose = Pose3D(
            (x + cos * px - sin * py, y + sin * px + cos * py, pz),
            (
                half_cos * qw - half_sin * qz,
                half_cos * qx - half_sin * qy,
                half_cos * qy + half_sin * qx,
                half_cos * qz + half_sin * qw,
            ),
        )
        solids.append(Solid(f"{prefix}_{part.name}", part.shape, pose, part.color, part.kind))
    return solids


def box(
    name: str, size: Sequence[float], centre: Sequence[float], color: Color, kind: str, *, yaw: float = 0.0
) -> Part:
    """Return an upright box of `size` [m] at `centre` [m]."""
    length, width, height = (float(edge) for edge in size)
    x, y, z = (float(number) for number in centre)
    return Part(name, Box((length, width, height)), Pose3D.planar(x, y, z, yaw), color, kind)


SEEN_TO = 0.5
"""Height [m] up to which objects of a world without low ones keep their outline; a lidar's beams are below it."""
