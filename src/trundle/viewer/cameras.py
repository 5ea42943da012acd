"""Camera placement: fixed views of a world, views that follow a robot, and a video's from its front quarter."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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


_VIEWS = np.array(
    [
        # Where the camera stands around the robot, 0 in front of it [deg], how high [deg], how far [sizes of the
        # robot], and the cost of a picture from there.
        (36.0, 22.0, 4.6, 0.0),
        (-36.0, 22.0, 4.6, 0.0),
        (24.0, 32.0, 4.4, 0.5),
        (-24.0, 32.0, 4.4, 0.5),
        (64.0, 28.0, 4.4, 0.8),
        (-64.0, 28.0, 4.4, 0.8),
        (0.0, 40.0, 4.4, 1.0),
        (36.0, 46.0, 4.6, 1.2),
        (-36.0, 46.0, 4.6, 1.2),
        (30.0, 64.0, 5.0, 2.5),
        (-30.0, 64.0, 5.0, 2.5),
        (0.0, 80.0, 5.4, 4.0),
    ]
)
_HIDDEN = 10.0  # cost of a picture in which nothing of the robot is seen
_MOVE, _PER_DEG = 4.0, 0.05  # cost of another view than in the picture before, and of each degree between the two
_EVERY = 4  # pictures from one decision to the next
_SOFT = 12  # pictures within which the camera begins and ends a motion, about
_FOVY_DEG = 42.0


def front_views(robot: Robot, poses: npt.NDArray[np.float64], is_clear: IsClear) -> list[Camera]:
    """Return the camera for each picture of a run.

    The cheapest sequence of views is found over all pictures (Viterbi, 1967): a view costs more the less it is one
    from the front quarter, and while something hides the robot; changing it costs, too. So the camera moves away
    before a wall comes between.

    Args:
        robot: The robot.
        poses: Its poses in the pictures [m, m, rad], map frame, shape (N, 3).
        is_clear: Whether nothing is between two points.
    """
    decided = np.unique(np.r_[np.arange(0, len(poses), _EVERY), len(poses) - 1])
    costs = np.array([_view_costs(robot, Pose2D(*poses[row].tolist()), is_clear) for row in decided])
    chosen = _VIEWS[_cheapest(costs), :3]
    numbers = np.arange(len(poses))
    turn, rise, distance = (_soften(np.interp(numbers, decided, chosen[:, column])) for column in range(3))
    facing = _soften(np.unwrap(poses[:, 2]))
    return [
        _view(
            robot, Pose2D(*pose), float(facing[row] + math.radians(turn[row])), float(rise[row]), float(distance[row])
        )
        for row, pose in enumerate(poses.tolist())
    ]


def _view(robot: Robot, pose: Pose2D, around: float, rise_deg: float, distance: float) -> Camera:
    """Return the camera that stands in a direction from the robot [rad], map frame."""
    middle = pose.transform_points([robot.outline.mean(axis=0)])[0]
    target = (float(middle[0]), float(middle[1]), 0.6 * robot.body.height)
    return camera_at(target, around + math.pi, -math.radians(rise_deg), distance * reach_of(robot), _FOVY_DEG)


def _view_costs(robot: Robot, pose: Pose2D, is_clear: IsClear) -> FloatArray:
    """Return the cost of each view of a robot at a pose."""
    high = robot.body.height
    front = float(robot.outline[:, 0].max())
    (x, y), (far_x, far_y) = pose.transform_points([(front, 0.0), (front + reach_of(robot), 0.0)]).tolist()
    points = [*side_points(robot, pose), (x, y, 0.3 * high), (far_x, far_y, 0.1 * high)]
    costs = _VIEWS[:, 3].copy()
    for index, (turn, rise, distance, _) in enumerate(_VIEWS.tolist()):
        eye = _view(robot, pose, pose.yaw + math.radians(turn), rise, distance).eye
        hidden = sum(not is_clear(point, eye) for point in points)
        costs[index] += _HIDDEN * hidden / len(points)
    return costs


def _cheapest(costs: FloatArray) -> npt.NDArray[np.intp]:
    """Return the sequence of views, shape (N,), that costs least with the changes between them."""
    apart = np.abs(_VIEWS[:, None, :2] - _VIEWS[None, :, :2]).sum(axis=2)
    change = np.where(apart > 0.0, _MOVE + _PER_DEG * apart, 0.0)
    total = costs[0]
    before: list[npt.NDArray[np.intp]] = []
    for row in costs[1:]:
        ways = total[:, None] + change
        before.append(ways.argmin(axis=0))
        total = ways.min(axis=0) + row
    found = [int(total.argmin())]
    for pointers in reversed(before):
        found.append(int(pointers[found[-1]]))
    return np.array(found[::-1])


def _soften(values: FloatArray) -> FloatArray:
    """Return values averaged over the pictures around each, near ones more."""
    weights = np.hanning(2 * _SOFT + 1)
    padded = np.pad(values, _SOFT, mode="edge")
    return np.asarray(np.convolve(padded, weights / weights.sum(), mode="valid"), dtype=np.float64)
