from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from bags.conftest import Keep
from support.doubtful import COVARIANCE
from support.messages import all_messages
from trundle.bags import Recorder, read_run
from trundle.bags.topics import RANGE_STEP_M
from trundle.errors import InputError, OutputError, UnknownNameError
from trundle.messages.codec import DISTROS
from trundle.mission import Scenario


def test_rosbags_reads_every_message_and_checks_its_type_hash(recorded):
    with AnyReader([recorded.path]) as reader:
        counts = {one.topic: one.msgcount for one in reader.connections}
        read = sum(1 for connection, _, data in reader.messages() if reader.deserialize(data, connection.msgtype))
    assert read == sum(counts.values())
    steps = len(recorded.steps)
    assert {topic: counts[topic] for topic in ("/clock", "/tf", "/odom", "/cmd_vel")} == dict.fromkeys(
        ("/clock", "/tf", "/odom", "/cmd_vel"), steps
    )
    assert counts["/map"] == counts["/tf_static"] == counts["/goal_pose"] == 1
    assert counts["/plan"] >= 1
    assert counts["/global_costmap/costmap"] >= 1
    scans = sum(len(step.scans) for step in recorded.steps)
    assert counts["/front/scan"] + counts["/back/scan"] == scans


def test_mcap_ros2_support_reads_every_message_with_the_same_values(recorded):
    with recorded.path.open("rb") as stream:
        found = list(make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages())
    truths = [(message.log_time, ros) for _, channel, message, ros in found if channel.topic == "/ground_truth/odom"]
    for (time, odometry), step in zip(truths, recorded.steps, strict=True):
        position = odometry.pose.pose.position
        assert (position.x, position.y) == (step.state.pose.x, step.state.pose.y)
        assert time == round(step.state.time * 1e9)


def test_scans_are_recorded_to_a_quarter_of_a_millimetre(recorded):
    first = next(scan for step in recorded.steps for scan in step.scans if scan.lidar == "front")
    _, message = next(all_messages(recorded.path, "/front/scan"))
    ranges = np.asarray(message.ranges)
    hits = np.isfinite(first.ranges)
    assert np.array_equal(np.isfinite(ranges), hits)
    assert np.abs(ranges[hits] - first.ranges[hits]).max() <= RANGE_STEP_M
    angles = message.angle_min + message.angle_increment * np.arange(len(ranges))
    assert np.abs(angles - first.angles).max() < 1e-4


def test_transforms_lead_from_the_map_to_the_estimated_pose(recorded):
    from trundle.geometry import Pose2D
    from trundle.messages.readers import read_yaw

    for (_, message), step in zip(all_messages(recorded.path, "/tf"), recorded.steps, strict=True):
        outer, inner = (
            Pose2D(one.transform.translation.x, one.transform.translation.y, read_yaw(one.transform.rotation))
            for one in message.transforms
        )
        assert [one.child_frame_id for one in message.transforms] == ["odom", "base_link"]
        assert (outer @ inner).as_tuple() == pytest.approx(step.estimate.pose.as_tuple(), abs=1e-9)


def test_the_map_is_the_one_that_the_robot_was_given(recorded):
    _, message = next(all_messages(recorded.path, "/map"))
    assert np.array_equal(np.asarray(message.data).reshape(recorded.grid.shape), recorded.grid.data)


def test_updates_on_the_last_whole_costmap_give_the_costmap_of_the_run(recorded):
    from trundle.messages.makers import cost_values

    cells = None
    for topic, message in all_messages(recorded.path, "/global_costmap/costmap", "/global_costmap/costmap_updates"):
        if topic.endswith("costmap"):
            cells = np.asarray(message.data).reshape(message.info.height, message.info.width).copy()
        else:
            rows, cols = slice(message.y, message.y + message.height), slice(message.x, message.x + message.width)
            cells[rows, cols] = np.asarray(message.data).reshape(message.height, message.width)
        last = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    step = next(one for one in recorded.steps if one.state.time == pytest.approx(last))
    assert np.array_equal(cells, cost_values()[step.costmap.data])


def test_the_bag_has_the_metadata_of_rosbag2_and_the_episode(recorded):
    with recorded.path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        records = {record.name: record.metadata for record in reader.iter_metadata()}
        channels = reader.get_summary().channels.values()
    assert set(records) == {"rosbag2", "trundle", "trundle_episode"}
    assert recorded.episode.outcome.value in records["rosbag2"]["serialized_metadata"]
    assert records["trundle_episode"]["outcome"] == recorded.episode.outcome.value
    by_topic = {channel.topic: channel.metadata for channel in channels}
    assert "transient_local" in by_topic["/map"]["offered_qos_profiles"]
    assert "best_effort" in by_topic["/front/scan"]["offered_qos_profiles"]
    assert all(metadata["topic_type_hash"].startswith("RIHS01_") for metadata in by_topic.values())


def test_chunks_end_each_second(recorded):
    with recorded.path.open("rb") as stream:
        chunks = make_reader(stream).get_summary().chunk_indexes
    spans = [(chunk.message_end_time - chunk.message_start_time) / 1e9 for chunk in chunks]
    assert max(spans) <= 1.0
    assert {chunk.compression for chunk in chunks} == {"zstd"}


