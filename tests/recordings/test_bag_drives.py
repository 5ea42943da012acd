"""Drives in bags that a stranger wrote: topics, frames, clocks and beams as they come."""

from __future__ import annotations

import itertools
import math
import shutil

import numpy as np
import pytest

from support.room_drives import Drive, write_bag
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.recordings import open_drive

pytest.importorskip("rosbags")

SHORT = Drive(seconds=12.0)


def read(path, **options):
    drive = open_drive(path, **options)
    steps = list(drive.steps())
    return drive, steps, [scan for step in steps for scan in step.observation.scans]


def check_increasing(steps):
    for before, after in itertools.pairwise(steps):
        assert after.begins_part or after.observation.time > before.observation.time


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_every_scan_and_the_odometry_are_read(tmp_path, storage):
    drive, steps, scans = read(write_bag(tmp_path / "bag", SHORT, storage=storage))
    assert (len(scans), drive.scans, drive.odometry, drive.lidars) == (60, 60, "/odom", ("laser",))
    assert not drive.knows_robot
    assert drive.remarks.lines == ()
    check_increasing(steps)
    last = next(step for step in reversed(steps) if step.observation.scans)
    index = round((last.observation.time - SHORT.begin) * 20)
    np.testing.assert_allclose(last.observation.odometry.as_tuple()[:2], SHORT.odometry[index][:2], atol=1e-6)
    assert scans[0].mount == Pose2D(0.2, 0.0)
    assert scans[0].height == pytest.approx(0.3)
    np.testing.assert_allclose(scans[0].ranges, SHORT.scan(0), rtol=1e-5)
    np.testing.assert_allclose(scans[0].angles, SHORT.angles, atol=1e-5)
    assert steps[-1].share == 1.0


def test_topics_and_frames_of_any_name_are_found(tmp_path):
    rename = {"/scan": "/r1/sick_front/scan", "/odom": "/r1/wheel/odometry"}
    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, rename=rename))
    assert (drive.odometry, len(scans)) == ("/r1/wheel/odometry", 60)


def test_transforms_take_the_place_of_odometry(tmp_path):
    drive, steps, scans = read(write_bag(tmp_path / "bag", SHORT, topics=("/scan", "/tf", "/tf_static")))
    assert (drive.odometry, len(scans)) == ("/tf", 60)
    np.testing.assert_allclose(steps[-1].observation.odometry.x, SHORT.odometry[-4, 0], atol=1e-6)


def test_without_odometry_the_robot_seems_to_stand(tmp_path):
    drive, steps, scans = read(write_bag(tmp_path / "bag", SHORT, topics=("/scan", "/tf_static")))
    assert drive.odometry is None
    assert len(scans) == 60
    assert {step.observation.odometry for step in steps} == {Pose2D(0.0, 0.0)}


def test_a_bag_without_scans_says_what_it_has(tmp_path):
    with pytest.raises(InputError, match=r"has no scans .*it has /odom, /tf_static"):
        open_drive(write_bag(tmp_path / "bag", SHORT, topics=("/odom", "/tf_static")))


def test_a_topic_that_is_not_there_is_named(tmp_path):
    bag = write_bag(tmp_path / "bag", SHORT)
    with pytest.raises(InputError, match=r"--scan-topic /lidar: the bag has scans on /scan"):
        open_drive(bag, scan_topics=["/lidar"])
    with pytest.raises(InputError, match=r"--odom /wheels: the bag has no such topic"):
        open_drive(bag, odometry="/wheels")


def test_a_lidar_mounted_upside_down_turns_the_other_way(tmp_path):
    turned = Drive(seconds=12.0)
    bag = write_bag(tmp_path / "bag", turned, roll=math.pi)
    drive, _, scans = read(bag)
    np.testing.assert_allclose(scans[0].angles, -turned.angles, atol=1e-5)
    assert "'laser' is mounted upside down: its beams turn the other way round" in drive.remarks.lines


def test_a_tilted_lidar_is_refused_with_the_angle(tmp_path):
    with pytest.raises(InputError, match=r"'laser' is tilted by 40°"):
        open_drive(write_bag(tmp_path / "bag", SHORT, roll=math.radians(40.0)))


def test_without_a_mount_the_middle_is_taken_and_said(tmp_path):
    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, topics=("/scan", "/odom")))
    assert scans[0].mount == Pose2D(0.0, 0.0)
    assert any("taken to be in its middle" in line for line in drive.remarks.lines)


def test_the_robots_file_says_where_its_lidar_is(tmp_path):
    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, topics=("/scan", "/odom")), robot="turtlebot3_burger")
    assert drive.knows_robot
    assert scans[0].mount != Pose2D(0.0, 0.0)


def test_stamps_that_do_not_increase_are_left_out_and_counted(tmp_path):
    def change(topic, message, index):
        if topic == "/scan" and index in (40, 80):
            message.header.stamp.sec -= 1 if index == 80 else 0
            message.header.stamp.nanosec -= 200_000_000 if index == 40 and message.header.stamp.nanosec else 0
        return message

    drive, steps, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    check_increasing(steps)
    assert len(scans) == 59
    assert "1 scans of /scan are not later than the one before, and are left out" in drive.remarks.lines


def test_a_clock_that_begins_again_begins_a_part(tmp_path):
    def change(topic, message, index):
        if index >= 120 and topic != "/tf_static":
            message.header.stamp.sec -= 500
        return message

    drive, steps, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert [step.begins_part for step in steps].count(True) == 1
    assert len(scans) == 60
    assert any("breaks in the odometry" in line for line in drive.remarks.lines)


