"""A robot as the page draws it: the same parts as in pictures and videos."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trundle.geometry import FloatArray
from trundle.page.encoding import pack_array, rounded
from trundle.robots import Robot

_ACROSS_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
_TYRE = [13, 13, 14, 255]
_STEEL = [158, 163, 168, 255]


def robot_of(robot: Robot) -> dict[str, Any]:
    """Return a robot: footprint, limits, wheels, lidars, and its visible parts in base_link.

    Without MuJoCo, as in Isaac Sim's own Python, the parts are a plain body and wheels.
    """
    try:
        from trundle.page.robot_parts import engine_parts
    except ImportError:
        parts = plain_parts(robot)
    else:
        parts = engine_parts(robot)
    limits = robot.limits
    return {
        "name": robot.name,
        "footprint": np.round(robot.outline, 4).tolist(),
        "height": robot.body.height,
        "limits": {
            "v": limits.linear_speed,
            "v_min": -(limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed),
            "w": limits.angular_speed,
            "a": limits.linear_acceleration,
            "alpha": limits.angular_acceleration,
        },
        "wheel_radius": robot.drive.wheel_radius,
        "track": robot.drive.track_width,
        "parts": parts,
        "lidars": [
            {"name": name, "pose": rounded((lidar.x, lidar.y, lidar.z, lidar.yaw))}
            for name, lidar in robot.lidars.items()
        ],
    }


def plain_parts(robot: Robot) -> list[dict[str, Any]]:
    """Return the body as a prism of the footprint, and the wheels with a bar that shows how they turn."""
    drive = robot.drive
    radius, width = drive.wheel_radius, drive.wheel_width
    color = [round(255.0 * value) for value in robot.body.color]
    parts = [_prism(robot.outline, robot.body.clearance, robot.body.height, [*color, 255])]
    for wheel in drive.wheels:
        side = "left" if wheel.side > 0 else "right"
        at = (wheel.x, wheel.side * drive.track_width / 2.0, radius)
        bar = (1.2 * radius, 1.1 * width, 0.2 * radius)
        parts += [
            _part("cylinder", (*at, *_ACROSS_Y), (radius, radius, width), _TYRE, side),
            _part("box", (*at, 1.0, 0.0, 0.0, 0.0), bar, _STEEL, side),
        ]
    return parts


def _part(
    shape: str, pose: tuple[float, ...], size: tuple[float, ...], color: list[int], wheel: str | None
) -> dict[str, Any]:
    return {
        "shape": shape,
        "pose": rounded(pose, 5),
        "size": rounded(size, 5),
        "color": color,
        "wheel": wheel,
        "axis": None if wheel is None else [0, 1, 0],
    }


def _prism(outline: FloatArray, low: float, high: float, color: list[int]) -> dict[str, Any]:
    """Return a convex outline [m], counter-clockwise, from one height to another."""
    count = len(outline)
    vertices = np.vstack([np.c_[outline, np.full(count, z)] for z in (low, high)])
    triangles: list[tuple[int, int, int]] = []
    for i in range(count):
        j = (i + 1) % count
        triangles += [(i, j, count + j), (i, count + j, count + i)]
    for i in range(1, count - 1):
        triangles += [(0, i + 1, i), (count, count + i, count + i + 1)]
    size = tuple(np.ptp(vertices, axis=0).tolist())
    return {
        **_part("mesh", (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), size, color, None),
        "vertices": pack_array(vertices, "f4"),
        "triangles": pack_array(np.array(triangles), "u4"),
    }
