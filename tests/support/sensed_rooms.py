"""A robot with one lidar, and rooms of blocks for it to drive in."""

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
_LIDARS = {name: lidar.model_copy(update={"beams": 360, "noise": 0.01}) for name, lidar in CARTER.lidars.items()}
ROBOT = CARTER.model_copy(update={"lidars": {"front": _LIDARS["front"]}})
START, GOAL = Pose2D(1.5, 3.0), Pose2D(8.5, 3.0)


def block(name, x0, y0, x1, y1, height=1.0):
    pose = Pose3D.planar(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * height, 0.0)
    return Solid(name, Box((x1 - x0, y1 - y0, height)), pose)


def room(*inside, width=10.0, height=6.0):
    """A room with its corner at (0, 0), with blocks in it."""
    walls = [
        block("south", -0.2, -0.2, width + 0.2, 0.0),
        block("north", -0.2, height, width + 0.2, height + 0.2),
        block("west", -0.2, 0.0, 0.0, height),
        block("east", width, 0.0, width + 0.2, height),
    ]
    return World("room", (*walls, *inside))


def grid_of(world):
    return OccupancyGrid.from_world(world)
