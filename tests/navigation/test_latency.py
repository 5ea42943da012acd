import math

import numpy as np
import pytest

from trundle.control import CollisionMonitor, MonitorReport, MonitorSettings
from trundle.control.latency import Latency
from trundle.costmap import LETHAL
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Session, run
from trundle.navigation import CommandScript, Navigator, NavigatorSettings
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
EMPTY = World("empty", ())
WALL = World("wall", (Solid("wall", Box((0.2, 6.0, 1.0)), Pose3D((3.0, 0.0, 0.5))),))
DELAY = Latency(command_delay_s=0.2)


class Swerving:
    """A controller that drives slalom, and keeps from where it did so."""

    def reset(self, *, seed=0):
        self.seen, self.latency = [], None

    def set_path(self, path):
        pass

    def set_speed_limit(self, limit):
        pass

    def set_latency(self, latency):
        self.latency = latency

    def compute_velocity(self, pose, twist, costmap, dt):
        self.seen.append((pose, twist))
        turn = 0.6 if len(self.seen) // 20 % 2 else -0.6
        return Twist2D(0.5, turn)


class HalvingMonitor:
    """Sends half of every third command."""

    def reset(self):
        self.checked = 0

    def check(self, command, twist, scans, time, odometry):
        self.checked += 1
        return MonitorReport(Twist2D(0.5 * command.v, 0.0), "slow") if self.checked % 3 == 0 else MonitorReport(command)


@pytest.fixture
def grid():
    return OccupancyGrid(np.zeros((120, 180), np.int8), 0.1, Pose2D(-6.0, -6.0))


@pytest.mark.parametrize("monitor", [False, HalvingMonitor()])
def test_the_controller_gets_the_pose_at_which_its_command_takes_effect(grid, monitor):
    controller = Swerving()
    controller.reset()
    navigator = Navigator(grid, CARTER, controller=controller)
    sim = KinematicSimulator(EMPTY, CARTER)
    with Session(sim, navigator, (0.0, 0.0, 0.0), (10.0, 0.0), latency=DELAY, monitor=monitor) as session:
        poses = [session.state.pose] + [session.step().state.pose for _ in range(80)]
    assert controller.latency == DELAY
    later = round(DELAY.command_delay_s / 0.05)
    for (pose, _), true in zip(controller.seen, poses[later:], strict=False):
        assert pose.distance_to(true) < 0.004


def test_the_robot_still_arrives_where_it_stands(grid):
    with KinematicSimulator(EMPTY, CARTER) as sim:
        episode = run(sim, Navigator(grid, CARTER), (0.0, 0.0, 0.0), (5.0, 1.0, 0.5), latency=DELAY)
    assert episode.outcome is Outcome.ARRIVED


def test_a_robot_with_a_late_command_stops_before_a_wall_as_one_without_does():
    ahead = []
    for latency in (Latency(), DELAY):
        with KinematicSimulator(WALL, CARTER, lidar=True) as sim:
            episode = run(sim, CommandScript([(1.0, 0.0, 8.0)]), (0.0, 0.0, 0.0), None, latency=latency)
        assert episode.metrics.contacts == ()
        ahead.append(2.9 - episode.trajectory.x.max() - CARTER.outline[:, 0].max())
    assert ahead[1] > 0.0
    assert ahead[1] == pytest.approx(ahead[0], abs=0.05)


def test_the_guard_is_given_the_pose_of_the_command(grid):
    """At 1 m/s and 0.2 s the robot is 0.2 m farther when it brakes: the controller must brake as much earlier."""

    class Probing(Swerving):
        def compute_velocity(self, pose, twist, costmap, dt):
            self.seen.append((pose, twist))
            if pose.x > 1.0:
                raise NoValidControlError("at the mark")
            return Twist2D(0.8, 0.0)

    controller = Probing()
    controller.reset()
    navigator = Navigator(grid, CARTER, controller=controller)
    sim = KinematicSimulator(EMPTY, CARTER)
    with Session(sim, navigator, (0.0, 0.0, 0.0), (5.0, 0.0), latency=DELAY, monitor=False) as session:
        furthest = max(session.step().state.pose.x for _ in range(70))
    first = next(pose.x for pose, _ in controller.seen if pose.x > 1.0)
    braking = 0.8**2 / (2.0 * CARTER.limits.linear_acceleration)
    assert first < 1.0 + 0.8 * 0.05 + 1e-6
    assert furthest == pytest.approx(first + braking, abs=0.06)


