import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin

from support.foreign_bags import room, write_bag
from trundle.bags import read_run, recover
from trundle.bags.bag_content import TopicNames
from trundle.bags.run_record import RUN_RECORD, describe_run, parse_records
from trundle.errors import InputError
from trundle.mission import Episode, Outcome, Scenario
from trundle.record import RunFolder


def test_our_own_bag_gives_the_run_back(recorded):
    run = read_run(recorded.path)
    old, new = recorded.episode, run.episode
    assert (new.outcome, new.message, new.metrics, new.goals) == (old.outcome, old.message, old.metrics, old.goals)
    for name in ("time", "x", "y", "yaw", "v", "w", "commanded_v", "odometry_x", "estimate_yaw", "goal", "path"):
        assert np.allclose(getattr(new.trajectory, name), getattr(old.trajectory, name), atol=1e-8), name
    assert [len(path) for path in new.paths] == [len(path) for path in old.paths]
    assert run.scenario == recorded.scenario
    assert np.array_equal(run.grid.data, recorded.grid.data)
    assert sum(len(step.scans) for step in run.steps) == sum(len(step.scans) for step in recorded.steps)


@pytest.mark.parametrize("start_error", ["unknown", {"distance": 0.5, "heading": "10deg", "covariance": False}])
def test_a_bag_keeps_what_a_localizer_had_to_bear(recorded, start_error):
    scenario = Scenario.make(
        world="office",
        lidar=True,
        localizer="odometry",
        odometry={"slips": {"count": 6, "every": 3.0}},
        lidar_errors={"noise": 0.02, "dropouts": 0.01, "short_returns": 0.01},
        start_error=start_error,
        map_errors={"missing": 0.25, "ghosts": [2, 12]},
    )
    record = parse_records(recorded.path, {RUN_RECORD: describe_run(recorded.info, scenario, "jazzy")})
    assert record.scenario == scenario


def test_a_recovered_bag_is_an_aborted_run_with_metrics(recorded, partial):
    run = read_run(recover(partial).path)
    assert run.episode.outcome is Outcome.ABORTED
    assert run.episode.metrics.distance_m == pytest.approx(recorded.episode.metrics.distance_m, rel=0.02)


@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_the_bag_of_another_robot_becomes_a_run(tmp_path, storage):
    bag = write_bag(tmp_path / "bag", storage=storage)
    run = read_run(bag, robot="turtlebot3_burger", distro="humble")
    episode = run.episode
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.distance_m == pytest.approx(4.0, abs=1e-6)
    assert episode.metrics.time_s == pytest.approx(10.0)
    assert episode.metrics.measured_on == "map"
    assert episode.metrics.min_clearance_m is not None
    assert np.allclose(episode.trajectory.x, 0.4 * episode.trajectory.time, atol=1e-6)
    assert np.diff(episode.trajectory.time).min() >= 0.04
    assert len(episode.paths) == 1
    assert np.array_equal(run.grid.data, room().data)
    scan = next(scan for step in run.steps for scan in step.scans)
    assert scan.ranges[scan.angles > 0.1].max() == 1.0  # it is mounted upside down
    with RunFolder(tmp_path / "run", overlay=False, video=False) as folder:
        run.play([folder])
    assert Episode.load(tmp_path / "run").metrics == episode.metrics


def test_the_map_may_come_from_a_file(tmp_path):
    bag = write_bag(tmp_path / "bag", leave_out=("/map",))
    with pytest.raises(InputError, match=r"no map .*--map FILE\.yaml"):
        read_run(bag)
    room().save(tmp_path / "room.yaml")
    assert read_run(bag, names=TopicNames(map=str(tmp_path / "room.yaml"))).episode.arrived


def test_a_topic_that_is_not_there_is_named_with_those_that_are(tmp_path):
    bag = write_bag(tmp_path / "bag")
    with pytest.raises(InputError, match=r"--plan /other: .*there are: /robot1/plan"):
        read_run(bag, names=TopicNames(plan="/other"))


def test_a_message_that_cannot_be_used_is_named(tmp_path):
    bag = write_bag(tmp_path / "bag", resolution=0.0)
    with pytest.raises(InputError, match=r"/robot1/map, received at .*resolution must be"):
        read_run(bag)


def test_a_bag_without_transforms_is_refused(tmp_path):
    with pytest.raises(InputError, match="no transforms"):
        read_run(write_bag(tmp_path / "bag", leave_out=("/tf", "/tf_static")))


def test_a_bag_without_localization_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"Was localization running\?"):
        read_run(write_bag(tmp_path / "bag", localized=False))


def test_a_foreign_bag_without_a_robot_is_measured_as_nova_carter_with_a_remark(tmp_path):
    run = read_run(write_bag(tmp_path / "bag"))
    assert run.info.robot.name == "nova_carter"
    assert any("--robot" in remark for remark in run.remarks)


def test_damaged_and_missing_bags_are_one_clear_error(recorded, partial, tmp_path):
    with pytest.raises(InputError, match="trundle record recover"):
        read_run(partial)
    with pytest.raises(InputError, match="no such file"):
        read_run(tmp_path / "none.mcap")
    with pytest.raises(InputError, match=r"no metadata\.yaml"):
        read_run(tmp_path)
    (tmp_path / "x.txt").write_text("no bag")
    with pytest.raises(InputError, match="not a bag"):
        read_run(tmp_path / "x.txt")
    (tmp_path / "x.db3").write_text("no database")
    with pytest.raises(InputError, match="damaged"):
        read_run(tmp_path / "x.db3")
