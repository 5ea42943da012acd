"""The backend `batch`: its rows are those of `kinematic`, and it says what it does not drive."""

import json

import numpy as np
import pytest

import trundle
from trundle.errors import InputError
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.suite import Suite
from trundle.path import Path

TOLERANCE = 1e-6
"""Of figures in a row; on one machine they are equal bit for bit, as documented."""

SMALL = {"name": "warehouse", "options": {"size": [14, 11]}, "seed": 3}
OTHER = {"name": "cylinders", "seed": 1}
_OWN = ("id", "index", "backend", "handed_over")


def suite(**settings) -> Suite:
    return Suite.make(**{"worlds": [SMALL, OTHER], "backends": ["kinematic", "batch"], "missions": 4} | settings)


def blocked_by_walls(costmap, start, goal):
    return Path(np.array([start.as_tuple(), (goal.x, goal.y, start.yaw)]))


def assert_pairs_alike(chosen: Suite, *, exactly: bool = False) -> list[trundle.evaluation.Row]:
    task, handed = EpisodeTask(chosen), []
    for index in range(0, len(chosen), 2):
        kinematic, batch = task(index), task(index + 1)
        assert (kinematic.backend, batch.backend) == ("kinematic", "batch")
        for name, value in batch.unmeasured().items():
            if name in _OWN:
                continue
            other = getattr(kinematic, name)
            if isinstance(value, float) and not exactly:
                assert value == pytest.approx(other, abs=TOLERANCE), name
            else:
                assert list(value) == list(other) if name == "trail" else value == other, name
        handed.append(batch.handed_over)
    return handed


@pytest.mark.parametrize("ends", ["roomy", "tight"])
def test_rows_are_those_of_the_kinematic_simulator(ends):
    handed = assert_pairs_alike(suite(missions={"seeds": 3, "ends": ends}))
    assert handed.count("") >= len(handed) - 1


def test_rows_with_lidars_are_those_of_the_kinematic_simulator():
    handed = assert_pairs_alike(suite(lidar=True, missions=2))
    assert handed.count("") >= len(handed) - 1


def test_rows_of_mppi_are_those_of_the_kinematic_simulator():
    """24 missions of two worlds, equal bit for bit."""
    handed = assert_pairs_alike(suite(controllers=["mppi"], missions=12), exactly=True)
    assert handed.count("") >= 20


def test_rows_of_crossed_controllers_with_lidars_are_those_of_the_kinematic_simulator():
    chosen = suite(controllers=["mppi", "regulated_pure_pursuit"], lidar=True, missions=2)
    handed = assert_pairs_alike(chosen)
    assert len(handed) == 8
    assert handed.count("") >= 7


def test_the_navigator_may_be_named_as_agent_beside_the_controllers():
    chosen = suite(worlds=[SMALL], controllers=["mppi"], agents=["navigator"], missions=2)
    assert len(assert_pairs_alike(chosen, exactly=True)) == len(chosen) // 2


def test_a_row_is_the_same_whatever_was_driven_before():
    chosen = suite(backends=["batch"], missions=2, planners=["auto", "hybrid_astar"], inflation_radius=[0.5, 0.9])
    order = np.random.default_rng(0).permutation(len(chosen)).tolist()
    task = EpisodeTask(chosen)
    rows = {index: task(index).unmeasured() for index in order}
    for index in range(len(chosen)):
        assert EpisodeTask(chosen)(index).unmeasured() == rows[index]


def test_rows_of_missions_that_are_handed_over_are_alike_and_say_why():
    handed = assert_pairs_alike(suite(worlds=[SMALL], planners=[blocked_by_walls], missions=6))
    assert "blocked" in handed


def test_an_evaluation_counts_what_is_handed_over_and_resumes(tmp_path):
    chosen = suite(worlds=[SMALL], backends=["batch"], planners=["auto"], missions=5)
    with trundle.evaluate(chosen, workers=1, out=tmp_path / "out", time_budget_s=0.5) as first:
        done = len(first)
    with trundle.evaluate(chosen, workers=2, out=tmp_path / "out") as second:
        assert len(second) == 5 >= done
        summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["handed_over"] == {}
    assert summary["outcomes"] == {"arrived": 5}


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"agents": ["navigator", "explorer"]}, "agent"),
        ({"lidar": True, "known_map": False}, "known_map: false"),
        ({"replan_interval_s": 1.0}, "replan_interval_s"),
    ],
)
def test_a_suite_that_needs_more_is_refused_before_anything_runs(settings, named):
    with pytest.raises(InputError, match=f"this suite has {named}.*--backends kinematic"):
        suite(**settings).check()


def test_an_episode_of_the_batch_can_be_run_alone():
    task = EpisodeTask(suite(worlds=[SMALL], backends=["batch"], missions=1))
    with task.scenario_of(0).build() as mission:
        episode = mission.run()
    assert episode.metrics.time_s == pytest.approx(task(0).time_s, abs=TOLERANCE)
