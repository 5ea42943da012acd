import math

import numpy as np
import pytest

from trundle.control import Rollouts, create_controller
from trundle.errors import TrundleError
from trundle.geometry import Twist2D
from trundle.robots import Robot
from trundle.testing import ConformanceError, check_controller


@pytest.mark.parametrize("name", ["regulated_pure_pursuit", "lookahead"])
@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_burger"])
def test_our_controllers_keep_their_promises(name, robot):
    check_controller(lambda driven: create_controller(name, driven), robot=Robot.load(robot))


class Standing:
    def __init__(self, robot):
        self.robot = robot
        self.path = None

    def set_path(self, path):
        self.path = path

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D()


class Restless(Standing):
    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D(0.1, 0.0)


class Speeding(Standing):
    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D() if self.path is None else Twist2D(100.0, 0.0)


class Vandal(Standing):
    def compute_velocity(self, pose, twist, costmap, dt):
        if self.path is not None:
            costmap.data.flags.writeable = True
            costmap.data[0, 0] = 200
            pose_x = self.path.goal.x - pose.x
            return Twist2D(np.clip(pose_x, -0.2, 0.2) if abs(pose_x) > 0.01 else 0.0, 0.0)
        return Twist2D()


class WithoutLimit:
    """A good controller, of before there were speed limits."""

    def __init__(self, robot):
        self.inner = create_controller("regulated_pure_pursuit", robot)
        self.set_path, self.compute_velocity = self.inner.set_path, self.inner.compute_velocity


class HalfLimited(WithoutLimit):
    """Slows down for a limit, and drives faster than it."""

    def set_speed_limit(self, limit):
        self.inner.set_speed_limit(1.5 * limit)


class NeverFree(WithoutLimit):
    """Keeps the lowest limit for ever."""

    limit = math.inf

    def set_speed_limit(self, limit):
        self.limit = min(limit, self.limit)
        self.inner.set_speed_limit(self.limit)


class Stopped(WithoutLimit):
    """Does not drive at all where there is a limit."""

    def set_speed_limit(self, limit):
        self.inner.set_speed_limit(math.inf if limit == math.inf else 0.0)


class WithoutReset(WithoutLimit):
    """A good controller, of before there was a reset."""

    def set_speed_limit(self, limit):
        self.inner.set_speed_limit(limit)


class KeepsLimit(WithoutReset):
    """Drives slower after a reset."""

    def reset(self, *, seed=0):
        self.inner.set_speed_limit(0.1)


class Crashing(WithoutReset):
    """Raises an error of its own where it is blocked."""

    def __init__(self, robot):
        super().__init__(robot)
        self.reset = self.inner.reset
        self.compute_velocity = self.compute

    def compute(self, *arguments):
        try:
            return self.inner.compute_velocity(*arguments)
        except TrundleError:
            raise RuntimeError("nothing to do") from None


class Timid(WithoutReset):
    """Stops as soon as it is told of what moves, though nothing does."""

    def __init__(self, robot):
        super().__init__(robot)
        self.compute_velocity = self.compute
        self.told = False

    def set_tracks(self, tracks):
        self.told = True

    def compute(self, *arguments):
        return Twist2D() if self.told else self.inner.compute_velocity(*arguments)


class Mute(WithoutReset):
    """Says why it stands with a number."""

    reason = 7


class Unsorted(WithoutReset):
    """Returns its samples with the worst first."""

    def rollouts(self):
        return Rollouts(np.zeros((2, 3, 3)), np.array([2.0, 1.0]))


class Undecided(WithoutReset):
    """Means to command something else than an intent."""

    intent = ((0.1, 0.0),)


@pytest.mark.parametrize("controller", [WithoutLimit, WithoutReset])
def test_a_controller_needs_no_more_than_it_must_have(controller):
    check_controller(controller)


@pytest.mark.parametrize(
    ("broken", "promise"),
    [
        (Standing, "must stop within 0.25 m"),
        (Restless, "without a path must command zero"),
        (Speeding, "within the speed limits"),
        (Vandal, "must not modify the costmap"),
        (HalfLimited, "must obey or ignore a speed limit"),
        (NeverFree, "speed limit is removed"),
        (Stopped, "it stopped"),
        (KeepsLimit, "same after a reset"),
        (Timid, "must act the same where the latency is zero"),
        (Mute, "reason must be a text"),
        (Unsorted, "the lowest cost first"),
        (Undecided, "intent must be an Intent"),
        (Crashing, "must raise NoValidControlError"),
    ],
)
def test_a_controller_that_breaks_a_promise_learns_which(broken, promise):
    with pytest.raises(ConformanceError, match=promise):
        check_controller(broken)
