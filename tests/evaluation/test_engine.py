import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from support.faulty_planner import CRASH, HANG, LEAK, RAISE, FaultyPlanner
from trundle.errors import InputError, OutputError
from trundle.evaluation import Evaluation, Suite, evaluate
from trundle.evaluation.engine import InterruptedEvaluationError, run_suite

STARTS = [0.8, CRASH, HANG, LEAK, RAISE, 0.9, 1.1, 1.2]


@pytest.fixture
def room_map(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    return str(tmp_path / "room.yaml")


def listed(starts):
    return [{"start": (x, 4.6, 0.0), "goal": (6.5, 4.6)} for x in starts]


def unmeasured(folder):
    return [row.unmeasured() for row in Evaluation(folder).rows()]


def test_rows_are_the_same_for_any_number_of_workers(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], planners=["auto", "astar"], backends=["kinematic", "mujoco"], seeds=2)
    for workers in (1, 3):
        evaluate(suite, workers=workers, out=tmp_path / f"with_{workers}")
    rows = unmeasured(tmp_path / "with_1")
    assert len(rows) == len(suite) == 8
    assert rows == unmeasured(tmp_path / "with_3")
    assert {row["outcome"] for row in rows} == {"arrived"}


@pytest.mark.slow
def test_a_planner_that_crashes_hangs_leaks_or_raises_costs_only_its_own_episodes(room_map, tmp_path):
    limits = {"wall_s": 4.0, "memory_mb": 600.0}
    settings = {"worlds": [room_map], "backends": "kinematic", "limits": limits, "missions": listed(STARTS)}
    evaluation = evaluate({**settings, "planners": FaultyPlanner}, workers=2, out=tmp_path / "faulty")
    rows = list(evaluation.rows())
    expected = {CRASH: "crashed", HANG: "hung", LEAK: "out_of_memory", RAISE: "error"}
    assert {row.start_x: row.outcome for row in rows} == {x: expected.get(x, "arrived") for x in STARTS}
    for row in rows:
        if row.outcome != "arrived":
            assert "faulty_planner.py" in row.error, row
            assert row.mission
    untouched = evaluate({**settings, "planners": "astar"}, workers=1, out=tmp_path / "sound")
    by_mission = {row.mission: row for row in untouched.rows()}
    for row in rows:
        if row.outcome == "arrived":
            assert row.trail == by_mission[row.mission].trail
            assert row.time_s == by_mission[row.mission].time_s


@pytest.mark.slow
def test_an_evaluation_that_was_interrupted_is_continued(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], backends="kinematic", seeds=8)

    def stop(progress):
        if progress.done == 3:
            raise KeyboardInterrupt

    with pytest.raises(InterruptedEvaluationError, match=r"3 of 8 episodes; to continue, .* -o "):
        run_suite(suite, tmp_path / "stopped", workers=1, on_progress=stop)
    assert len(Evaluation(tmp_path / "stopped")) == 3
    seen = []
    run_suite(suite, tmp_path / "stopped", workers=1, on_progress=lambda progress: seen.append(progress.done))
    assert seen == [3, 4, 5, 6, 7, 8]
    run_suite(suite, tmp_path / "whole", workers=2)
    assert unmeasured(tmp_path / "stopped") == unmeasured(tmp_path / "whole")


@pytest.mark.slow
def test_a_changed_suite_keeps_the_rows_that_still_hold(room_map, tmp_path):
    settings = {"name": "same", "worlds": [room_map], "backends": "kinematic"}
    run_suite(Suite.make(**settings, planners=["auto", "astar"], seeds=2), tmp_path / "out", workers=1)
    seen = []
    changed = Suite.make(**settings, planners=["astar", "any_angle"], seeds=3)
    run_suite(changed, tmp_path / "out", workers=1, on_progress=lambda progress: seen.append(progress.done))
    assert seen[0] == 2
    run_suite(changed, tmp_path / "fresh", workers=1)
    assert unmeasured(tmp_path / "out") == unmeasured(tmp_path / "fresh")


DRIVER = """
import sys
from trundle.evaluation.engine import run_suite
from trundle.evaluation import Suite
run_suite(Suite.load(sys.argv[1]), sys.argv[2], workers=2)
"""


@pytest.mark.slow
def test_rows_after_killed_drivers_are_those_of_an_uninterrupted_run(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], backends="kinematic", planners=["auto", "astar"], seeds=10)
    suite.save(tmp_path / "suite.yaml")
    journal = tmp_path / "killed" / "journal.jsonl"
    command = [sys.executable, "-c", DRIVER, str(tmp_path / "suite.yaml"), str(tmp_path / "killed")]
    for rows in (2, 9):
        driver = subprocess.Popen(command)
        while driver.poll() is None and not (journal.exists() and journal.read_bytes().count(b"\n") >= rows):
            time.sleep(0.02)
        driver.send_signal(signal.SIGKILL)
        driver.wait()
    subprocess.run(command, check=True, timeout=120)
    run_suite(suite, tmp_path / "whole", workers=2)
    assert unmeasured(tmp_path / "killed") == unmeasured(tmp_path / "whole")


