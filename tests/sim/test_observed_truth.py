"""What a robot observes follows from its wheels, its lidars and the clock; never from the simulation's truth."""

import itertools
from dataclasses import fields

import pytest

from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.observation import Observation, Scan
from trundle.robots import Robot
from trundle.sim.actuation import Actuation
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.sim.odometry_errors import OdometryErrors
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
EMPTY = World("empty", ())
WALL = World("wall", (Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((0.5, 0.0, 0.5))),))
DT = 0.05
FORWARD = Twist2D(0.4, 0.0)


def drive(sim, command, periods):
    sim.reset(Pose2D(0.0, 0.0))
    return [sim.step(command, DT) for _ in range(periods)]


def counted(states):
    """What the observed twists add up to [m], and what the observed poses say [m]."""
    observed = [state.observation for state in states]
    by_twist = sum(each.twist.v * (each.time - last.time) for last, each in itertools.pairwise(observed))
    return by_twist, observed[-1].odometry.x - observed[0].odometry.x


def spin_wheels_at_a_wall(simulator):
    for side in ("left", "right"):
        simulator.model.geom_friction[simulator.model.geom(f"robot:wheel_{side}").id, 0] = 0.2


def test_a_robot_whose_wheels_slip_observes_its_wheels():
    with MujocoSimulator(WALL, CARTER) as sim:
        spin_wheels_at_a_wall(sim)
        states = drive(sim, FORWARD, 60)
    last = states[-1]
    assert last.twist.v == pytest.approx(0.0, abs=0.05)  # it stands at the wall
    assert last.observation.twist.v == pytest.approx(0.4, abs=0.05)
    assert last.observation.twist == CARTER.twist(last.wheel_speeds)


def test_the_odometry_that_is_biased_starts_from_the_wheels_too():
    with MujocoSimulator(WALL, CARTER) as inner:
        spin_wheels_at_a_wall(inner)
        last = drive(OdometryErrors(scale=0.1).simulate(inner), FORWARD, 60)[-1]
    share = last.observation.twist.v / CARTER.twist(last.wheel_speeds).v
    assert share == pytest.approx(0.9) or share == pytest.approx(1.1)


@pytest.mark.parametrize("backend", [KinematicSimulator, MujocoSimulator])
def test_a_robot_observes_the_wheels_that_its_software_believes(backend):
    with backend(EMPTY, CARTER) as inner:
        sim = Actuation(wheel_radius=1.1).simulate(inner)
        states = drive(sim, FORWARD, 60)
        turned = drive(Actuation(track_width=1.1).simulate(inner), Twist2D(0.0, 0.4), 60)[-1]
    assert states[-1].twist.v == pytest.approx(0.44, abs=0.002)
    assert states[-1].observation.twist.v == pytest.approx(0.4, abs=0.002)
    assert turned.twist.w == pytest.approx(0.4 / 1.1, abs=0.003)
    assert turned.observation.twist.w == pytest.approx(0.4, abs=0.003)


@pytest.mark.parametrize(
    "wrap", [lambda sim: sim, Actuation(wheel_radius=1.05).simulate, OdometryErrors(scale=0.05).simulate]
)
def test_the_observed_twists_add_up_to_the_observed_poses(wrap):
    with MujocoSimulator(WALL, CARTER) as inner:
        spin_wheels_at_a_wall(inner)
        by_twist, by_pose = counted(drive(wrap(inner), FORWARD, 60))
    assert by_twist == pytest.approx(by_pose, rel=0.02)


def test_an_observation_holds_nothing_but_what_wheels_lidars_and_the_clock_tell():
    assert {each.name for each in fields(Observation)} == {"time", "twist", "odometry", "scans"}
    assert {each.name for each in fields(Scan)} == {
        "lidar", "time", "mount", "height", "angles", "ranges", "range_min", "range_max", "time_increment",
    }  # fmt: skip


def room(at):
    boxes = (((4.0, 0.0), (0.2, 8.0)), ((0.0, 4.0), (8.0, 0.2)), ((-3.0, -2.0), (1.0, 1.0)))
    return World(
        "room",
        tuple(
            Solid(f"box_{index}", Box((*size, 2.0)), Pose3D((at.x + x, at.y + y, 1.0)))
            for index, ((x, y), size) in enumerate(boxes)
        ),
    )


def observations(sim, start):
    sim.reset(start, seed=4)
    return [sim.step(Twist2D(0.3, 0.2), DT).observation for _ in range(30)]


@pytest.mark.parametrize("delay_s", [0.0, 0.1])
@pytest.mark.parametrize("backend", [KinematicSimulator, MujocoSimulator])
def test_a_world_that_is_moved_with_the_robot_looks_the_same_to_it(backend, delay_s):
    """Nothing that a robot observes may depend on where it truly is, except relative to its surroundings and start."""
    moved = Pose2D(7.0, -3.0, 0.0)
    with backend(room(Pose2D(0.0, 0.0)), CARTER, lidar=True) as one, backend(room(moved), CARTER, lidar=True) as other:
        here_seen = observations(DelayedSimulator(one, delay_s), Pose2D(0.0, 0.0))
        there_seen = observations(DelayedSimulator(other, delay_s), moved)
    assert any(each.scans for each in here_seen)
    for first, second in zip(here_seen, there_seen, strict=True):
        assert second.time == first.time
        assert (second.twist.v, second.twist.w) == pytest.approx((first.twist.v, first.twist.w), abs=1e-4)
        back = moved.inverse() @ second.odometry
        assert (back.x, back.y) == pytest.approx((first.odometry.x, first.odometry.y), abs=1e-4)
        for seen, again in zip(first.scans, second.scans, strict=True):
            assert (again.lidar, again.time, again.mount) == (seen.lidar, seen.time, seen.mount)
            assert again.ranges == pytest.approx(seen.ranges, abs=1e-3)
