"""What a robot does in front of an obstacle that closes all paths, in simulators."""

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.control import create_controller
from trundle.errors import NoPathError
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Outcome, run
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.progress import BlockWatch
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CELL = 0.05


def closed(grid, x, angle):
    """The map's values with a wall across the whole hall at `x` [m], turned by `angle` [rad] about its middle."""
    rows, cols = np.mgrid[0 : grid.shape[0], 0 : grid.shape[1]]
    across = (((cols + 0.5) * CELL - x) * np.cos(angle)) + ((rows + 0.5) * CELL - 4.0) * np.sin(angle)
    return np.where(np.abs(across) < 0.15, np.int8(100), grid.data)


class Closing:
    """Closes the hall for the navigator when the robot is 3 m on, and frees it after a while, or never."""

    def __init__(self, navigator, values, *, freed_at=np.inf):
        self.navigator, self.values, self.freed_at = navigator, values, freed_at
        self.free = navigator.costmap
        self.closed = False
        self.steps = []

    def on_start(self, info):
        pass

    def on_step(self, step):
        self.steps.append(step)
        navigator, everything = self.navigator, (slice(0, 160), slice(0, 240))
        if not self.closed and step.state.pose.x > 3.0:
            navigator.static_costmap = navigator.static_costmap.update(*everything, self.values)
            self.closed = True
        if step.state.time > self.freed_at:
            navigator.static_costmap = self.free

    def on_end(self, episode):
        pass


def drive_at_wall(backend, robot, angle, *, goal_y=4.0, **when):
    grid = walled_room()
    world, navigator = World.from_map(grid), Navigator(grid, robot)
    closing = Closing(navigator, closed(grid, 7.5, angle), **when)
    with simulate(world, navigator.robot, backend=backend) as sim:
        episode = run(sim, navigator, (1.5, 4.3, 0.0), (10.5, goal_y), observers=[closing], time_limit_s=120.0)
    return navigator, closing, episode


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
@pytest.mark.parametrize(
    ("robot", "angle"),
    [("nova_carter", 0.0), ("turtlebot3_waffle", 0.15), ("turtlebot3_waffle", -0.4), ("jackal", 0.5)],
)
def test_a_wall_across_the_whole_corridor_is_a_block_and_at_last_no_path(backend, robot, angle):
    navigator, closing, episode = drive_at_wall(backend, robot, angle)
    assert episode.outcome is Outcome.NO_PATH
    assert "separated" in episode.message
    assert navigator.status is NavigationStatus.NO_PATH
    assert isinstance(navigator.error, NoPathError)
    blocked = [step.status is NavigationStatus.BLOCKED for step in closing.steps]
    assert np.count_nonzero(np.diff(np.array(blocked, dtype=int)) == 1) >= 3
    poses = episode.trajectory.poses
    assert not navigator.costmap.footprint_collides(poses).any()
    assert poses[:, 0].max() > 6.0 - navigator.robot.circumscribed_radius
    # While it does not drive it does not sway either.
    turning = np.array([step.command.w for step in closing.steps if step.command.v == 0.0])
    assert np.count_nonzero(turning[1:] * turning[:-1] < 0.0) <= 6


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_path_that_is_freed_again_is_driven_to_its_end(backend):
    # It has then stood in front of the wall for longer than the time allowance for progress on a free path.
    navigator, closing, episode = drive_at_wall(backend, "turtlebot3_waffle", 0.15, freed_at=38.0)
    assert episode.outcome is Outcome.ARRIVED
    assert navigator.error is None
    times = [step.state.time for step in closing.steps if step.status is NavigationStatus.BLOCKED]
    assert times[0] < 35.0
    assert times[-1] > 35.0


@pytest.mark.parametrize("seed", range(3))
def test_noise_of_the_pose_hides_no_block(seed):
    grid, rng = walled_room(), np.random.default_rng(seed)
    navigator = Navigator(grid, "turtlebot3_waffle")
    navigator.set_goal(10.5, 4.0)
    with simulate(World.from_map(grid), navigator.robot, backend="kinematic") as sim:
        state = sim.reset(Pose2D(5.0, 4.3))
        navigator.plan(state.pose)
        navigator.static_costmap = navigator.static_costmap.update(slice(0, 160), slice(0, 240), closed(grid, 7.5, 0.1))
        statuses = set()
        while state.time < 120.0 and NavigationStatus.NO_PATH not in statuses:
            dx, dy, turn = rng.normal(0.0, (0.005, 0.005, 0.02)).tolist()
            x, y, yaw = state.pose.as_tuple()
            command = navigator.update((x + dx, y + dy, yaw + turn), state.twist, time=state.time)
            statuses.add(navigator.status)
            state = sim.step(command, navigator.dt)
    assert {NavigationStatus.BLOCKED, NavigationStatus.NO_PATH} <= statuses
    assert NavigationStatus.STUCK not in statuses


