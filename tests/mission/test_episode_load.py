"""What a run's folder gives back, and what is said about folders that cannot."""

import json
import math
import shutil
from dataclasses import fields

import numpy as np
import pytest

import trundle
from trundle.errors import InputError
from trundle.mission import Episode, Scenario, Trajectory
from trundle.mission.run_files import load_paths, save_paths
from trundle.path import Path
from trundle.record.run_folder import RunFolder


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run through two goals, one with any yaw, and the folder that it left."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    scenario = Scenario.make(
        name="hall 1",
        world={"name": "warehouse", "options": {"size": [14, 11]}},
        backend="kinematic",
        seed=5,
        time_limit_s=120,
    )
    with scenario.build() as mission, RunFolder(folder, scenario=mission.scenario, video=False) as record:
        episode = mission.run(observers=[record])
    assert episode.observer_errors == ()
    return episode, folder


class Standing:
    """A controller that never moves."""

    def reset(self, *, seed=0): ...

    def set_path(self, path): ...

    def set_speed_limit(self, limit): ...

    def compute_velocity(self, pose, twist, costmap, dt):
        return trundle.Twist2D()


@pytest.fixture
def folder(finished, tmp_path):
    return shutil.copytree(finished[1], tmp_path / "copy")


def same_paths(first, second):
    assert len(first) == len(second)
    for one, other in zip(first, second, strict=True):
        for field in fields(Path):
            left, right = getattr(one, field.name), getattr(other, field.name)
            if isinstance(left, np.ndarray):
                assert left.dtype == right.dtype
                assert left.tobytes() == right.tobytes()
            else:
                assert left == right or (math.isnan(left) and math.isnan(right)), field.name


def test_a_run_comes_back_equal(finished):
    episode, folder = finished
    again = trundle.Episode.load(folder)
    assert again.folder == folder
    same_paths(again.paths, episode.paths)
    for name in Trajectory.columns():
        assert getattr(again.trajectory, name).tobytes() == getattr(episode.trajectory, name).tobytes()
    for field in fields(Episode):
        if field.name not in ("trajectory", "paths", "costmap", "folder"):
            assert getattr(again, field.name) == getattr(episode, field.name), field.name
    assert again.as_dict() == episode.as_dict()


def test_a_folder_written_before_behaviors_were_recorded_loads(folder):
    file = folder / "episode.json"
    record = json.loads(file.read_text())
    assert record.pop("behaviors") == []
    assert record.pop("recoveries") == 0
    assert record.pop("standing_reasons") == {}
    file.write_text(json.dumps(record))
    episode = trundle.Episode.load(folder)
    assert episode.behaviors == ()
    assert episode.metrics.recoveries is None
    assert episode.metrics.standing_reasons == {}


def test_the_behaviors_of_a_run_come_back(tmp_path):
    scenario = Scenario.make(
        name="blocked",
        world={"name": "warehouse", "options": {"size": [14, 11]}},
        backend="kinematic",
        recovery="wait=0.2,spin=0.5",
        recovery_retries=3,
        time_limit_s=60,
    )
    with scenario.build() as mission, RunFolder(tmp_path / "run", scenario=mission.scenario, video=False) as record:
        mission.navigator.controller = Standing()
        episode = mission.run(observers=[record])
    assert [ran.behavior for ran in episode.behaviors] == ["wait", "spin", "wait"]
    assert episode.metrics.recoveries == 3
    assert all(ran.reason and ran.begin_s <= ran.end_s <= episode.metrics.time_s for ran in episode.behaviors)
    again = trundle.Episode.load(tmp_path / "run")
    assert again.behaviors == episode.behaviors
    assert again.metrics.recoveries == 3
    assert Scenario.load(tmp_path / "run").recovery == scenario.recovery


def test_the_folder_of_a_run_is_a_scenario_too(finished):
    _, folder = finished
    assert Scenario.load(folder) == Scenario.load(folder / "scenario.yaml")
    with pytest.raises(InputError, match=r"scenario\.yaml"):
        Scenario.load(folder.parent)


def test_a_run_whose_pictures_are_not_done_comes_back(folder):
    record = json.loads((folder / "episode.json").read_text())
    (folder / "episode.json").write_text(json.dumps(record | {"complete": False, "files": []}))
    (folder / "overlay.png").unlink()
    assert Episode.load(str(folder)).arrived


def test_a_run_from_before_estimates_and_monitors_comes_back(folder):
    """Its record has no figures of sensing, and its trajectory no estimates: the true poses stand for them."""
    record = json.loads((folder / "episode.json").read_text())
    located = ("position_error_m", "localization_error_m", "localization_error_p95_m", "lost_s")
    new = ("standing_contacts", "unseen_contacts", *located, "monitor_stops")
    assert set(new) <= set(record)
    older = {name: value for name, value in record.items() if name not in new}
    (folder / "episode.json").write_text(json.dumps(older))
    with np.load(folder / "trajectory.npz") as arrays:
        kept = {name: arrays[name] for name in arrays.files if not name.startswith("estimate")}
        assert len(kept) == len(arrays.files) - 3
    np.savez(folder / "trajectory.npz", **kept)
    again = trundle.Episode.load(folder)
    np.testing.assert_array_equal(again.trajectory.estimates, again.trajectory.poses)
    metrics = again.metrics
    assert (metrics.standing_contacts, metrics.unseen_contacts) == ((), ())
    assert (metrics.position_error_m, metrics.monitor_stops) == (0.0, None)
    assert (metrics.localization_error_m, metrics.localization_error_p95_m, metrics.lost_s) == (0.0, 0.0, 0.0)


