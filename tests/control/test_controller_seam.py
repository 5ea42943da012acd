"""Controllers of other packages behind the seam, as they are and through the adapter."""

import copy
import math

import numpy as np
import pytest

from trundle.control import Controller, Intent, Rollouts, controller_names, create_controller
from trundle.control.controller import ControllerAdapter
from trundle.control.latency import Latency
from trundle.errors import NoValidControlError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.navigation import NavigationStatus, Navigator
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")


class Older:
    """Without set_speed_limit."""

    def set_path(self, path):
        self.path = path

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D(0.6, 0.3)


class WithReset(Older):
    """Without set_speed_limit, but with reset."""

    seeds = ()

    def reset(self, *, seed=0):
        self.seeds = (*self.seeds, seed)


class Raising(Older):
    """Never finds a command."""

    def compute_velocity(self, pose, twist, costmap, dt):
        raise NoValidControlError("no valid control")


class Outspoken(Older):
    """With everything that a controller may have."""

    def __init__(self):
        self.got = []
        self.intent = Intent(np.zeros((2, 2)), 0.1)
        self.reason = "no free sample"

    def set_latency(self, latency):
        self.got.append(latency)

    def set_tracks(self, tracks):
        self.got.append(tracks)

    def set_through(self, marks, tolerance):
        self.got.append((marks, tolerance))

    def rollouts(self):
        return Rollouts(np.zeros((1, 2, 3)), np.zeros(1))


class Wrapper:
    """Hands on whatever it is asked."""

    def __init__(self, inner):
        self._inner = inner

    def __getattr__(self, name):
        return getattr(self._inner, name)


def limited(controller):
    """What a navigator with a limit of 0.2 m/s tells the robot first."""
    mask = SpeedMask(OccupancyGrid(np.full((4, 6), 20, np.int8), 1.0), "absolute", multiplier=0.01)
    grid = OccupancyGrid(np.zeros((80, 120), np.int8), 0.05)
    navigator = Navigator(grid, CARTER, controller=controller, speed_mask=mask)
    navigator.set_goal(5.0, 2.0)
    return navigator.update((2.0, 2.0, 0.0), Twist2D(0.2, 0.0))


@pytest.mark.parametrize("name", controller_names())
def test_our_controllers_need_no_adapter(name):
    controller = create_controller(name, CARTER)
    assert not isinstance(controller, ControllerAdapter)
    assert isinstance(controller, Controller)
    controller.set_speed_limit(math.inf)


@pytest.mark.parametrize("name", controller_names())
def test_our_controllers_can_be_copied(name):
    controller = create_controller(name, CARTER)
    assert type(copy.deepcopy(controller)) is type(controller)


def test_an_older_controller_works_behind_the_whole_seam():
    older = Older()
    controller = create_controller(older, CARTER)
    assert isinstance(controller, ControllerAdapter)
    assert isinstance(controller, Controller)
    assert controller.controller is older
    command = limited(older)
    assert (command.v, command.w) == pytest.approx((0.2, 0.1))
    assert older.path.goal.distance_to(Pose2D(5.0, 2.0)) < 1e-6


def say_everything(controller):
    controller.set_latency(Latency(command_delay_s=0.1))
    controller.set_tracks(())
    controller.set_through((1.0, 2.0), 0.25)
    return controller.intent, controller.reason, controller.rollouts()


def test_the_optional_members_of_a_controller_are_handed_on():
    outspoken = Outspoken()
    intent, reason, rollouts = say_everything(create_controller(outspoken, CARTER))
    assert outspoken.got == [Latency(command_delay_s=0.1), (), ((1.0, 2.0), 0.25)]
    assert (intent, reason) == (outspoken.intent, "no free sample")
    assert rollouts.poses.shape == (1, 2, 3)


def no_command(pose, twist, costmap, dt, path):
    return Twist2D()


@pytest.mark.parametrize("least", [Older(), no_command, "regulated_pure_pursuit", "lookahead"])
def test_what_a_controller_lacks_has_the_default(least):
    assert say_everything(create_controller(least, CARTER)) == (None, "", None)


def test_an_intent_may_come_with_the_first_command():
    late = Older()
    controller = create_controller(late, CARTER)
    late.intent, late.reason = Intent(np.zeros((2, 2)), 0.1), "waiting"
    assert (controller.intent, controller.reason) == (late.intent, "waiting")


def test_a_wrapper_hands_the_limit_on():
    inner = create_controller("regulated_pure_pursuit", CARTER)
    wrapper = Wrapper(inner)
    assert create_controller(wrapper, CARTER).controller is wrapper
    assert limited(wrapper).v == pytest.approx(0.2)


def test_a_class_that_derives_from_the_seam_has_the_default():
    class Derived(Older, Controller):
        pass

    derived = Derived()
    assert create_controller(derived, CARTER).controller is derived
    assert limited(derived).v == pytest.approx(0.2)


def test_an_older_controller_keeps_the_reset_that_it_has():
    older = WithReset()
    create_controller(older, CARTER).reset(seed=3)
    assert older.seeds == (3,)
    create_controller(Older(), CARTER).reset(seed=3)


def test_a_navigator_resets_its_controller_with_the_seed():
    older = WithReset()
    navigator = Navigator(OccupancyGrid(np.zeros((80, 120), np.int8), 0.05), CARTER, controller=older)
    navigator.reset(seed=7)
    assert older.seeds[-1] == 7


def statuses(controller, seconds=1.0):
    grid = OccupancyGrid(np.zeros((80, 120), np.int8), 0.05)
    navigator = Navigator(grid, CARTER, controller=controller)
    navigator.set_goal(5.0, 2.0)
    seen = []
    for _ in range(round(seconds / navigator.dt)):
        navigator.update((2.0, 2.0, 0.0), Twist2D())
        seen.append(navigator.status)
    return seen


def test_no_valid_control_counts_as_blocked_as_zero_does():
    class Standing(Older):
        def compute_velocity(self, pose, twist, costmap, dt):
            return Twist2D()

    raised = statuses(Raising())
    assert NavigationStatus.BLOCKED in raised
    assert raised == statuses(Standing())