def test_odometry_that_jumps_begins_a_part(tmp_path):
    def change(topic, message, index):
        if topic == "/odom" and index >= 120:
            message.pose.pose.position.x += 8.0
        return message

    _, steps, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert [step.begins_part for step in steps].count(True) == 1
    assert len(scans) >= 59


def test_stamps_on_another_clock_are_corrected(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.header.stamp.sec += 3600
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert len(scans) == 60
    assert any("+3600.0 s off the odometry's" in line.replace("-", "+") for line in drive.remarks.lines)


def test_stamps_that_are_all_zero_give_way_to_the_times_of_reception(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.header.stamp.sec = message.header.stamp.nanosec = 0
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert len(scans) == 60
    assert scans[0].time == pytest.approx(SHORT.begin)
    assert any("are all the same" in line for line in drive.remarks.lines)


def test_scans_that_jump_between_frames_are_placed_by_their_own(tmp_path):
    def change(topic, message, index):
        if topic == "/scan" and index % 8 == 4:
            message.header.frame_id = "base_link"
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert set(drive.lidars) == {"laser", "base_link"}
    assert {scan.mount for scan in scans} == {Pose2D(0.2, 0.0), Pose2D(0.0, 0.0)}
    assert len(scans) == 60


def test_frames_that_no_transform_ties_are_left_out_with_a_remark(tmp_path):
    def change(topic, message, index):
        if topic == "/scan" and index % 8 == 4:
            message.header.frame_id = "camera"
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert len(scans) == 30
    assert any("no transform says where 'camera' is" in line for line in drive.remarks.lines)


def test_values_of_rep_117_and_ranges_beyond_the_limits_are_told_apart(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.ranges[:6] = (np.inf, -np.inf, np.nan, 0.0, 65.5, -3.0)
        return message

    _, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    np.testing.assert_array_equal(scans[3].ranges[:6], [np.inf, -np.inf, np.nan, np.nan, np.inf, np.nan])


def test_an_angle_max_that_does_not_match_is_counted_and_the_increment_counts(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.angle_max = 3.0
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    np.testing.assert_allclose(scans[0].angles, SHORT.angles, atol=1e-5)
    assert any(line.startswith("60 scans of /scan end at another angle") for line in drive.remarks.lines)


def test_an_increment_of_zero_gives_way_to_angle_max(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.angle_increment = 0.0
        return message

    _, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    np.testing.assert_allclose(scans[0].angles, SHORT.angles, atol=1e-5)


def test_scans_of_changing_numbers_of_beams_are_moved_to_the_same_ones(tmp_path):
    def change(topic, message, index):
        if topic == "/scan" and index % 20 == 0:
            message.ranges = message.ranges[:-3]
            message.angle_max -= 3 * message.angle_increment
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert {len(scan.ranges) for scan in scans} == {180}
    assert np.isnan(scans[0].ranges[-3:]).all()
    np.testing.assert_allclose(scans[0].ranges[:-3], SHORT.scan(0)[:-3], rtol=1e-5)
    assert "12 scans of /scan have other beams than most: moved to the nearest ones" in drive.remarks.lines


def test_a_time_increment_is_kept_where_it_can_be_and_refused_where_not(tmp_path):
    def change(increment):
        def apply(topic, message, index):
            if topic == "/scan":
                message.time_increment = increment
            return message

        return apply

    _, steps, scans = read(write_bag(tmp_path / "good", SHORT, change=change(0.001)))
    assert scans[0].time_increment == pytest.approx(0.001)
    check_increasing(steps)
    for name, value in (("slow", 0.2), ("negative", -0.001)):
        drive, _, scans = read(write_bag(tmp_path / name, SHORT, change=change(value)))
        assert scans[0].time_increment == 0.0
        assert any("does not fit a scan every 0.2 s" in line for line in drive.remarks.lines)


def test_beams_that_meet_the_robot_itself_are_left_out(tmp_path):
    def change(topic, message, index):
        if topic == "/scan":
            message.ranges[:9] = 0.31
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", Drive(seconds=60.0, rate=2.0), change=change))
    assert np.isnan(scans[0].ranges[:9]).all()
    assert np.isfinite(scans[0].ranges[9:]).all()
    assert "9 beams of /scan always meet the robot itself: left out" in drive.remarks.lines


def test_two_topics_of_one_lidar_give_one(tmp_path):
    bag = tmp_path / "bag"
    write_bag(bag, SHORT, rename={"/tf": "/tf"})
    drive, _, _ = read(bag, scan_topics=["/scan"])
    assert drive.lidars == ("laser",)


def test_what_can_be_read_of_a_bag_that_was_cut_off_is_used(tmp_path):
    bag = write_bag(tmp_path / "bag", Drive(seconds=40.0, beams=2000))
    (file,) = bag.glob("*.mcap")
    content = file.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[: len(content) * 9 // 10])
    drive, _, scans = read(cut)
    assert 0 < len(scans) < 200
    assert any("cut off or damaged" in line for line in drive.remarks.lines)
    assert drive.damage


def test_values_that_are_not_finite_are_left_out_and_counted(tmp_path):
    def change(topic, message, index):
        if topic == "/odom" and index == 50:
            message.pose.pose.position.x = math.nan
        if topic == "/scan" and index == 40:
            message.angle_min = math.nan
        return message

    drive, _, scans = read(write_bag(tmp_path / "bag", SHORT, change=change))
    assert len(scans) == 59
    assert "1 messages of the odometry are not finite, and are left out" in drive.remarks.lines


def test_what_is_no_bag_is_refused(tmp_path):
    shutil.copy(__file__, tmp_path / "run.mcap")
    with pytest.raises(InputError, match=r"run\.mcap"):
        open_drive(tmp_path / "run.mcap")
    with pytest.raises(InputError, match="no such file"):
        open_drive(tmp_path / "none.mcap")
