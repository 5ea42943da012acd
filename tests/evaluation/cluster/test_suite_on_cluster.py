"""A suite's real episodes on a cluster have the rows of a local run."""

import logging
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from trundle.evaluation import Evaluation, Suite, cluster
from trundle.evaluation.engine import InterruptedEvaluationError, Progress, run_suite

pytestmark = pytest.mark.ray


def make_suite(room: Any, folder: Path, seeds: int) -> Suite:
    room.save(folder / "room.yaml")
    return Suite.make(worlds=[str(folder / "room.yaml")], planners=["auto", "astar"], backends="kinematic", seeds=seeds)


def use_small_shards(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "run_on_cluster", partial(cluster.run_on_cluster, shard=4))


def unmeasured(folder: Any) -> list[dict[str, Any]]:
    return [row.unmeasured() for row in Evaluation(folder).rows()]


def test_rows_are_those_of_the_local_run_though_a_node_is_killed(
    pair: Any, room: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_small_shards(monkeypatch)
    suite = make_suite(room, tmp_path, 16)
    killed: list[int] = []

    def kill_one(progress: Progress) -> None:
        if progress.done and not killed:
            killed.append(progress.done)
            pair.remove_node(pair.first, allow_graceful=False)

    run_suite(suite, tmp_path / "cluster", ray=pair.address, workers=1, on_progress=kill_one)
    assert 0 < killed[0] < len(suite)
    run_suite(suite, tmp_path / "local", workers=2)
    rows = unmeasured(tmp_path / "cluster")
    assert len(rows) == len(suite) == 32
    assert rows == unmeasured(tmp_path / "local")


def test_a_folder_in_an_object_store_has_rows_and_reports(single: Any, room: Any, tmp_path: Path) -> None:
    suite = make_suite(room, tmp_path, 2)
    uri = (tmp_path / "bucket" / "e").as_uri()
    assert run_suite(suite, uri, ray=single.address, workers=1) == uri
    evaluation = Evaluation(uri)
    assert len(evaluation) == len(suite) == 4
    assert evaluation.write_report() == f"{uri}/report.html"
    run_suite(suite, tmp_path / "local", workers=1)
    assert unmeasured(uri) == unmeasured(tmp_path / "local")
    assert {"report.html", "junit.xml", "summary.json"} <= {path.name for path in (tmp_path / "bucket" / "e").iterdir()}


def test_ctrl_c_ends_what_runs_on_the_cluster(
    single: Any, room: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import ray  # pyright: ignore[reportMissingImports] - an extra

    use_small_shards(monkeypatch)
    suite = make_suite(room, tmp_path, 2000)

    def stop(progress: Progress) -> None:
        if progress.done:
            raise KeyboardInterrupt

    with pytest.raises(InterruptedEvaluationError, match=r"of 4,000 episodes; to continue, .* -o "):
        run_suite(suite, tmp_path / "out", ray=single.address, workers=1, on_progress=stop)
    assert not ray.is_initialized()
    assert 0 < len(Evaluation(tmp_path / "out")) < len(suite)
    ray.init(address=single.address, log_to_driver=False, logging_level=logging.ERROR)
    try:
        until = time.monotonic() + 60.0
        while ray.available_resources().get("CPU") != 1.0 and time.monotonic() < until:
            time.sleep(0.1)
        assert ray.available_resources().get("CPU") == 1.0
    finally:
        ray.shutdown()


def test_a_time_budget_ends_an_evaluation_on_a_cluster_with_its_rows(
    single: Any, room: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_small_shards(monkeypatch)
    suite = make_suite(room, tmp_path, 4000)
    run_suite(suite, tmp_path / "out", ray=single.address, workers=1, time_budget_s=30.0)
    evaluation = Evaluation(tmp_path / "out")
    assert 0 < len(evaluation) < len(suite)
    assert evaluation.summary()["stopped"]["reason"] == "by its time budget"


def test_a_group_whose_planner_only_raises_is_stopped_on_a_cluster(
    single: Any, room: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_small_shards(monkeypatch)
    planner = tmp_path / "broken.py"
    planner.write_text("def plan(costmap, start, goal):\n    raise ZeroDivisionError('always')\n")
    room.save(tmp_path / "room.yaml")
    suite = Suite.make(
        worlds=[str(tmp_path / "room.yaml")], planners=["auto", f"{planner}:plan"], backends="kinematic", seeds=200
    )
    run_suite(suite, tmp_path / "out", ray=single.address, workers=1)
    rows = [(row.planner, row.outcome) for row in Evaluation(tmp_path / "out").rows()]
    assert rows.count(("auto", "arrived")) == 200
    broken = [outcome for name, outcome in rows if name != "auto"]
    assert set(broken) == {"error"}
    assert 10 <= len(broken) < 200