def test_a_user_s_own_loop_can_say_how_late_its_commands_arrive(grid):
    navigator = Navigator(grid, CARTER)
    navigator.set_latency(Latency(command_delay_s=0.1))
    navigator.set_goal(5.0, 0.0)
    commands = [navigator.update(Pose2D(0.0, 0.0)) for _ in range(5)]
    assert all(command.v > 0.0 for command in commands)


def test_a_latency_is_a_latency(grid):
    with pytest.raises(InputError, match="Latency\\(command_delay_s"):
        Navigator(grid, CARTER).set_latency(0.1)
    with pytest.raises(InputError, match="Latency\\(command_delay_s"):
        CollisionMonitor(CARTER).set_latency(0.1)
    with pytest.raises(InputError, match="Twist2D"):
        Navigator(grid, CARTER).set_sent_command((0.1, 0.0))


def test_the_monitor_reckons_from_where_its_command_takes_effect():
    """The robot drives towards a wall, and obeys no monitor: contact comes sooner by the delay."""
    seconds = []
    for latency in (Latency(), DELAY):
        monitor = CollisionMonitor(CARTER, MonitorSettings(time_before_collision=6.0, simulation_time_step=0.01))
        monitor.set_latency(latency)
        with KinematicSimulator(WALL, CARTER, lidar=True) as sim:
            state = sim.reset(Pose2D(0.0, 0.0))
            for _ in range(10):
                state = sim.step(Twist2D(0.5, 0.0), 0.05)
            seen = state.observation
            report = monitor.check(Twist2D(0.5, 0.0), seen.twist, seen.scans, seen.time, seen.odometry)
        seconds.append(report.time_to_contact)
    assert seconds[0] - seconds[1] == pytest.approx(DELAY.command_delay_s, abs=0.02)


@pytest.mark.parametrize("age_s", [0.0, 0.2])
def test_old_scans_are_put_where_the_robot_was_when_they_were_measured(grid, age_s):
    controller = Swerving()
    controller.reset()
    navigator = Navigator(grid, CARTER, controller=controller)
    sim = KinematicSimulator(WALL, CARTER, lidar=True)
    latency = Latency(scan_age_s=age_s)
    with Session(sim, navigator, (0.0, 0.0, 0.0), (0.0, 4.0), latency=latency, monitor=False) as session:
        for _ in range(60):
            session.step()
    rows, cols = np.nonzero(navigator.costmap.data == LETHAL)
    x, _ = navigator.costmap.cell_to_world(rows, cols)
    assert len(x) > 20
    assert x.min() > 2.8
    assert x.max() < 3.05


@pytest.mark.parametrize("timestep", [0.002, 1 / 300, 1 / 240, 0.005])
@pytest.mark.parametrize("delay", [0.001, 0.05, 0.1])
def test_the_navigator_predicts_for_the_simulators_steps(grid, timestep, delay):
    controller = Swerving()
    controller.reset()
    period = timestep * round(0.02 / timestep)
    navigator = Navigator(grid, CARTER, controller=controller, settings=NavigatorSettings(control_frequency=1 / period))
    inner, steps = KinematicSimulator(EMPTY, CARTER, timestep=timestep), []
    inner.on_substep = steps.append
    latency = Latency(command_delay_s=delay)
    with Session(inner, navigator, (0.0, 0.0, 0.0), (10.0, 0.0), latency=latency, monitor=False) as session:
        sent = [session.time]
        while session.time < 2.0:
            session.step()
            sent.append(session.time)
    later = math.ceil(delay / timestep - 1e-6)
    assert controller.latency.command_delay_s == pytest.approx(later * timestep)
    checked = 0
    for time, (pose, twist) in zip(sent, controller.seen, strict=False):
        number = round(time / timestep) + later
        if 0 < number <= len(steps):
            true, checked = steps[number - 1], checked + 1
            assert pose.distance_to(true.pose) < 0.004
            assert twist.v == pytest.approx(true.twist.v, abs=1e-6)
    assert checked > 50
