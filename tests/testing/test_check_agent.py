import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Agent, AgentReport, CommandScript, NavigationStatus, Navigator
from trundle.path import Path
from trundle.testing import ConformanceError, check_agent

ROOM = OccupancyGrid(np.zeros((160, 160), dtype=np.int8), 0.05, Pose2D(-4.0, -4.0))


def test_our_agents_keep_their_promises():
    check_agent(lambda robot: Navigator(ROOM, robot))
    check_agent(lambda robot: CommandScript([(0.3, 0.0, 2.0), (0.0, 0.5, 1.02)]))


class Standing:
    status = NavigationStatus.DRIVING

    def reset(self, *, seed=0):
        pass

    def set_goal(self, goal):
        pass

    def update(self, observation, estimate):
        return Twist2D()


class Restless(Standing):
    def update(self, observation, estimate):
        self.status = NavigationStatus.STUCK
        return Twist2D(0.1, 0.0)


class Liar(Standing):
    def update(self, observation, estimate):
        self.status = NavigationStatus.ARRIVED
        return Twist2D()


class Bare(Standing):
    def update(self, observation, estimate):
        return (0.1, 0.0)


class Counting(Standing):
    """Its commands depend on how often it was used before."""

    count = 0

    def update(self, observation, estimate):
        self.count += 1
        return Twist2D(1e-6 * self.count, 0.0)


class Shared(Standing):
    count = 0

    def update(self, observation, estimate):
        Shared.count += 1
        return Twist2D(1e-6 * Shared.count, 0.0)


class Vandal(Standing):
    def update(self, observation, estimate):
        for scan in observation.scans:
            scan.ranges.flags.writeable = True
            scan.ranges[:] = 0.0
        return Twist2D()


class Frozen(Standing):
    dt = 0.0


@pytest.mark.parametrize(
    ("agent", "message"),
    [
        (object, r"reset\(\*, seed\), set_goal\(goal\), update\(observation, estimate\) and status"),
        (Restless, "must command zero"),
        (Liar, "must be at the goal"),
        (Bare, "must command a Twist2D"),
        (Counting, "as new after a reset"),
        (Shared, "the same from the same observations"),
        (Vandal, "must not modify the scans"),
        (Frozen, "control period"),
    ],
)
def test_broken_agents_are_found(agent, message):
    with pytest.raises(ConformanceError, match=message):
        check_agent(lambda robot: agent())


class Whole(Standing, Agent):
    """Derives from the base class, and overrides nothing that has a default."""


class Nameless(Whole):
    def info(self):
        return "nameless"


class Silent(Whole):
    def report(self, *, rollouts=False):
        return None


class TwoFaced(Whole):
    def report(self, *, rollouts=False):
        return AgentReport(NavigationStatus.ARRIVED)


class Lost(Whole):
    plans = True

    def plan(self, start, /):
        return Path([(0.0, 0.0, 0.0), (-3.0, 0.0, 0.0)])


class Shy(Whole):
    def plan(self, start, /):
        return Path([(0.0, 0.0, 0.0), (2.0, 1.0, 0.0)])


class Loose(Whole):
    def assist_teleop(self, command, observation, estimate):
        return command


@pytest.mark.parametrize(
    ("agent", "message"),
    [
        (Nameless, "must return an AgentInfo"),
        (Silent, "must return an AgentReport"),
        (TwoFaced, "must report its status"),
        (Lost, "must lead to its goal"),
        (Shy, "must say so by its attribute plans"),
        (Loose, "must return an AssistedCommand"),
    ],
)
def test_broken_optional_members_are_found(agent, message):
    check_agent(lambda robot: Whole())
    with pytest.raises(ConformanceError, match=message):
        check_agent(lambda robot: agent())


def test_an_agent_that_only_waits_is_allowed():
    check_agent(lambda robot: Standing())
