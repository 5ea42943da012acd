"""Which level plane of a file is its ground, in every format."""

import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.floors import find_common_floor, find_floor, lower_world
from trundle.worlds.shapes import ENDLESS, LevelPlane, find_ground

CARTER = Robot.load("nova_carter")
HERE = Pose2D(0.0, 0.0)


def box(name, low, high, size=(1.0, 1.0), at=(3.0, 0.0)):
    return Solid(name, Box((*size, high - low)), Pose3D((*at, (low + high) / 2.0)))


@pytest.mark.parametrize(
    ("planes", "solids", "ground"),
    [
        ([], [], None),
        ([(0.0, 1.0)], [], 0.0),
        ([(-0.5, ENDLESS)], [box("wall", -0.5, 2.0)], -0.5),
        ([(-0.5, ENDLESS), (0.0, 1.0), (1.0, ENDLESS)], [], 0.0),
        ([(0.3, ENDLESS)], [], 0.3),
        ([(0.3, 100.0)], [box("wall", 0.0, 2.0)], 0.3),
        ([(0.3, 100.0), (1.0, 100.0)], [box("wall", 0.3, 2.0)], 0.3),
        ([(3.0, 100.0)], [box("wall", 0.0, 3.0)], None),
        ([(3.0, ENDLESS)], [box("slab", -0.2, 0.0)], None),
        ([(0.75, 2.0)], [box("wall", 0.0, 3.0)], None),
        ([(-0.5, 2.0)], [box("wall", 0.0, 3.0)], None),
    ],
    ids=[
        "none",
        "at zero, of any size",
        "below",
        "the highest at zero or below",
        "above, alone",
        "above, with a wall through it",
        "the lowest above",
        "a roof on walls",
        "a deck over a slab",
        "a table's top",
        "a small pit",
    ],
)
def test_the_ground_is_the_plane_that_carries_everything(planes, solids, ground):
    assert find_ground([LevelPlane(*plane) for plane in planes], solids) == ground


@pytest.mark.parametrize("height", [-0.5, 0.3, 1.5])
def test_the_ground_is_the_floor(height):
    world = World("w", (box("wall", height - 0.1, height + 2.0),), ground_z=height)
    assert find_floor(world, CARTER, HERE) == height
    assert find_common_floor(world, CARTER) == height
    lowered = lower_world(world, height)
    assert lowered.ground_z == 0.0
    assert lowered.bounds[0][2] == pytest.approx(-0.1)
    assert find_common_floor(World("w", (), ground_z=height), CARTER) == height


def test_nothing_below_the_ground_is_a_floor():
    pit = box("pit", -1.0, -0.4, size=(10.0, 10.0), at=(0.0, 0.0))
    assert find_floor(World("w", (pit,)), CARTER, HERE) == pytest.approx(-0.4)
    assert find_floor(World("w", (pit,), ground_z=0.0), CARTER, HERE) == 0.0


def test_a_slab_on_the_ground_is_the_floor():
    slab = box("slab", -0.6, -0.466, size=(10.0, 10.0), at=(0.0, 0.0))
    assert find_floor(World("w", (slab,), ground_z=-0.5), CARTER, HERE) == pytest.approx(-0.466)


def test_a_slab_that_ends_with_the_ground_is_the_ground():
    slab = box("slab", -0.6, -0.503, size=(10.0, 10.0), at=(0.0, 0.0))
    assert find_floor(World("w", (slab,), ground_z=-0.5), CARTER, HERE) == -0.5
