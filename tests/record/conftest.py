"""A short kinematic run, with the calls that an observer received."""

import numpy as np
import pytest

from support.observers import Recorder
from trundle.maps import OccupancyGrid
from trundle.mission import run
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World


@pytest.fixture(scope="session")
def hall():
    data = np.zeros((100, 140), dtype=np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    data[:40, 60:70] = 100
    data[80:, 100:] = -1
    return OccupancyGrid(data, 0.05)


@pytest.fixture(scope="session")
def recorded(hall):
    recorded = Recorder()
    robot = Robot.load("nova_carter")
    with simulate(World.from_map(hall), robot, backend="kinematic") as sim:
        run(
            sim,
            Navigator(hall, robot),
            (1.5, 1.5, 0.0),
            [(1.5, 3.0), (5.0, 2.0, 0.0)],
            observers=[recorded],
            name="hall",
        )
    return recorded
