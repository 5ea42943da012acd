"""The robot of a running simulator is put somewhere else."""

import math

import pytest

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.sim import place_robot, simulate
from trundle.sim.actuation import Actuation
from trundle.sim.odometry_errors import OdometryErrors
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
WORLD = World("post", (Solid("post", Box((0.4, 0.4, 1.0)), Pose3D((6.0, 0.0, 0.5))),))
START, THERE, AHEAD = Pose2D(0.0, 0.0), Pose2D(2.0, 3.0, math.pi / 2.0), Twist2D(0.5, 0.0)
BACKENDS = ("kinematic", "mujoco")


def drive(sim, periods, command=AHEAD):
    return [sim.step(command, 0.05) for _ in range(periods)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_it_stands_there_and_drives_on_from_there(backend):
    with simulate(WORLD, CARTER, backend=backend) as sim:
        sim.reset(START)
        before = drive(sim, 20)[-1]
        placed = place_robot(sim, THERE)
        assert placed.time == before.time
        assert placed.pose.as_tuple() == pytest.approx(THERE.as_tuple(), abs=1e-9)
        assert placed.twist == Twist2D()
        assert placed.contacts == ()
        after = drive(sim, 40)[-1]
        assert after.time == pytest.approx(before.time + 2.0)
        assert after.pose.x == pytest.approx(THERE.x, abs=0.02)
        assert 0.8 < after.pose.y - THERE.y < 1.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_neither_wheels_nor_odometry_notice(backend):
    with simulate(WORLD, CARTER, backend=backend) as sim:
        sim.reset(START)
        before = drive(sim, 20)[-1]
        placed = place_robot(sim, THERE)
        assert placed.wheel_positions == pytest.approx(before.wheel_positions)
        assert placed.odometry.as_tuple() == pytest.approx(before.odometry.as_tuple(), abs=1e-9)
        after = drive(sim, 20)[-1]
        assert after.odometry.x - before.odometry.x == pytest.approx(after.pose.y - THERE.y, abs=0.01)
        assert after.odometry.y == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_reset_forgets_it(backend):
    with simulate(WORLD, CARTER, backend=backend) as sim:
        sim.reset(START)
        plain = drive(sim, 10)[-1]
        place_robot(sim, THERE)
        sim.reset(START)
        again = drive(sim, 10)[-1]
        assert again.pose == plain.pose
        assert again.odometry == plain.odometry


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_solid_there_is_touched(backend):
    with simulate(WORLD, CARTER, backend=backend) as sim:
        sim.reset(START)
        assert [contact.other for contact in place_robot(sim, Pose2D(6.0, 0.0)).contacts][:1] == ["post"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_same_commands_and_places_give_the_same_run(backend):
    ends = []
    for _ in range(2):
        with simulate(WORLD, CARTER, backend=backend) as sim:
            sim.reset(START)
            drive(sim, 7)
            place_robot(sim, THERE)
            ends.append(drive(sim, 9, Twist2D(0.3, 0.4))[-1])
    assert ends[0].pose == ends[1].pose
    assert ends[0].wheel_positions == ends[1].wheel_positions


def test_it_reaches_the_backend_through_wrappers():
    backend = simulate(WORLD, CARTER, backend="kinematic")
    sim = DelayedSimulator(OdometryErrors(scale=0.1).simulate(Actuation().simulate(backend)), 0.05)
    with sim:
        sim.reset(START)
        before = drive(sim, 20)[-1]
        place_robot(sim, THERE)
        after = drive(sim, 1, Twist2D())[-1]
        assert after.odometry.distance_to(before.odometry) < 0.05
        assert after.pose.distance_to(THERE) < 0.05


def test_a_simulator_that_cannot_do_it_says_so():
    class Bare:
        pass

    with pytest.raises(InputError, match="Bare cannot place the robot"):
        place_robot(Bare(), THERE)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_closed_simulator_refuses(backend):
    sim = simulate(WORLD, CARTER, backend=backend)
    sim.close()
    with pytest.raises(SimulationError, match="closed"):
        place_robot(sim, THERE)
