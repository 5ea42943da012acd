import json

import numpy as np
import pytest

from trundle.errors import InputError, OutputError
from trundle.mission import Trajectory, run


def make_trajectory(n=5, **changes):
    rng = np.random.default_rng(0)
    columns = {name: rng.normal(size=n) for name in Trajectory.columns()}
    columns.update(goal=np.zeros(n, dtype=np.int64), path=np.full(n, -1), localization=np.arange(n) % 3)
    return Trajectory(**(columns | changes))


def test_a_trajectory_comes_back_bit_for_bit(tmp_path):
    trajectory = make_trajectory()
    trajectory.save(tmp_path / "t.npz")
    again = Trajectory.load(tmp_path / "t.npz")
    for name in Trajectory.columns():
        assert np.array_equal(getattr(again, name), getattr(trajectory, name))
        assert getattr(again, name).dtype == getattr(trajectory, name).dtype
    assert [path.name for path in tmp_path.iterdir()] == ["t.npz"]


def test_a_trajectory_is_read_only():
    trajectory = make_trajectory()
    with pytest.raises(ValueError, match="read-only"):
        trajectory.x[0] = 1.0


@pytest.mark.parametrize(
    "changes",
    [{"x": np.zeros(4)}, {"x": np.zeros((5, 1))}, {"x": np.full(5, np.nan)}, {"time": np.zeros(0)}],
)
def test_arrays_that_are_no_trajectory_are_refused(changes):
    with pytest.raises(InputError):
        make_trajectory(**changes)


def test_files_that_are_no_trajectory_are_refused(tmp_path):
    with pytest.raises(InputError, match="cannot read"):
        Trajectory.load(tmp_path / "missing.npz")
    (tmp_path / "text.npz").write_text("not an archive")
    with pytest.raises(InputError):
        Trajectory.load(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", time=np.zeros(3))
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(tmp_path / "other.npz")
    np.savez(tmp_path / "pickle.npz", time=np.array([{}], dtype=object))
    with pytest.raises(InputError):
        Trajectory.load(tmp_path / "pickle.npz")
    make_trajectory().save(tmp_path / "whole.npz")
    (tmp_path / "half.npz").write_bytes((tmp_path / "whole.npz").read_bytes()[:900])
    with pytest.raises(InputError):
        Trajectory.load(tmp_path / "half.npz")


def test_saving_where_there_is_no_folder_is_an_output_error(tmp_path):
    with pytest.raises(OutputError):
        make_trajectory().save(tmp_path / "none" / "t.npz")


def test_an_episode_is_plain_values_with_the_names_that_stay(make_sim, navigator, start):
    episode = run(make_sim(), navigator, start, (3.0, 4.5))
    values = json.loads(json.dumps(episode.as_dict(), allow_nan=False))
    assert values["outcome"] == "arrived"
    assert {
        "time_s",
        "distance_m",
        "path_length_m",
        "min_clearance_m",
        "planning_ms",
        "real_time_factor",
        "contacts",
    } <= set(values)
    assert values["contacts"] == []
    assert values["goals"] == [[3.0, 4.5]]


def test_a_trajectory_of_an_older_version_is_localized_and_a_state_is_one_of_three(tmp_path):
    trajectory = make_trajectory()
    old = {name: getattr(trajectory, name) for name in Trajectory.columns() if name != "localization"}
    np.savez(tmp_path / "old.npz", **old)
    assert Trajectory.load(tmp_path / "old.npz").localization.tolist() == [0] * 5
    with pytest.raises(InputError, match="localization of a trajectory must be 0 to 2"):
        make_trajectory(localization=np.full(5, 3))
