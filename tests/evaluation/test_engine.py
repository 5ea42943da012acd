import json
import os
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