def test_where_the_planner_finds_a_path_that_cannot_be_driven_the_robot_is_stuck():
    class NeverOn:
        def set_path(self, path):
            pass

        def compute_velocity(self, pose, twist, costmap, dt):
            return Twist2D()

    navigator = Navigator(walled_room(), Robot.load("nova_carter"), controller=NeverOn())
    navigator.set_goal(10.5, 4.0)
    with simulate(World.from_map(walled_room()), navigator.robot, backend="kinematic") as sim:
        episode = run(sim, navigator, (3.0, 4.0, 0.0), (10.5, 4.0), time_limit_s=120.0)
    assert episode.outcome is Outcome.STUCK
    assert navigator.error is None
    assert episode.trajectory.time[-1] < 30.0


def blocked_after(commands, twist=None):
    """Indices of the commands that a watch at 20 Hz finds blocked; without a twist the robot follows its commands."""
    watch = BlockWatch(0.05)
    twists = [Twist2D(v, w) for v, w in commands]
    return [i for i, command in enumerate(twists) if watch.is_blocked(command, twist or command)]


def test_standing_and_swaying_are_blocks_after_half_a_second():
    assert blocked_after([(0.0, 0.0)] * 20) == [9, 19]
    assert blocked_after([(0.0, 0.1), (0.0, -0.1)] * 10) == [9, 19]
    assert blocked_after([(0.0, 0.1), (0.0, 0.0), (0.0, -0.05)] * 4) == [9]
    assert blocked_after([(0.05, 0.0), (-0.05, 0.0)] * 10) == [9, 19]


def test_driving_turning_on_and_coasting_are_none():
    assert blocked_after([(0.05, 0.0)] * 50) == []
    assert blocked_after([(0.0, 0.05)] * 50) == []
    assert blocked_after([(0.0, 0.0)] * 50, Twist2D(0.02, 0.0)) == []
    assert blocked_after([(0.0, 0.0)] * 50, Twist2D(0.0, -0.05)) == []
    assert blocked_after(([(0.0, 0.0)] * 9 + [(0.1, 0.0)]) * 5) == []
    # Braking, and driving off backwards: where the robot turns round it is where it was before.
    assert blocked_after([(0.1 * k, 0.0) for k in range(10, -10, -1)]) == []


@pytest.mark.parametrize("creeping", [(1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-3), (1e-4, -1e-3)])
def test_creeping_is_a_block_as_standing_is(creeping):
    assert blocked_after([creeping] * 20) == [9, 19]


@pytest.mark.parametrize("command", [(0.5, 0.0), (0.0, 0.5), (-0.5, 0.1)])
def test_a_robot_that_does_not_follow_its_commands_has_two_seconds(command):
    assert blocked_after([command] * 80, Twist2D()) == [39, 79]
    assert blocked_after([command] * 80, Twist2D(1e-4, 1e-3)) == [39, 79]


@pytest.mark.parametrize("creep", [0.0, 1e-4])
def test_a_controller_that_creeps_before_a_block_is_planned_again_like_one_that_stops(creep):
    class Creeping:
        """Does not drive the first path that it is given, and every other one."""

        def __init__(self, inner):
            self.inner, self.paths = inner, 0

        def set_path(self, path):
            self.paths += 1
            self.inner.set_path(path)

        def compute_velocity(self, pose, twist, costmap, dt):
            drives = self.paths > 1
            return self.inner.compute_velocity(pose, twist, costmap, dt) if drives else Twist2D(creep, 0.0)

    robot = Robot.load("nova_carter")
    controller = Creeping(create_controller("regulated_pure_pursuit", robot))
    navigator = Navigator(walled_room(), robot, controller=controller)
    with simulate(World.from_map(walled_room()), robot, backend="kinematic") as sim:
        episode = run(sim, navigator, (3.0, 4.0, 0.0), (6.0, 4.0), time_limit_s=60.0)
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.replans == 1
