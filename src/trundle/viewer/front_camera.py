"""Camera of a video: from the front quarter of a robot, planned for the whole run so that nothing hides it for long."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.robots import Robot
from trundle.viewer.cameras import Camera, IsClear, camera_at, reach_of, side_points

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
