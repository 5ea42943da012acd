"""Runs of the MPPI controller on costmaps of a test, without a simulator."""

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import NoValidControlError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.observation import Track
from trundle.path import Path
from trundle.robots import Robot

DT = 0.05
CARTER = Robot.load("nova_carter")
FEW = {"samples": 512}
STRAIGHT = Path(np.array([[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]]))


def costmap_with(*boxes, robot=CARTER, size=10.0, yaw=0.0):
    """A free square room around the origin, with boxes (x0, y0, x1, y1) [m] in it, in a map that is turned by `yaw`."""
    cells = round(size / 0.05)
    data = np.zeros((cells, cells), dtype=np.int8)
    flat = OccupancyGrid(data, 0.05, Pose2D(-size / 2, -size / 2))
    for x0, y0, x1, y1 in boxes:
        (row0, row1), (col0, col1) = flat.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
        data[row0 : row1 + 1, col0 : col1 + 1] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05, Pose2D(0.0, 0.0, yaw) @ flat.origin), robot)


def follow(controller, path, costmap, *, robot=CARTER, start=None, seconds=40.0, each=None):
    """Drive ideally; return poses, twists and the reasons of every tick."""
    controller.set_path(path)
    pose, twist = start or path.start, Twist2D()
    poses, twists, reasons = [pose], [twist], []
    for tick in range(round(seconds / DT)):
        if each is not None:
            each(tick * DT)
        try:
            command = controller.compute_velocity(pose, twist, costmap, DT)
        except NoValidControlError:
            command = Twist2D()
        reasons.append(controller.reason)
        twist = robot.limits.approach(twist, command, DT)
        pose = twist.integrate(pose, DT)
        poses.append(pose)
        twists.append(twist)
        if command == Twist2D() and twist == Twist2D() and not controller.reason:
            break
    return poses, twists, reasons


def as_array(poses):
    return np.array([pose.as_tuple() for pose in poses])


def arrives(poses, goal, position=0.1, yaw=0.1):
    return poses[-1].distance_to(goal) < position and abs(wrap_angle(poses[-1].yaw - goal.yaw)) < yaw


def scaled(scale):
    """A Carter with a footprint of another size; a copy would keep what was made of the old one."""
    return Robot.model_validate(CARTER.model_dump() | {"footprint": (scale * CARTER.outline).tolist()})


def walker(x, y, vx, vy, time=0.0):
    return Track(1, time, x, y, vx, vy, np.diag([1e-3, 1e-3, 1e-2, 1e-2]), 0.3, confirmed=True, moving=True)
