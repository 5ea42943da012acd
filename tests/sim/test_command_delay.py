import math

import pytest

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.robots import Robot
from trundle.sim import Simulator, world_of
from trundle.sim.actuation import Actuation
from trundle.sim.command_delay import DelayedSimulator
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.solids import Box, Solid
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")
DT = 0.05


def drive(simulator, command, periods=60, start=Pose2D(0.0, 0.0)):
    states = [simulator.reset(start)]
    states += [simulator.step(command, DT) for _ in range(periods)]
    return states


@pytest.mark.parametrize("latency", [0.02, 0.05, 0.12, 0.3])
@pytest.mark.parametrize("kind", [KinematicSimulator, MujocoSimulator])
def test_latency_shifts_the_run_in_time(kind, latency):
    with kind(EMPTY, CARTER) as exact, DelayedSimulator(kind(EMPTY, CARTER), latency) as late:
        punctual = drive(exact, Twist2D(0.6, 0.3), 80)
        delayed = drive(late, Twist2D(0.6, 0.3), 80)
    shift = Pose2D(punctual[-1].twist.v * latency, 0.0)
    behind = delayed[-1].pose
    assert [state.time for state in delayed] == pytest.approx([state.time for state in punctual])
    assert delayed[0].pose == delayed[math.floor(latency / DT)].pose or kind is MujocoSimulator
    assert behind.distance_to(punctual[-1].pose) == pytest.approx(shift.x, abs=0.01)


def test_a_reset_forgets_commands_that_are_on_their_way():
    with DelayedSimulator(KinematicSimulator(EMPTY, CARTER), 0.2) as sim:
        drive(sim, Twist2D(0.5, 0.0), 2)
        sim.reset(Pose2D(1.0, 0.0))
        for _ in range(10):
            state = sim.step(Twist2D(), DT)
    assert state.pose == Pose2D(1.0, 0.0)


def test_contacts_of_all_parts_of_a_period_are_reported():
    wall = World("wall", (Solid("wall", Box((0.1, 4.0, 1.0)), Pose3D((0.9, 0.0, 0.5))),))
    with DelayedSimulator(KinematicSimulator(wall, CARTER), 0.03) as sim:
        touched = [state.contacts for state in drive(sim, Twist2D(0.5, 0.0))]
    with KinematicSimulator(wall, CARTER) as exact:
        expected = [state.contacts for state in drive(exact, Twist2D(0.5, 0.0))]
    first, reference = (next(k for k, each in enumerate(some) if each) for some in (touched, expected))
    assert first in (reference, reference + 1)
    assert {contact.other for contact in touched[first]} == {"wall"}


def test_it_is_a_simulator_of_the_same_world():
    with DelayedSimulator(KinematicSimulator(EMPTY, CARTER), 0.1) as sim:
        assert isinstance(sim, Simulator)
        assert world_of(sim) is EMPTY
        assert sim.robot is CARTER


def test_odometry_of_other_wheels_counts_late_commands():
    with DelayedSimulator(Actuation(wheel_radius=1.05).simulate(KinematicSimulator(EMPTY, CARTER)), 0.03) as sim:
        state = drive(sim, Twist2D(0.5, 0.0))[-1]
    assert state.odometry.x == pytest.approx(state.pose.x / 1.05)
