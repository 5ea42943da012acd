"""A robot that stands closer to something than it is to keep gets away, and recovery obeys the same rule."""

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.control.collision import FOOTPRINT_PADDING_M
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Outcome, Scenario, run
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
REAR, FRONT = float(CARTER.outline[:, 0].min()), float(CARTER.outline[:, 0].max())


def room(*boxes):
    return walled_room(*boxes, width=10.0, depth=10.0)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
@pytest.mark.parametrize("goal", [(8.0, 5.0, 0.0), (8.0, 8.0, 1.5)])
def test_a_robot_whose_tail_is_next_to_a_corner_drives_away(backend, goal):
    grid = room((3.0, 5.0, 4.0, 6.0))
    start = Pose2D(4.0 - REAR + 0.0016, 5.0, 0.0)
    with simulate(World.from_map(grid), CARTER, backend=backend) as sim:
        episode = run(sim, Navigator(grid, CARTER), start, goal)
    assert episode.outcome is Outcome.ARRIVED
    assert not episode.metrics.contacts


class Standing:
    """A controller that never drives."""

    def set_path(self, path): ...

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D()


def back_up(grid, pose):
    """How far a robot drives back before something that its controller does not pass, and its clearances."""
    settings = NavigatorSettings(recovery=("replan", "back_up"))
    navigator = Navigator(grid, CARTER, controller=Standing(), settings=settings)
    navigator.set_goal(8.0, 5.0)
    start, twist, poses = pose, Twist2D(), [pose.as_tuple()]
    for _ in range(400):
        command = navigator.update(pose, twist)
        for _ in range(10):
            twist = CARTER.limits.approach(twist, command, navigator.dt / 10)
            pose = twist.integrate(pose, navigator.dt / 10)
        poses.append(pose.as_tuple())
        if navigator.status is NavigationStatus.STUCK:
            break
    return start.distance_to(pose), navigator.costmap.clearance(np.array(poses), cap=0.5)


def test_backing_up_keeps_the_padding_behind():
    gap = 0.1
    driven, clearances = back_up(room((3.0, 4.0, 4.0, 6.0)), Pose2D(4.0 - REAR + gap, 5.0, 0.0))
    assert 0.0 < driven < gap
    assert clearances.min() >= FOOTPRINT_PADDING_M - 1e-6


def test_it_stays_where_the_tail_is_within_the_padding():
    driven, clearances = back_up(room((3.0, 4.0, 4.0, 6.0)), Pose2D(4.0 - REAR + 0.004, 5.0, 0.0))
    assert driven == 0.0
    assert clearances.min() == pytest.approx(0.004, abs=1e-6)


def test_it_backs_up_where_the_nose_is():
    driven, clearances = back_up(room((6.0, 4.0, 7.0, 6.0)), Pose2D(6.0 - FRONT - 0.004, 5.0, 0.0))
    assert driven > 0.25
    assert np.all(np.diff(clearances) >= -1e-6)


class Closing:
    """Closes the aisle before the robot once it is well inside."""

    def __init__(self, navigator):
        self.navigator, self.closed, self.planners, self.backed = navigator, False, [], 0.0

    def on_start(self, info): ...

    def on_step(self, step):
        if step.path is not None and (not self.planners or step.path.planner != self.planners[-1]):
            self.planners.append(step.path.planner)
        self.backed += min(0.0, step.state.twist.v) * self.navigator.dt
        if not self.closed and step.state.pose.x > 4.0:
            self.navigator.static_costmap = self.navigator.static_costmap.update(slice(90, 110), slice(104, 106), 100)
            self.closed = True

    def on_end(self, episode): ...


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_it_reverses_out_of_an_aisle_that_is_closed_before_it(backend):
    # It is 0.9 m wide and 2.5 m long; the only other path leads round the upper block.
    grid = room((3.0, 0.0, 5.5, 4.55), (3.0, 5.45, 5.5, 8.5))
    navigator = Navigator(grid, CARTER)
    closing = Closing(navigator)
    with simulate(World.from_map(grid), CARTER, backend=backend) as sim:
        episode = run(sim, navigator, (1.2, 5.0, 0.0), (8.5, 5.0, 0.0), observers=[closing])
    assert episode.outcome is Outcome.ARRIVED
    assert closing.closed
    assert closing.planners[:2] == ["least_cost", "hybrid_astar"]
    assert closing.backed < -0.5
    assert not navigator.costmap.footprint_collides(episode.trajectory.poses).any()


@pytest.mark.parametrize(
    ("world", "start", "goal", "seed"),
    [
        ("office", (4.3075, -1.774, -0.1695), (-5.7501, -5.8738, -1.0592), 22),  # 83 m to and fro
        ("office", (8.6321, 2.7494, 1.8474), (0.3327, -0.5168, 2.9141), 239),  # arrived backwards, without room to turn
        ("warehouse", (8.2872, 6.9486, 0.1153), (0.4454, 6.7589, -1.1098), 13),  # 65 m to and fro
    ],
)
def test_mppi_drives_between_tight_ends_that_it_did_not(world, start, goal, seed):
    scenario = Scenario(world={"name": world, "seed": 3}, start=start, goal=goal, controller="mppi", seed=seed)
    with scenario.build() as mission:
        episode = mission.run()
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.distance_m < 2.0 * episode.metrics.path_length_m