def test_what_cannot_be_set_up_is_refused_after_two_tries(room_map, tmp_path, monkeypatch):
    monkeypatch.setenv("PLANTED_TRIES", str(tmp_path / "tries"))
    monkeypatch.setenv("PLANTED_DRIVER", str(os.getpid()))
    suite = Suite.make(worlds=[room_map], backends="kinematic", planners=UnpreparedPlanner, seeds=6)
    evaluation = evaluate(suite, workers=1, out=tmp_path / "out")
    rows = list(evaluation.rows())
    assert [row.outcome for row in rows] == ["error"] * 6
    assert len({row.error for row in rows}) == 1
    assert (tmp_path / "tries").read_text() in ("..", "...")  # the worker draws one while the second failure is read


class UnpreparedPlanner:
    """Can be made in the process that checks the suite, and in no other."""

    def __init__(self):
        if os.environ.setdefault("PLANTED_DRIVER", str(os.getpid())) != str(os.getpid()):
            with open(os.environ["PLANTED_TRIES"], "a") as tries:  # noqa: PTH123
                tries.write(".")
            raise RuntimeError("planted in set-up")

    def plan(self, costmap, start, goal):
        raise NotImplementedError


def test_two_evaluations_cannot_use_one_folder(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], backends="kinematic", seeds=2)

    def start_another(progress):
        if progress.done == 1:
            run_suite(suite, tmp_path / "out", workers=1)

    with pytest.raises(OutputError, match="writing into"):
        run_suite(suite, tmp_path / "out", workers=1, on_progress=start_another)


def test_a_map_that_is_gone_is_named_before_anything_runs(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], backends="kinematic", seeds=2)
    suite.save(tmp_path / "suite.yaml")
    run_suite(suite, tmp_path / "out", workers=1)
    (tmp_path / "room.yaml").unlink()
    with pytest.raises(InputError, match=r"room\.yaml"):
        run_suite(Suite.load(tmp_path / "suite.yaml"), tmp_path / "out", workers=1)
    assert len(Evaluation(tmp_path / "out")) == 2


def test_an_evaluation_answers_by_rows_frames_and_sql(room_map, tmp_path):
    suite = Suite.make(
        worlds=[room_map], backends="kinematic", planners=["auto", "astar"], seeds=3, require="success>=0.2"
    )
    evaluation = evaluate(suite, workers=2, out=tmp_path / "out")
    assert repr(evaluation).endswith("6 of 6 episodes, 6 arrived)")
    frame = evaluation.to_pandas()
    assert list(frame["planner"]) == ["auto", "astar"] * 3
    counts = evaluation.query("SELECT planner, count(*) AS n FROM episodes GROUP BY planner ORDER BY planner")
    assert counts.to_dict("list") == {"planner": ["astar", "auto"], "n": [3, 3]}
    assert evaluation.compare(evaluation).worse is False
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (summary["episodes"], summary["success"], summary["passed"]) == (6, 1.0, True)
    assert evaluation.map_of(next(evaluation.rows()).place).shape == (120, 160)


def test_an_episode_is_repeated_by_its_scenario(room_map, tmp_path):
    evaluation = evaluate({"worlds": [room_map], "seeds": 2, "vary": {"mass": 1.2}}, workers=1, out=tmp_path / "out")
    row = list(evaluation.rows())[1]
    with evaluation.scenario_of(row.id[:8]).build() as mission:
        episode = mission.run()
    assert episode.metrics.time_s == row.time_s
    assert episode.metrics.distance_m == row.distance_m


@pytest.mark.slow
def test_an_unfinished_evaluation_is_a_balanced_sample_that_says_what_is_missing(room_map, tmp_path):
    worlds = [room_map, {"name": room_map, "label": "again", "options": {"height": 0.5}}]
    suite = Suite.make(worlds=worlds, backends="kinematic", planners=["auto", "astar"], seeds=6)

    def stop(progress):
        if progress.done == 8:
            raise KeyboardInterrupt

    with pytest.raises(InterruptedEvaluationError, match=r"-o .*\. Not counted: 1 that had begun; slow .* flatters"):
        run_suite(suite, tmp_path / "out", workers=1, on_progress=stop)
    stopped = Evaluation(tmp_path / "out")
    groups = [(row.world, row.planner) for row in stopped.rows()]
    assert sorted(groups.count(group) for group in set(groups)) == [2, 2, 2, 2]
    assert stopped.results.stopped.reason == "from outside"
    assert len(stopped.results.stopped.in_flight_s) == 1
    stopped.write_report()
    summary = stopped.read_summary()
    assert summary["stopped"] == {"reason": "from outside", "in_flight": 1, "left_out": 0}
    assert summary["complete"] is False
    assert "16 are missing. 1 of them had begun." in (tmp_path / "out" / "report.html").read_text()
    run_suite(suite, tmp_path / "out", workers=2)
    run_suite(suite, tmp_path / "whole", workers=1)
    assert unmeasured(tmp_path / "out") == unmeasured(tmp_path / "whole")
    assert Evaluation(tmp_path / "out").results.stopped is None


