"""Missions of `mppi` in batches against the same ones step by step in Python, and what one that fails costs."""

import numpy as np
import pytest

from support.batch_missions import SMALL, assert_alike, in_kernel, in_python, scenario, wall
from trundle.control import CollisionMonitor
from trundle.control.mppi import MppiController
from trundle.costmap.layers import LayeredCostmap
from trundle.mission import Outcome, sample_tight_ends
from trundle.mission.batch.missions import BatchMission, HandedOver, MissionBatch
from trundle.mission.metrics import measure_truth
from trundle.path import Path

OFFICE = {"name": "office", "seed": 1}


def sampled(**settings):
    return scenario(**{"controller": "mppi"} | settings)


def assert_equal(chosen) -> None:
    """Equal bit for bit: the same controller is asked, at the same poses."""
    found, driven = in_kernel(chosen), in_python(chosen)
    assert_alike(found, driven)
    assert np.array_equal(found.trajectory.poses, driven.trajectory.poses)
    assert found.metrics.monitor_stops == driven.metrics.monitor_stops
    assert driven.outcome in (Outcome.ARRIVED, Outcome.TIMED_OUT)


@pytest.mark.parametrize(
    "settings",
    [
        {"world": OFFICE, "robot": "turtlebot3_burger", "time_limit_s": 8.0},
        {"controller": {"name": "mppi", "options": {"samples": 300, "vx_max": 0.5}}},
        {"control_frequency": 10.0, "robot": "jackal"},
        {"time_limit_s": 3.0},
        {"seed": 5, "goal_tolerance": 0.05, "planner": "hybrid_astar"},
    ],
    ids=("robot", "options", "period", "time limit", "tolerance"),
)
def test_a_mission_of_mppi_is_the_one_of_python(settings):
    assert_equal(sampled(**{"seed": 2} | settings))


def test_missions_between_tight_ends_are_alike():
    prepared = sampled(seed=1).prepare()
    start, goal = sample_tight_ends(prepared.navigator.costmap, 1)
    assert_equal(sampled(seed=1, start=start.as_tuple(), goal=goal.as_tuple()))


@pytest.mark.parametrize(
    "settings",
    [
        {"world": OFFICE},
        {},
        {"world": OFFICE, "robot": "turtlebot3_burger", "time_limit_s": 8.0},
        {"layers": {"obstacle": None}, "collision_monitor": False},
        {"unmapped": {"boxes": 1, "near_path": 0.0}, "seed": 3},
    ],
    ids=("map as it is", "unknown cells", "noise", "no layers", "boxes"),
)
def test_a_sensed_mission_of_mppi_is_the_one_of_python(settings):
    assert_equal(sampled(**{"seed": 2, "lidar": True} | settings))


def test_layers_are_left_out_only_where_they_change_nothing(monkeypatch):
    taken = []
    take = LayeredCostmap.take
    monkeypatch.setattr(LayeredCostmap, "take", lambda *given: taken.append(1) or take(*given))
    in_kernel(sampled(world=OFFICE, lidar=True, time_limit_s=2.0))
    assert not taken
    in_kernel(sampled(world=OFFICE, lidar=True, time_limit_s=2.0, robot="turtlebot3_burger"))
    assert taken


def through_the_wall(costmap, start, goal):
    return Path(np.array([(1.0, 2.0, 0.0), (5.0, 2.0, 0.0)]))


def test_a_robot_that_is_blocked_is_handed_over(tmp_path):
    wall(False).save(tmp_path / "map.yaml")
    ends = {"start": (1.0, 2.0, 0.0), "goal": (5.0, 2.0)}
    chosen = sampled(world=None, map=str(tmp_path / "map.yaml"), planner=through_the_wall, **ends)
    assert in_kernel(chosen) == HandedOver("blocked")


def fail_once(method, number: int):
    """A method that raises in one of its calls."""
    calls = iter(range(1_000_000))

    def call(*given, **named):
        if next(calls) == number:
            raise RuntimeError("no idea")
        return method(*given, **named)

    return call


def test_boxes_near_the_path_are_handed_over_before_it_drives(monkeypatch):
    monkeypatch.setattr(MppiController, "compute_velocity", fail_once(MppiController.compute_velocity, 0))
    found = in_kernel(sampled(lidar=True, seed=2, unmapped={"boxes": 6, "near_path": 1.0}))
    assert found == HandedOver("an unmapped box near the path")


@pytest.mark.parametrize(
    ("owner", "name", "settings"),
    [
        (MppiController, "compute_velocity", {"controller": "mppi"}),
        (CollisionMonitor, "check", {"lidar": True}),
    ],
    ids=("controller", "monitor"),
)
def test_what_is_raised_in_the_middle_of_one_mission_costs_no_other(monkeypatch, owner, name, settings):
    chosen = [scenario(world=SMALL, seed=2, time_limit_s=3.0, **settings) for _ in range(3)]
    periods = len(in_kernel(chosen[0]).trajectory)
    monkeypatch.setattr(owner, name, fail_once(getattr(owner, name), periods + 10))
    ends = MissionBatch().drive([BatchMission(each.prepare()) for each in chosen])
    assert ends[1] == HandedOver("RuntimeError while it drives")
    assert [ends[0].outcome, ends[2].outcome] == [Outcome.TIMED_OUT] * 2
    assert np.array_equal(ends[0].trajectory.poses, ends[2].trajectory.poses)


def test_figures_that_cannot_be_measured_cost_no_other_mission():
    settings = [scenario(seed=2).prepare() for _ in range(3)]
    missions = [
        BatchMission(each, fail_once(measure_truth, 0) if k == 1 else measure_truth) for k, each in enumerate(settings)
    ]
    ends = MissionBatch().drive(missions)
    assert ends[1] == HandedOver("RuntimeError while it drives")
    assert [ends[0].outcome, ends[2].outcome] == [Outcome.ARRIVED] * 2


def test_missions_of_several_controllers_and_periods_in_one_batch_are_those_of_each_alone():
    chosen = [
        sampled(seed=2),
        scenario(seed=2),
        sampled(seed=2, control_frequency=30.0),  # no multiple of the simulator's step
        sampled(world=OFFICE, seed=3, lidar=True),
        scenario(world=OFFICE, seed=3, lidar=True),
    ]
    ends = MissionBatch(threads=2).drive([BatchMission(each.prepare(), measure_truth) for each in chosen])
    assert isinstance(ends.pop(2), HandedOver)
    del chosen[2]
    for each, end in zip(chosen, ends, strict=True):
        assert np.array_equal(end.trajectory.poses, in_kernel(each).trajectory.poses)
