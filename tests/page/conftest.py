import pytest

from trundle.mission import Session
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World


@pytest.fixture(scope="session")
def carter():
    return Robot.load("nova_carter")


@pytest.fixture(scope="session")
def office():
    return World.generate("office", seed=3)


@pytest.fixture
def hall():
    """A room of 10 m x 8 m with a pillar, whose solids have hostile names."""
    from trundle.geometry import Pose3D
    from trundle.geometry.solids import Box, Cylinder, Solid

    def wall(name, x, y, size):
        return Solid(name, Box(size), Pose3D((x, y, 1.0)), (0.9, 0.9, 0.9, 1.0), "wall")

    return World(
        "hall",
        (
            wall("south", 0.0, -4.0, (10.0, 0.2, 2.0)),
            wall("north", 0.0, 4.0, (10.0, 0.2, 2.0)),
            wall("west", -5.0, 0.0, (0.2, 8.0, 2.0)),
            wall("east", 5.0, 0.0, (0.2, 8.0, 2.0)),
            Solid("</script><b>pillar", Cylinder(0.3, 1.0), Pose3D((0.0, 1.5, 0.5)), (0.2, 0.4, 0.6, 1.0), "pillar"),
        ),
        seeds=((0.0, 0.0),),
    )


@pytest.fixture
def drive(hall, carter):
    """Drive through the hall with observers, and return the episode."""

    def go(*observers, goal=(3.0, 0.0, 0.0), lidar=False, **options):
        from trundle.maps import OccupancyGrid

        grid = OccupancyGrid.from_world(hall)
        with KinematicSimulator(hall, carter, lidar=lidar) as sim:
            return Session(
                sim, Navigator(grid, carter), (-3.0, 0.0, 0.0), goal, observers=list(observers), name="hall", **options
            ).run()

    return go
