"""Camera placement: fixed views of a world and views that follow a robot."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trundle.errors import InputError, UnknownNameError
from trundle.geometry import FloatArray, Pose2D
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.map_look import shown_bounds

CAMERAS = ("chase", "robot", "overview", "top")
"""`chase` from behind the robot, `robot` close to its front, `overview` of the world, `top` straight down on it."""

_WIDE, _NARROW = 45.0, 30.0


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera without roll.

    Attributes:
        eye: Position [m], map frame.
        target: Point in the middle of the picture [m], map frame; if it is straight below the eye, north is up.
        fovy_deg: Vertical field of view [deg].

    Raises:
        InputError: If a number is not finite, eye and target are equal, or the field of view is not in 1..150.
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fovy_deg: float = _WIDE

    def __post_init__(self) -> None:
        numbers = (*self.eye, *self.target, self.fovy_deg)
        if not all(math.isfinite(number) for number in numbers) or math.dist(self.eye, self.target) < 1e-6:
            raise InputError(f"a camera needs two different points to look from and at, got {self.eye}, {self.target}")
        if not 1.0 <= self.fovy_deg <= 150.0:
            raise InputError(f"a camera's field of view must be 1 to 150 degrees, got {self.fovy_deg}")

    @property
    def distance(self) -> float:
        """Distance from the eye to the target [m]."""
        return math.dist(self.eye, self.target)

    def angles(self) -> tuple[float, float]:
        """Return azimuth and elevation of the line of sight [rad]; straight up or down the azimuth is north."""
        dx, dy, dz = (to - at for to, at in zip(self.target, self.eye, strict=True))
        across = math.hypot(dx, dy)
        azimuth = math.atan2(dy, dx) if across > 1e-9 * abs(dz) else math.pi / 2.0
        return azimuth, math.atan2(dz, across)

    def axes(self) -> FloatArray:
        """Return unit vectors right, up and forward in the map frame, shape (3, 3), one a row."""
        return _axes(*self.angles())


IsClear = Callable[[tuple[float, float, float], tuple[float, float, float]], bool]
"""Whether the line between two points [m] is clear."""

# From behind, first low and far, then nearer, then from above: elevation [deg] and distance [sizes of the robot].
_CHASE = ((24, 5.6), (34, 5.6), (26, 3.8), (40, 4.2), (56, 4.6), (68, 5.0), (80, 5.4))


def aim(name: str, world: World, robot: Robot, pose: Pose2D, aspect: float, is_clear: IsClear) -> Camera:
    """Place a camera of `CAMERAS`.

    Args:
        name: Name of the camera.
        world: The world.
        robot: The robot.
        pose: Pose of the robot.
        aspect: Width over height of the picture.
        is_clear: Views that follow the robot rise or turn until this says that it is visible.

    Raises:
        UnknownNameError: If there is no such camera.
    """
    match name:
        case "chase":
            return _first_clear(_chase_views(robot, pose), side_points(robot, pose), is_clear)
        case "robot":
            return _first_clear(_portraits(robot, pose), side_points(robot, pose), is_clear)
        case "overview":
            return _fit(*_extent(world, robot, pose), math.radians(70.0), math.radians(-42.0), _NARROW, aspect)
        case "top":
            return _fit(*_extent(world, robot, pose), math.pi / 2.0, -math.pi / 2.0, _NARROW, aspect)
        case _:
            raise UnknownNameError("camera", name, CAMERAS)


def _first_clear(cameras: list[Camera], points: list[tuple[float, float, float]], is_clear: IsClear) -> Camera:
    """Return the first camera that sees all points [m]; the last if none does."""
    return next((camera for camera in cameras if all(is_clear(point, camera.eye) for point in points)), cameras[-1])


def side_points(robot: Robot, pose: Pose2D) -> list[tuple[float, float, float]]:
    """Return points on both sides of a robot, just above it [m]."""
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    x = float(low[0] + high[0]) / 2.0
    points = pose.transform_points([(x, float(low[1])), (x, float(high[1]))])
    return [(float(px), float(py), robot.body.height) for px, py in points]


def reach_of(robot: Robot) -> float:
    """Return the size of a robot [m], by which views of it scale."""
    return max(*robot.planar.size, robot.body.height)


def _chase_views(robot: Robot, pose: Pose2D) -> list[Camera]:
    reach = reach_of(robot)
    front = pose.transform_points([(1.2 * reach, 0.0)])[0]
    target = (float(front[0]), float(front[1]), 0.5 * robot.body.height)
    return [camera_at(target, pose.yaw, -math.radians(rise), distance * reach, _WIDE) for rise, distance in _CHASE]


def _portraits(robot: Robot, pose: Pose2D) -> list[Camera]:
    middle = pose.transform_points([robot.outline.mean(axis=0)])[0]
    target = (float(middle[0]), float(middle[1]), 0.48 * robot.body.height)
    distance = 3.3 * reach_of(robot)
    return [
        camera_at(target, pose.yaw + math.radians(180.0 + turn), -math.radians(rise), distance, _NARROW)
        for rise in (20.0, 38.0, 60.0)
        for turn in (38.0, -38.0, 142.0, -142.0)
    ]


def camera_at(
    target: tuple[float, float, float], azimuth: float, elevation: float, distance: float, fovy_deg: float
) -> Camera:
    """Return a camera that looks at a point [m] from a distance [m], along an azimuth and an elevation [rad]."""
    forward = _axes(azimuth, elevation)[2]
    eye = np.asarray(target) - distance * forward
    return Camera((float(eye[0]), float(eye[1]), float(eye[2])), target, fovy_deg)


def _extent(world: World, robot: Robot, pose: Pose2D) -> tuple[FloatArray, FloatArray]:
    """Return bounds [m] of what an overview shows: the world, or if it is empty the robot with some floor around it."""
    if world.solids:
        return shown_bounds(world.solids)
    around = 1.5 * reach_of(robot)
    return (
        np.array([pose.x - around, pose.y - around, 0.0]),
        np.array([pose.x + around, pose.y + around, robot.body.height]),
    )


def _fit(low: FloatArray, high: FloatArray, azimuth: float, elevation: float, fovy_deg: float, aspect: float) -> Camera:
    """Look at bounds [m] so that they fill the picture; tall objects on the near side may extend beyond it."""
    axes = _axes(azimuth, elevation)
    middle = (low + high) / 2.0
    corners = np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    is_far = (corners - middle) @ (axes[2] * (1.0, 1.0, 0.0)) >= -1e-6
    corners = corners[is_far | (corners[:, 2] == low[2])]
    half = math.tan(math.radians(fovy_deg) / 2.0) * 0.95
    target, distance = middle, 1.0
    for _ in range(20):  # Centre the view, then step back until it fits.
        right, up, forward = axes @ (corners - target).T
        distance = float(np.max([np.abs(right) / (half * aspect) - forward, np.abs(up) / half - forward]))
        for axis, offset in ((axes[0], right), (axes[1], up)):
            seen = offset / (distance + forward)
            target = target + axis * (seen.max() + seen.min()) / 2.0 * distance
    return camera_at((float(target[0]), float(target[1]), float(target[2])), azimuth, elevation, distance, fovy_deg)


def _axes(azimuth: float, elevation: float) -> FloatArray:
    forward = (
        math.cos(elevation) * math.cos(azimuth),
        math.cos(elevation) * math.sin(azimuth),
        math.sin(elevation),
    )
    right = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    return np.array([right, np.cross(right, forward), forward])
