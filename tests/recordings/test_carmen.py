"""CARMEN logs: kinds of lines, conventions of beams, offsets, and times that are broken."""

from __future__ import annotations

import gzip
import math

import numpy as np
import pytest

from support.room_drives import Drive, write_carmen
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.recordings import open_drive

SHORT = Drive(seconds=12.0, beams=181, fov=math.pi)


def read(path, **options):
    drive = open_drive(path, **options)
    steps = list(drive.steps())
    return drive, steps, [scan for step in steps for scan in step.observation.scans]


def flaser(count, *, pose=(1.0, 2.0, 0.1), time=1.0, first=2.0, kind="FLASER", laser=None):
    ranges = " ".join(f"{first + 0.01 * number:.2f}" for number in range(count))
    place = " ".join(map(str, (*(laser or pose), *pose)))
    return f"{kind} {count} {ranges} {place} {time} host {time}"


def log(tmp_path, *lines):
    path = tmp_path / "drive.log"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_scans_odometry_and_offset_are_read(tmp_path):
    drive, steps, scans = read(write_carmen(tmp_path / "drive.clf", SHORT))
    assert (len(scans), drive.scans, drive.knows_robot) == (60, 60, False)
    assert scans[0].mount == Pose2D(0.2, 0.0)
    np.testing.assert_allclose(scans[0].ranges, SHORT.scan(0), atol=1e-3)
    np.testing.assert_allclose(scans[0].angles, SHORT.angles)
    np.testing.assert_allclose(steps[-1].observation.odometry.x, SHORT.odometry[-4, 0], atol=1e-5)
    assert drive.remarks.lines == ()


@pytest.mark.parametrize(
    ("count", "last"), [(180, 89.0), (181, 90.0), (360, 89.5), (361, 90.0), (91, 90.0)], ids=lambda value: str(value)
)
def test_beams_have_the_directions_that_carmen_gives_them(tmp_path, count, last):
    lines = [flaser(count, pose=(0.1 * number, 0.0, 0.0), time=number) for number in range(1, 4)]
    _, _, scans = read(log(tmp_path, *lines))
    assert math.degrees(scans[0].angles[0]) == pytest.approx(-90.0)
    assert math.degrees(scans[0].angles[-1]) == pytest.approx(last)


def test_a_rear_laser_looks_back(tmp_path):
    lines = ["PARAM robot_rearlaser_offset -0.3 host 0"]
    for number in range(1, 4):
        pose = (0.1 * number, 0.0, 0.0)
        lines += [flaser(180, pose=pose, time=number), flaser(180, pose=pose, time=number + 0.1, kind="RLASER")]
    drive, _, scans = read(log(tmp_path, *lines))
    assert drive.lidars == ("front", "rear")
    assert next(scan for scan in scans if scan.lidar == "rear").mount == Pose2D(-0.3, 0.0, math.pi)


def test_the_poses_of_laser_and_robot_say_where_the_laser_is(tmp_path):
    lines = [
        flaser(180, pose=(number, 0.0, 0.0), laser=(number + 0.25, 0.05, 0.0), time=number) for number in range(1, 5)
    ]
    _, _, scans = read(log(tmp_path, *lines))
    assert scans[0].mount.as_tuple() == pytest.approx((0.25, 0.05, 0.0))


def test_robotlaser_lines_bring_their_own_angles(tmp_path):
    lines = []
    for number in range(1, 5):
        ranges = " ".join(["2.5"] * 11)
        poses = f"{number}.3 0 0 {number} 0 0"
        lines.append(
            f"ROBOTLASER1 0 -1.0 2.0 0.2 30.0 0.01 0 11 {ranges} 2 7 8 {poses} 0 0 0 0 0 {number} host {number}"
        )
    _, steps, scans = read(log(tmp_path, *lines))
    np.testing.assert_allclose(scans[0].angles, np.linspace(-1.0, 1.0, 11))
    assert scans[0].mount.x == pytest.approx(0.3)
    assert steps[0].observation.odometry.x == 1.0