@pytest.mark.parametrize("distro", DISTROS)
def test_every_distribution_is_written_and_read(recorded, tmp_path, distro):
    path = tmp_path / "run.mcap"
    recorder = Recorder(path, distro=distro)
    recorder.on_start(recorded.info)
    for step in recorded.steps[:25]:
        recorder.on_step(step)
    recorder.on_end(recorded.episode)
    with AnyReader([path]) as reader:
        kinds = {one.topic: one.msgtype for one in reader.connections}
        assert sum(1 for one, _, data in reader.messages() if reader.deserialize(data, one.msgtype))
    stamped = distro in ("kilted", "lyrical")
    assert kinds["/cmd_vel"] == "geometry_msgs/msg/" + ("TwistStamped" if stamped else "Twist")


def test_a_recording_has_its_name_only_when_it_is_complete(recorded, tmp_path):
    recorder = Recorder(tmp_path / "run.mcap")
    recorder.on_start(recorded.info)
    recorder.on_step(recorded.steps[0])
    assert [one.name for one in tmp_path.iterdir()] == ["run.partial.mcap"]
    recorder.on_end(recorded.episode)
    assert [one.name for one in tmp_path.iterdir()] == ["run.mcap"]


def test_a_recording_that_exists_is_not_overwritten_unasked(recorded, tmp_path):
    path = tmp_path / "run.mcap"
    path.write_bytes(b"mine")
    with pytest.raises(OutputError, match="already exists"):
        Recorder(path)
    path.rename(tmp_path / "run.partial.mcap")
    with pytest.raises(OutputError, match="trundle record recover"):
        Recorder(path)
    Recorder(path, overwrite=True)


def test_the_arguments_of_a_recorder_are_checked(tmp_path):
    with pytest.raises(InputError, match=r"ends in \.mcap"):
        Recorder(tmp_path / "run.bag")
    with pytest.raises(UnknownNameError, match="jazzy"):
        Recorder(tmp_path / "run.mcap", distro="jazy")  # type: ignore[arg-type]


def test_a_second_run_needs_another_recorder(recorded, tmp_path):
    with Recorder(tmp_path / "run.mcap") as recorder:
        recorder.on_start(recorded.info)
        with pytest.raises(OutputError, match="create another"):
            recorder.on_start(recorded.info)


def test_without_the_end_the_file_keeps_its_partial_name(recorded, tmp_path):
    with Recorder(tmp_path / "run.mcap") as recorder:
        recorder.on_start(recorded.info)
        recorder.on_step(recorded.steps[0])
    assert (tmp_path / "run.partial.mcap").exists()
    assert not Path(tmp_path / "run.mcap").exists()


# What a localizer believes --------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def doubtful(tmp_path_factory):
    """The recording of a run whose localizer is in doubt at first, with its steps and its episode."""
    path = tmp_path_factory.mktemp("doubtful") / "run.mcap"
    localizer = "support.doubtful:DoubtfulLocalizer"
    scenario = Scenario.make(world="warehouse", seed=4, backend="kinematic", localizer=localizer, time_limit_s=6.0)
    keep = Keep()
    with scenario.build() as mission:
        mission.run(observers=[keep, Recorder(path, scenario=mission.scenario)])
    return path, keep


def test_what_a_localizer_believes_is_recorded_under_the_names_of_amcl(doubtful):
    path, keep = doubtful
    poses = [message for _, message in all_messages(path, "/amcl_pose")]
    first = np.asarray(poses[0].pose.covariance).reshape(6, 6)[np.ix_((0, 1, 5), (0, 1, 5))]
    np.testing.assert_allclose(first, COVARIANCE)
    seconds = keep.steps[-1].state.time
    assert len(poses) == pytest.approx(10.0 * seconds, rel=0.1)
    clouds = [message for _, message in all_messages(path, "/particle_cloud")]
    assert 150 < len(clouds[0].particles) <= 200
    assert len(clouds) <= seconds + 4
    said = [message.status[0].message for _, message in all_messages(path, "/diagnostics")]
    assert list(dict.fromkeys(said)) == ["ambiguous: 3 places", "lost", "localized"]


def test_a_run_that_knows_its_true_pose_has_none_of_these_topics(recorded):
    with AnyReader([recorded.path]) as reader:
        assert not {"/amcl_pose", "/particle_cloud", "/diagnostics"} & {one.topic for one in reader.connections}


def test_what_a_localizer_believed_comes_back_from_the_bag(doubtful):
    path, keep = doubtful
    run = read_run(path)
    np.testing.assert_array_equal(run.episode.trajectory.localization, keep.episode.trajectory.localization)
    assert run.info.localizer == "DoubtfulLocalizer"
    found = run.steps[10].estimate
    assert (found.state, len(found.hypotheses)) == ("ambiguous", 3)
    assert found.hypotheses[1].pose.as_tuple() == pytest.approx(
        keep.steps[0].estimate.hypotheses[1].pose.as_tuple(), abs=1e-3
    )
    np.testing.assert_allclose(found.covariance, COVARIANCE)
    assert found.particles.shape[1] == 4
    assert found.pose.as_tuple() == pytest.approx(keep.steps[10].estimate.pose.as_tuple(), abs=1e-6)


def test_a_bag_of_a_robot_that_knows_its_true_pose_says_nothing_of_a_localizer(recorded):
    run = read_run(recorded.path)
    assert run.info.localizer == "none"
    assert all(step.estimate.pose is step.state.pose for step in run.steps)