def test_paths_of_every_kind_come_back(tmp_path):
    paths = (
        Path([(0, 0, 0)]),
        Path([(0, 0, 0), (1, 0, 0.5), (0.5, 0, 0.5)], cost=2.5, planner="hybrid_astar", backward=[False, True]),
        Path([(0, 0, 0), (1, 0, 0)], status="partial", remaining_m=3.25, replans=2, goal_snapped_m=0.1),
    )
    for some in (paths, ()):
        save_paths(tmp_path / "p.npz", some)
        same_paths(load_paths(tmp_path / "p.npz"), some)


def test_folders_without_a_run_say_what_is_missing(tmp_path, folder):
    with pytest.raises(InputError, match="no such folder; give the folder that trundle run wrote"):
        Episode.load(tmp_path / "none")
    with pytest.raises(InputError, match=r"not a folder; give the folder that trundle run wrote, here perhaps .*copy"):
        Episode.load(folder / "episode.json")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"empty: no episode\.json in it"):
        Episode.load(tmp_path / "empty")
    (tmp_path / "empty" / "drive.csv").touch()
    with pytest.raises(InputError, match="the record of trundle drive"):
        Episode.load(tmp_path / "empty")
    with pytest.raises(InputError, match="must be a path"):
        Episode.load(3)


def test_a_run_that_has_not_ended_is_distinguished_from_a_folder_of_another_kind(folder):
    (folder / "episode.json").unlink()
    with pytest.raises(InputError, match="has not ended, or was killed"):
        Episode.load(folder)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", r"episode\.json:1:1: .*the record is damaged"),
        ('{"outcome": "arri', r"episode\.json:1:13: .*the record is damaged"),
        ("[]", "no record, which is a JSON object"),
        ("[" * 100_000, "cannot be read as JSON"),
        ('{"time_s": NaN}', "cannot be read as JSON"),
        ("\xff", "cannot be read as JSON"),
        ("{}", "(?s)outcome: Field required.*the record is damaged"),
    ],
)
def test_a_damaged_record_is_a_typed_error(folder, content, message):
    (folder / "episode.json").write_bytes(content.encode("latin-1"))
    with pytest.raises(InputError, match=message):
        Episode.load(folder)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"outcome": "vanished"}, "outcome: Input should be 'arrived'"),
        ({"time_s": "long"}, "time_s: Input should be a valid number"),
        ({"goals": [[1.0]]}, r"goals\.0"),
        ({"start": [0.0, 0.0]}, r"start\.2: Field required"),
        ({"contacts": 3}, "contacts"),
    ],
)
def test_a_value_of_another_type_is_named(folder, changes, message):
    record = json.loads((folder / "episode.json").read_text())
    (folder / "episode.json").write_text(json.dumps(record | changes))
    with pytest.raises(InputError, match=message) as error:
        Episode.load(folder)
    assert "episode.json" in str(error.value)


@pytest.mark.parametrize("name", ["trajectory.npz", "paths.npz"])
def test_a_missing_or_damaged_array_file_is_named(folder, name):
    content = (folder / name).read_bytes()
    for damage in (content[: len(content) // 2], b"", b"PK" + content[:40]):
        (folder / name).write_bytes(damage)
        with pytest.raises(InputError, match=name):
            Episode.load(folder)
    (folder / name).unlink()
    with pytest.raises(InputError, match=name):
        Episode.load(folder)


@pytest.mark.parametrize(
    "changes",
    [
        {"count": np.array([-1, 3])},
        {"count": np.array(2)},
        {"count": np.array([2**62, 2**62, 2**62])},
        {"poses": np.zeros((2, 2))},
        {"poses": np.array(1.0)},
        {"poses": np.full((2, 3), np.nan)},
        {"backward": np.zeros(5, np.bool_)},
        {"planner": np.zeros((0,), np.str_)},
        {"cost": np.array(["much"])},
    ],
)
def test_arrays_that_are_no_paths_are_refused(tmp_path, changes):
    save_paths(tmp_path / "p.npz", [Path([(0, 0, 0), (1, 0, 0)])])
    with np.load(tmp_path / "p.npz") as stored:
        arrays = dict(stored)
    np.savez(tmp_path / "p.npz", **(arrays | changes))
    with pytest.raises(InputError, match=r"p\.npz: not the paths of a run"):
        load_paths(tmp_path / "p.npz")
    np.savez(tmp_path / "p.npz", poses=np.zeros((2, 3)))
    with pytest.raises(InputError, match="it has no backward, count"):
        load_paths(tmp_path / "p.npz")


def test_a_name_beyond_unicode_is_refused(folder):
    arrays = dict(np.load(folder / "paths.npz"))
    arrays["planner"] = np.array([[0x110000]], np.uint32).view("U1")[0].repeat(len(arrays["planner"]))
    np.savez(folder / "paths.npz", **arrays)
    with pytest.raises(InputError, match=r"paths\.npz: not the paths of a run"):
        Episode.load(folder)


def test_arrays_of_two_runs_are_refused(folder):
    save_paths(folder / "paths.npz", [])
    with pytest.raises(InputError, match="they are of two runs"):
        Episode.load(folder)


def test_a_trajectory_becomes_a_table(finished):
    pytest.importorskip("pandas")
    trajectory = finished[0].trajectory
    table = trajectory.to_pandas()
    assert list(table.columns) == list(Trajectory.columns())
    assert len(table) == len(trajectory)
    assert table["x"].to_numpy().tolist() == trajectory.x.tolist()
    assert table["path"].dtype == np.int64
    table.loc[0, "x"] = 1e6  # a copy: the trajectory stays
    assert trajectory.x[0] != 1e6


def test_without_pandas_the_install_line_is_given(finished, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(trundle.TrundleError, match=r'pip install ".*\[pandas\]"'):
        finished[0].trajectory.to_pandas()
