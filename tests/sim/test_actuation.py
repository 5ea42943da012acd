import math

import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Scenario
from trundle.robots import Robot
from trundle.sim.actuation import Actuation
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")
DT = 0.05


def drive(simulator, command, periods=60, start=Pose2D(0.0, 0.0)):
    states = [simulator.reset(start)]
    states += [simulator.step(command, DT) for _ in range(periods)]
    return states


def test_without_a_difference_it_is_the_simulator_itself():
    with KinematicSimulator(EMPTY, CARTER) as sim:
        assert Actuation().simulate(sim) is sim


def test_larger_wheels_drive_farther_than_the_odometry_counts():
    with Actuation(wheel_radius=1.05).simulate(KinematicSimulator(EMPTY, CARTER)) as sim:
        state = drive(sim, Twist2D(0.5, 0.0))[-1]
    with KinematicSimulator(EMPTY, CARTER) as exact:
        believed = drive(exact, Twist2D(0.5, 0.0))[-1]
    assert state.twist.v == pytest.approx(0.525)
    assert state.odometry.x == pytest.approx(state.pose.x / 1.05)
    # Limits in acceleration act on what the robot does, so that it starts a little later.
    assert state.odometry.x == pytest.approx(believed.pose.x, abs=0.01)


def test_a_wider_track_turns_less_than_commanded():
    with Actuation(track_width=1.1).simulate(KinematicSimulator(EMPTY, CARTER)) as sim:
        state = drive(sim, Twist2D(0.0, 0.4))[-1]
    assert state.twist.w == pytest.approx(0.4 / 1.1)
    assert state.odometry.yaw == pytest.approx(1.1 * state.pose.yaw)


def test_a_heavier_robot_takes_longer_to_reach_its_speed():
    def speed(mass, periods=4):
        with MujocoSimulator(EMPTY, CARTER, mass=mass) as sim:
            return drive(sim, Twist2D(1.0, 0.0), periods)[-1].twist.v

    assert speed(2.0) < speed(1.0) < speed(0.5)


def test_on_ice_the_wheels_turn_farther_than_the_robot_drives():
    def slip(friction):
        with MujocoSimulator(EMPTY, CARTER, friction=friction) as sim:
            state = drive(sim, Twist2D(1.0, 0.0), 10)[-1]
        return state.odometry.x - state.pose.x

    assert slip(0.05) > 0.05 > slip(1.0)


def test_factors_of_one_change_nothing():
    with MujocoSimulator(EMPTY, CARTER) as plain, MujocoSimulator(EMPTY, CARTER, mass=1.0, friction=1.0) as same:
        assert drive(plain, Twist2D(0.5, 0.4))[-1] == drive(same, Twist2D(0.5, 0.4))[-1]


@pytest.mark.parametrize("option", [{"mass": 0.0}, {"mass": math.nan}, {"friction": 100.0}, {"friction": "ice"}])
def test_implausible_factors_are_refused(option):
    with pytest.raises(InputError, match=next(iter(option))):
        MujocoSimulator(EMPTY, CARTER, **option)


@pytest.mark.parametrize("option", [{"wheel_radius": 0.0}, {"track_width": 3.0}, {"track": 1.0}, {"latency_s": 0.1}])
def test_implausible_actuation_is_refused(option):
    with pytest.raises(InputError, match=next(iter(option))):
        Actuation(**option)


@pytest.mark.slow
def test_a_scenario_carries_the_actuation(tmp_path):
    scenario = Scenario.make(
        world="corridors",
        backend="kinematic",
        actuation={"wheel_radius": 1.03},
        latency={"command_delay_s": 0.1},
    )
    scenario.save(tmp_path / "scenario.yaml")
    again = Scenario.load(tmp_path / "scenario.yaml")
    assert again == scenario
    with scenario.build() as mission, again.build() as repeated:
        assert mission.run().metrics.time_s == repeated.run().metrics.time_s
