"""A small map, a robot, a simulator that follows commands exactly, and sessions that are steered."""

import math

import numpy as np
import pytest

from support.sessions import Watch
from trundle.errors import SimulationError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Session, Steering
from trundle.navigation import Navigator
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import Contact, RobotState, simulate
from trundle.worlds import World

BACKENDS = ("kinematic", "mujoco")


def make_room(width_m=8.0, height_m=6.0, resolution=0.05):
    """A walled room with its lower-left corner at the map's origin, and a block from the south up to y = 3 m."""
    rows, cols = round(height_m / resolution), round(width_m / resolution)
    data = np.zeros((rows, cols), dtype=np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    data[: round(3.0 / resolution), round(3.6 / resolution) : round(4.4 / resolution)] = 100
    return OccupancyGrid(data, resolution)


def write_scenario(folder, text):
    path = folder / "scenario.yaml"
    path.write_text(text)
    return path


class ExactSimulator:
    """Drives each command at once. Touches `wall` where x exceeds `wall_x` [m]; breaks down at `breaks_at` [s]."""

    def __init__(self, robot, *, wall_x=math.inf, breaks_at=math.inf, drag=0.0):
        self.robot = robot
        self.wall_x = wall_x
        self.breaks_at = breaks_at
        self.drag = drag
        self.seeds = []

    def reset(self, pose, *, seed=0):
        self.seeds.append(seed)
        self._begin, self._pose, self._time = pose, pose, 0.0
        return self._state(Twist2D())

    def step(self, command, dt):
        if self._time >= self.breaks_at:
            raise SimulationError("the robot left the world")
        twist = self.robot.limits.clamp(command)
        twist = Twist2D(twist.v * (1.0 - self.drag), twist.w * (1.0 - self.drag))
        self._pose = twist.integrate(self._pose, dt)
        self._time += dt
        return self._state(twist)

    def _state(self, twist):
        touching = self._pose.x > self.wall_x
        contacts = (Contact("chassis", "wall", self._pose.x, self._pose.y),) if touching else ()
        odometry = self._begin.inverse() @ self._pose
        stand = WheelSpeeds(0.0, 0.0)
        return RobotState(self._time, self._pose, twist, stand, self.robot.wheel_speeds(twist), odometry, contacts)

    def close(self):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


@pytest.fixture(scope="session")
def room():
    return make_room()


@pytest.fixture(scope="session")
def carter():
    return Robot.load("nova_carter")


@pytest.fixture
def navigator(room, carter):
    return Navigator(room, carter)


@pytest.fixture
def make_sim(carter):
    return lambda **options: ExactSimulator(carter, **options)


@pytest.fixture
def start():
    return Pose2D(1.5, 1.5, 0.0)


@pytest.fixture(scope="session")
def world(room):
    return World.from_map(room)


@pytest.fixture(params=BACKENDS)
def sim(request, world, carter):
    with simulate(world, carter, backend=request.param) as made:
        yield made


@pytest.fixture
def kinematic_sim(world, carter):
    with simulate(world, carter, backend="kinematic") as made:
        yield made


@pytest.fixture
def steering():
    return Steering()


@pytest.fixture
def watch():
    return Watch()


@pytest.fixture
def session(kinematic_sim, navigator, start, steering):
    """A steered session without a goal."""
    return Session(kinematic_sim, navigator, start, None, steering=steering)