def test_rawlaser_lines_take_the_odometry_of_odom_lines(tmp_path):
    lines = []
    for number in range(1, 6):
        ranges = " ".join(["2.5"] * 11)
        lines.append(f"ODOM {number} 0 0 0 0 0 {number} host {number}")
        lines.append(f"RAWLASER1 0 -1.0 2.0 0.2 30.0 0.01 0 11 {ranges} 0 {number + 0.5} host {number + 0.5}")
    drive, steps, _ = read(log(tmp_path, *lines))
    assert drive.odometry == "ODOM lines"
    assert steps[1].observation.odometry.x == pytest.approx(2.5)


def test_times_that_go_back_are_estimated_from_the_motion(tmp_path):
    drive, steps, scans = read(
        write_carmen(tmp_path / "drive.log", SHORT, times=lambda index, time: time - (3.0 if index == 80 else 0.0))
    )
    times = [step.observation.time for step in steps]
    assert (np.diff(times) > 0.0).all()
    assert len(scans) == 60
    assert any("times are not after the one before" in line for line in drive.remarks.lines)


@pytest.mark.parametrize("broken", [lambda index, time: 1.13486e9, lambda index, time: 1e4 * round(time / 7.0)])
def test_times_that_are_rounded_away_are_all_estimated(tmp_path, broken):
    drive, steps, scans = read(write_carmen(tmp_path / "drive.log", SHORT, times=broken))
    times = np.array([step.observation.time for step in steps])
    assert (np.diff(times) > 0.0).all()
    assert 5.0 < times[-1] - times[0] < 60.0
    assert len(scans) == 60
    assert drive.remarks.lines[0].startswith("the times of the log are broken")


def test_ranges_without_a_return_are_not_measured(tmp_path):
    lines = ["PARAM robot_front_laser_max 80.0 host 0"]
    lines += [flaser(180, pose=(0.1 * number, 0, 0), time=number).replace("2.00", "81.91") for number in range(1, 4)]
    _, _, scans = read(log(tmp_path, *lines))
    assert np.isnan(scans[0].ranges[0])
    assert scans[0].range_max == 80.0


def test_a_gzipped_log_that_was_cut_off_is_used_up_to_there(tmp_path):
    whole = gzip.compress(write_carmen(tmp_path / "drive.log", SHORT).read_bytes())
    (tmp_path / "cut.log.gz").write_bytes(whole[: len(whole) * 2 // 3])
    drive, _, scans = read(tmp_path / "cut.log.gz")
    assert 20 < len(scans) < 60
    assert any("cut off or damaged" in line for line in drive.remarks.lines)
    assert drive.damage


def test_damaged_lines_are_left_out_and_counted(tmp_path):
    lines = [flaser(180, pose=(0.1 * number, 0, 0), time=number) for number in range(1, 6)]
    lines[1] = lines[1][:200]
    lines[2] = lines[2].replace("2.05", "x")
    drive, _, scans = read(log(tmp_path, *lines, "FLASER -4 1 2", "FLASER 99999999999 1", "ODOM 1 nan 0 0 0 0 1 h 1"))
    assert len(scans) == 3
    assert "5 lines of the log are damaged, and left out" in drive.remarks.lines


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no scans"),
        (b"hello\nworld\n", "no scans"),
        (b"\x00\x01\x02" * 100, "not a CARMEN log: it is not text"),
        (b"ODOM 1 2 3 0 0 0 1 h 1\n", "no scans"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path, content, said):
    (tmp_path / "some.log").write_bytes(content)
    with pytest.raises(InputError, match=said):
        open_drive(tmp_path / "some.log")


def test_a_log_without_odometry_is_refused_with_the_reason(tmp_path):
    ranges = " ".join(["2.5"] * 11)
    lines = [f"RAWLASER1 0 -1.0 2.0 0.2 30.0 0.01 0 11 {ranges} 0 {number} h {number}" for number in range(5)]
    with pytest.raises(InputError, match="no odometry: its scans have no pose, and it has no ODOM lines"):
        open_drive(log(tmp_path, *lines))


def test_topics_are_for_bags(tmp_path):
    with pytest.raises(InputError, match="a CARMEN log has none"):
        open_drive(write_carmen(tmp_path / "drive.log", SHORT), scan_topics=["/scan"])
