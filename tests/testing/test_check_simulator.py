import math
from dataclasses import replace

import pytest

from trundle.errors import WorldError
from trundle.geometry import Pose2D
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.lidar import LidarSet
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.sim.scene_beams import SceneBeams
from trundle.testing import ConformanceError, check_simulator
from trundle.worlds import World

ROBOTS = ["nova_carter", "turtlebot3_burger", "turtlebot3_waffle", "jackal"]


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("make", [KinematicSimulator, MujocoSimulator])
def test_our_simulators_pass(make, robot):
    check_simulator(make, robot=robot, with_lidars=lambda world, machine: make(world, machine, lidar=True))


class Drifting(KinematicSimulator):
    """Drives 2 % too far."""

    def step(self, command, dt):
        state = super().step(command, dt)
        x, y, yaw = self._pose
        self._pose = (x + 0.02 * state.twist.v * dt * math.cos(yaw), y, yaw)
        return state


class Forgetful(KinematicSimulator):
    """Every run starts where the last one ended."""

    def reset(self, pose, *, seed=0):
        last = getattr(self, "_pose", (0.0, 0.0, 0.0))
        return super().reset(Pose2D(*last), seed=seed)


class Blind(KinematicSimulator):
    """Sees no solid."""

    def __init__(self, world, robot):
        super().__init__(World("empty", ()), robot)


class Unmoved(KinematicSimulator):
    """Knows no movers, and does not say so."""

    def __init__(self, world, robot):
        super().__init__(replace(world, movers=()), robot)


class Unseeing(KinematicSimulator):
    """Its lidars do not see movers."""

    def __init__(self, world, robot):
        super().__init__(world, robot, lidar=True)
        beams = SceneBeams(world, None)
        self._lidars = LidarSet(robot, True, beams.cast)
        beams.prepare(self._lidars.heights)


class Refusing(KinematicSimulator):
    """Says that it has no movers."""

    def __init__(self, world, robot):
        if world.movers:
            raise WorldError("this simulator has no movers yet")
        super().__init__(world, robot)


class Boundless(KinematicSimulator):
    """Has no limits."""

    def __init__(self, world, robot):
        limits = robot.limits.model_copy(update={"linear_speed": 9.0, "linear_acceleration": 99.0})
        super().__init__(world, robot.model_copy(update={"limits": limits}))
        self._robot = robot


class Undead(KinematicSimulator):
    """Still runs after it was closed."""

    def close(self):
        pass


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (Drifting, "ends 0.0"),
        (Forgetful, "a reset to"),
        (Blind, "contacts with nothing"),
        (Boundless, "its limit is"),
        (Undead, "after close"),
        (Unmoved, "the movers are"),
    ],
)
def test_broken_simulators_do_not(broken, message):
    with pytest.raises(ConformanceError, match=message):
        check_simulator(broken)


def test_lidars_must_see_movers():
    with pytest.raises(ConformanceError, match="measures"):
        check_simulator(KinematicSimulator, with_lidars=Unseeing)


def test_a_simulator_may_say_that_it_has_no_movers():
    check_simulator(Refusing)


def test_a_failed_check_is_an_assertion_error():
    assert issubclass(ConformanceError, AssertionError)
