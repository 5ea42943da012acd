import math

import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.teleop.terminal import TextMap
from trundle.worlds import World

ROBOT = Robot.load("nova_carter")


def walls(half_m: float) -> World:
    """A wall along the east and one along the north of a square."""
    east = Solid("east", Box((0.2, 2 * half_m, 1.0)), Pose3D((half_m, 0.0, 0.5)))
    north = Solid("north", Box((2 * half_m, 0.2, 1.0)), Pose3D((0.0, half_m, 0.5)))
    lamp = Solid("lamp", Box((1.0, 1.0, 0.2)), Pose3D((0.0, 0.0, 4.0)))
    return World("walls", (east, north, lamp))


@pytest.mark.parametrize("half_m", [3.0, 6.0])
def test_a_world_that_fits_is_shown_whole_with_north_up_and_stands_still(half_m: float) -> None:
    chart = TextMap(walls(half_m), ROBOT, Pose2D(0.0, 0.0))
    lines = chart.lines(Pose2D(0.0, 0.0), 59, 14)
    assert lines[0].count("#") > 20
    assert all(line.endswith("#") for line in lines[1:-1])
    assert sum(line.count("#") for line in lines[2:]) <= 2 * len(lines)  # The lamp hangs above the robot.
    moved = chart.lines(Pose2D(1.1, -1.1), 59, 14)
    assert moved != lines
    assert [line.count("#") for line in moved] == [line.count("#") for line in lines]


def test_a_large_world_is_centred_on_the_robot() -> None:
    chart = TextMap(walls(40.0), ROBOT, Pose2D(0.0, 0.0))
    for pose in (Pose2D(0.0, 0.0), Pose2D(39.0, 2.0), Pose2D(300.0, 0.0)):
        lines = chart.lines(pose, 59, 14)
        assert len(lines) == 14
        assert max(map(len, lines)) <= 59
        assert lines[6][29] == ">"
    assert "#" in chart.lines(Pose2D(39.0, 2.0), 59, 14)[6][30:]


@pytest.mark.parametrize(
    ("degrees", "arrow"), [(0, ">"), (44, ">"), (46, "^"), (90, "^"), (180, "<"), (-180, "<"), (-90, "v"), (-30, ">")]
)
def test_the_arrow_points_as_the_robot_does(degrees: float, arrow: str) -> None:
    lines = TextMap(World("empty", ()), ROBOT, Pose2D(0.0, 0.0)).lines(Pose2D(5.1, 5.1, math.radians(degrees)), 59, 14)
    assert lines[6][29] == arrow
