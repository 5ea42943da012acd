"""Plug-ins that raise while the network drives: its goals are aborted, and the bridge ends with the error."""

import pytest

from ros2.navigator_role.conftest import QUICK_S
from trundle.geometry import Twist2D
from trundle.mission import Outcome
from trundle.planning import create_planner


class Planner:
    def __init__(self, at):
        self.at, self.calls, self.inner = at, 0, create_planner("auto")

    def plan(self, costmap, start, goal, **options):
        self.calls += 1
        if self.calls >= self.at:
            raise ValueError("no idea")
        return self.inner.plan(costmap, start, goal, **options)


class Controller:
    def __init__(self, at):
        self.at, self.calls = at, 0

    def reset(self, *, seed=0):
        pass

    def set_path(self, path):
        pass

    def set_speed_limit(self, limit):
        pass

    def compute_velocity(self, pose, twist, costmap, dt):
        self.calls += 1
        if self.calls >= self.at:
            raise ValueError("no idea")
        return Twist2D(0.1, 0.0)


@pytest.mark.parametrize(
    ("attribute", "plugin", "code"),
    [("planner", Planner(1), 200), ("controller", Controller(20), 100), ("controller", Controller(1), 100)],
)
def test_a_goal_is_aborted_with_a_code_and_the_bridge_ends(serve, client, attribute, plugin, code, monkeypatch):
    raised = []
    monkeypatch.setattr("threading.excepthook", lambda args: raised.append(args.exc_value))
    served = serve()
    setattr(served.bridge.mission.navigator, attribute, plugin)
    goal = client.go(1.5, 4.5)
    served._thread.join(QUICK_S)
    served.episode = served.bridge.context.session.finish()
    result = goal.wait()
    assert (goal.status, result.error_code) == ("aborted", code)
    assert f"{type(plugin).__name__} raised ValueError: no idea" in result.error_msg
    assert [str(error) for error in raised] == ["no idea"]
    assert (served.episode.outcome, served.episode.fault.plugin) == (Outcome.ERROR, type(plugin).__name__)
