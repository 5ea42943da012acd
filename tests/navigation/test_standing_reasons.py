"""Why a controller makes no progress: counted and shown by the navigator; and the samples that observers get."""

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import NoValidControlError
from trundle.geometry import Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Episode, Session, run
from trundle.navigation import Choice, Navigator
from trundle.record import RunFolder
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
ROOM = OccupancyGrid(np.zeros((120, 160), np.int8), 0.05)


class Standing:
    """Stands, and says why; or finds no control."""

    reason = ""

    def set_path(self, path):
        pass

    def reset(self, *, seed=0):
        pass

    def set_speed_limit(self, limit):
        pass

    def compute_velocity(self, pose, twist, costmap, dt):
        if self.reason == "raise":
            raise NoValidControlError("no valid control")
        return Twist2D()


def test_reasons_are_counted_and_shown_until_there_is_another_goal():
    controller = Standing()
    navigator = Navigator(Costmap.from_grid(ROOM, CARTER), CARTER, controller=controller)
    navigator.set_goal(5.0, 3.0)
    navigator.update((2.0, 3.0, 0.0), Twist2D())
    assert (navigator.standing_reasons, navigator.message) == ({}, "")
    controller.reason = "blocked by a mover"
    for _ in range(3):
        navigator.update((2.0, 3.0, 0.0), Twist2D())
    assert navigator.message == "blocked by a mover"
    assert navigator.standing_reasons == {"blocked by a mover": 3}
    navigator.set_goal(6.0, 3.0)
    assert navigator.standing_reasons == {}


def test_a_controller_without_reasons_that_finds_no_control_has_one():
    class Silent(Standing):
        def compute_velocity(self, pose, twist, costmap, dt):
            raise NoValidControlError("no valid control")

    navigator = Navigator(Costmap.from_grid(ROOM, CARTER), CARTER, controller=Silent())
    navigator.set_goal(5.0, 3.0)
    navigator.update((2.0, 3.0, 0.0), Twist2D())
    assert navigator.standing_reasons == {"no valid control": 1}


class Indecisive(Standing):
    """Stands for reasons, and drives to x = 2.25 m where there is none left."""

    def __init__(self, *reasons):
        self.reasons = list(reasons)

    def compute_velocity(self, pose, twist, costmap, dt):
        self.reason = self.reasons.pop(0) if self.reasons else ""
        return Twist2D(0.3, 0.0) if not self.reason and pose.x < 2.25 else Twist2D()


def test_a_run_records_the_reasons_over_all_goals_the_most_frequent_first(tmp_path):
    controller = Indecisive("the path is blocked", "blocked by a mover", "blocked by a mover")
    navigator = Navigator(ROOM, CARTER, controller=controller)
    record = RunFolder(tmp_path / "run", video=False)
    with (
        record,
        simulate(World.from_map(ROOM), CARTER, backend="kinematic") as sim,
        Session(sim, navigator, (2.0, 3.0, 0.0), [(2.3, 3.0), (5.0, 3.0)], observers=[record]) as session,
    ):
        while (step := session.step()) is not None and step.goal == 0:
            assert step.index < 200
        controller.reasons = ["no free sample"]
        assert session.step() is not None
        episode = session.finish()
    counted = {"blocked by a mover": 2, "the path is blocked": 1, "no free sample": 1}
    assert list(episode.metrics.standing_reasons.items()) == list(counted.items())
    again = Episode.load(tmp_path / "run").metrics
    assert list(again.standing_reasons.items()) == list(counted.items())


@pytest.mark.parametrize("wanted", [True, False])
def test_observers_that_want_them_get_the_best_samples(wanted):
    shown = []

    class Watch:
        wants_rollouts = wanted

        def on_start(self, start):
            pass

        def on_step(self, step):
            shown.append(step.rollouts)

        def on_end(self, episode):
            pass

    for controller in (Choice(name="mppi", options={"samples": 128}), Choice.of("regulated_pure_pursuit")):
        navigator = Navigator(ROOM, CARTER, controller=controller)
        with simulate(World.from_map(ROOM), CARTER, backend="kinematic") as sim:
            run(sim, navigator, (2.0, 3.0, 0.0), (5.0, 3.0), observers=[Watch()], time_limit_s=0.2)
    assert shown[-1] is None
    assert (shown[1] is not None) == wanted
    if wanted:
        assert shown[1].poses.shape == (30, 57, 3)


def test_a_step_has_the_best_samples():
    navigator = Navigator(ROOM, CARTER, controller=Choice(name="mppi", options={"samples": 128}))
    with (
        simulate(World.from_map(ROOM), CARTER, backend="kinematic") as sim,
        Session(sim, navigator, (2.0, 3.0, 0.0), (5.0, 3.0)) as session,
    ):
        assert session.step().rollouts.poses.shape == (30, 57, 3)
