import math
from dataclasses import replace

import pytest

from trundle.errors import WorldError
from trundle.geometry import Pose2D
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.lidar import LidarSet, SceneBeams
from trundle.sim.mujoco.simulator import MujocoSimulator
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
        self._now = self._now.copy()
        self._now[0] += 0.02 * state.twist.v * dt * math.cos(self._now[2])
        return state


class Forgetful(KinematicSimulator):
    """Every run starts where the last one ended."""

    def reset(self, pose, *, seed=0):
        last = self._now[:3].tolist() if hasattr(self, "_now") else (0.0, 0.0, 0.0)
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


class Least:
    """A good simulator with what every simulator must have, and no more."""

    def __init__(self, world, robot):
        self._sim = KinematicSimulator(world, robot)
        self.robot, self.reset, self.step, self.close = robot, self._sim.reset, self._sim.step, self._sim.close

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Elsewhere(KinematicSimulator):
    """Says that it simulates another world."""

    @property
    def world(self):
        return World("another", ())


class Timeless(KinematicSimulator):
    """Its physics steps have no length."""

    @property
    def timestep(self):
        return 0.0


class Watched(KinematicSimulator):
    """Can no longer be left alone by a watcher."""

    def watch_substeps(self, watch):
        return watch is not None and super().watch_substeps(watch)


class Hollow(KinematicSimulator):
    """Takes solids, and forgets them."""

    def add_solid(self, solid):
        pass


class Cluttered(KinematicSimulator):
    """Keeps added solids for ever."""

    def add_solid(self, solid):
        super().add_solid(solid)
        self._first_world = self._world


class Skidding(KinematicSimulator):
    """Its wheels turn as the robot is placed."""

    def place(self, pose):
        return replace(super().place(pose), odometry=pose)


def test_a_simulator_needs_no_more_than_it_must_have():
    check_simulator(Least)


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (Drifting, "ends 0.0"),
        (Forgetful, "a reset to"),
        (Blind, "contacts with nothing"),
        (Boundless, "its limit is"),
        (Undead, "after close"),
        (Unmoved, "the movers are"),
        (Elsewhere, "the world that it was made for"),
        (Timeless, "timestep must be a positive number"),
        (Watched, "still reported"),
        (Hollow, "is not touched"),
        (Cluttered, "still there after a reset"),
        (Skidding, "moves the odometry"),
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
