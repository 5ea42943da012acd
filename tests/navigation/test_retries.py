"""How often a blocked robot tries again before it gives up, and how progress resets the count."""

import math

import numpy as np

from trundle.control import create_controller
from trundle.geometry import Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, run
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.progress import Retries
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

STAND, DRIVE = Twist2D(), Twist2D(0.5, 0.0)


def tries(left, *, retries=None):
    """How often it is tried again where the robot stands with each of these [m] of its path left, in turn."""
    retries = retries or Retries(0.05)
    done = []
    for left_m in left:
        retries.is_blocked(DRIVE, DRIVE, left_m)
        done.append(retries.try_again(left_m))
    return done


def test_six_times_at_one_place_then_no_more():
    assert tries([5.0] * 8) == [True] * 6 + [False] * 2
    assert tries([5.0, 5.2, 4.8, 5.3, 4.6, 5.0, 4.9]) == [True] * 6 + [False]


def test_half_a_metre_of_progress_resets_the_count():
    assert all(tries(np.arange(20.0, 0.0, -0.6)))
    assert tries([5.0] * 6 + [4.4] * 7) == [True] * 12 + [False]
    assert tries([5.0] * 6 + [4.6]) == [True] * 6 + [False]


def test_coming_back_to_where_it_was_does_not():
    # A longer detour after the third block, driven to where the robot was before.
    assert tries([5.0, 5.0, 5.0, 30.0, 20.0, 10.0, 5.0]) == [True] * 6 + [False]
    assert sum(tries([9.0, 3.0] * 20)) == 7


def test_a_new_goal_resets_the_count():
    retries = Retries(0.05)
    tries([5.0] * 7, retries=retries)
    retries.reset()
    assert tries([5.0] * 7, retries=retries) == [True] * 6 + [False]


class Interrupted:
    """A controller before which somebody steps at every metre of x, for a second."""

    def __init__(self, robot, places):
        self.inner, self.places, self.periods = create_controller("regulated_pure_pursuit", robot), list(places), 0

    def set_path(self, path):
        self.inner.set_path(path)

    def compute_velocity(self, pose, twist, costmap, dt):
        if self.places and pose.x > self.places[0]:
            self.places.pop(0)
            self.periods = 40
        self.periods -= 1
        return STAND if self.periods > 0 else self.inner.compute_velocity(pose, twist, costmap, dt)


def drive(places):
    grid = OccupancyGrid(np.zeros((120, 320), np.int8), 0.05)
    robot = Robot.load("nova_carter")
    navigator = Navigator(grid, robot, controller=Interrupted(robot, places))
    statuses = []

    class Watch:
        def on_start(self, info): ...

        def on_step(self, step):
            statuses.append(step.status)

        def on_end(self, episode): ...

    with simulate(World.from_map(grid), robot, backend="kinematic") as sim:
        episode = run(sim, navigator, (1.5, 3.0, 0.0), (14.5, 3.0), observers=[Watch()], time_limit_s=120.0)
    blocked = np.array([status is NavigationStatus.BLOCKED for status in statuses], dtype=int)
    return episode, int(np.count_nonzero(np.diff(blocked) == 1))


def test_a_robot_that_is_stopped_in_many_places_of_a_long_path_arrives():
    episode, blocks = drive(np.arange(2.5, 13.0, 1.0))
    assert episode.outcome is Outcome.ARRIVED
    assert blocks > 6


def test_one_that_is_stopped_for_good_gives_up():
    episode, blocks = drive([5.0] * 1000)
    assert episode.outcome is Outcome.STUCK
    assert 1 <= blocks <= 6
    assert math.isclose(episode.trajectory.x[-1], 5.0, abs_tol=1.0)