@pytest.mark.slow
def test_a_time_budget_ends_it_with_a_report_and_is_continued(room_map, tmp_path):
    missions = listed([0.8, HANG, 0.9, 1.1])
    suite = {"worlds": [room_map], "backends": "kinematic", "missions": missions, "planners": FaultyPlanner}
    suite = Suite.make(**suite, limits={"wall_s": 100.0})
    began = time.monotonic()
    evaluation = evaluate(suite, workers=2, out=tmp_path / "out", time_budget_s=6.0)
    assert time.monotonic() - began < 60.0  # less than the hanging episode takes
    assert {row.start_x for row in evaluation.rows()} <= {0.8, 0.9, 1.1}
    stopped = evaluation.results.stopped
    assert stopped.reason == "by its time budget"
    assert 1 <= len(stopped.in_flight_s) <= 2
    assert "Stopped by its time budget after" in (tmp_path / "out" / "report.html").read_text()
    assert not list((tmp_path / "out").glob(".*"))

    def stop(progress):
        if progress.done == 3:  # all but the one that hangs
            raise KeyboardInterrupt

    # As it is, where the budget was enough for these three.
    with pytest.raises((InterruptedEvaluationError, KeyboardInterrupt)):
        run_suite(suite, tmp_path / "out", workers=2, on_progress=stop)
    assert {row.start_x for row in Evaluation(tmp_path / "out").rows()} == {0.8, 0.9, 1.1}


def test_settings_whose_first_ten_episodes_raise_are_given_up_and_compared_with_nothing(room_map, tmp_path):
    suite = Suite.make(worlds=[room_map], backends="kinematic", planners=["astar", RaisingPlanner], seeds=25)
    evaluation = evaluate(suite, workers=1, out=tmp_path / "out")
    outcomes = [(row.planner, row.outcome) for row in evaluation.rows()]
    assert outcomes.count(("astar", "arrived")) == 25
    assert outcomes.count(("RaisingPlanner", "error")) == len(outcomes) - 25 == 10
    summary = evaluation.read_summary()
    assert summary["complete"] is True
    assert summary["stopped"] == {"reason": "", "in_flight": 0, "left_out": 15}
    [broken] = summary["only_errors"]
    assert broken["labels"]["planner"] == "RaisingPlanner"
    assert re.fullmatch(r"RuntimeError: no path today at .*test_engine\.py:\d+ in plan", broken["error"])
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.index("no path today") < page.index("35 episodes")
    assert "Compared on the same missions" not in page
    again = evaluate(suite, workers=2, out=tmp_path / "out")
    assert len(again) == 35
    sound = evaluate({"worlds": [room_map], "backends": "kinematic", "missions": 25}, out=tmp_path / "sound")
    with pytest.raises(InputError, match=r"there is nothing to compare: .*no path today"):
        sound.compare(evaluate(Suite.make(worlds=[room_map], backends="kinematic", planners=RaisingPlanner, seeds=3)))


class RaisingPlanner:
    """Raises in every episode."""

    def plan(self, costmap, start, goal):
        raise RuntimeError("no path today")


@pytest.fixture
def moved_map(room, tmp_path):
    """An evaluation in a map that has moved since, and where it is now."""
    for name in ("old", "new"):
        (tmp_path / name).mkdir()
    room.save(tmp_path / "old" / "room.yaml")
    other = {"name": str(tmp_path / "old" / "room.yaml"), "label": "other", "options": {"height": 0.7}}
    worlds = [str(tmp_path / "old" / "room.yaml"), other]
    evaluation = evaluate({"worlds": worlds, "backends": "kinematic", "missions": 1}, out=tmp_path / "out")
    for file in (tmp_path / "old").iterdir():
        file.rename(tmp_path / "new" / file.name)
    row = next(evaluation.rows())
    return tmp_path, row


def test_an_episode_is_repeated_with_a_map_that_has_moved(moved_map):
    folder, row = moved_map
    with pytest.raises(InputError, match=r"old/room\.yaml: this file of episode .* put it beside .* with --map"):
        Evaluation(folder / "out").scenario_of(row.id)
    for place in (folder / "new", folder / "new" / "room.yaml"):
        scenario = Evaluation(folder / "out").scenario_of(row.id, map=place)
        assert scenario.map == str(folder / "new" / "room.yaml")
        assert scenario.start[:2] == (row.start_x, row.start_y)
    for file in (folder / "new").iterdir():
        file.rename(folder / "out" / file.name)
    assert Evaluation(folder / "out").scenario_of(row.id).map == str(folder / "out" / "room.yaml")
    with pytest.raises(InputError, match=r"there is no room\.yaml in it"):
        Evaluation(folder / "out").scenario_of(row.id, map=folder / "old")


def test_another_map_than_that_of_the_episode_is_refused(moved_map, room):
    folder, row = moved_map
    changed = room.data.copy()
    changed[60:64, 60:64] = 100
    type(room)(changed, room.resolution).save(folder / "new" / "other.yaml")
    with pytest.raises(InputError, match="this is not the map of episode"):
        Evaluation(folder / "out").scenario_of(row.id, map=folder / "new" / "other.yaml")
