import math

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.observation import Estimate, PoseBuffer, Scan, check_scans


def make_scan(angles=(0.0, 1.0), ranges=(1.0, math.inf), **changes):
    values = {"lidar": "front", "time": 0.5, "mount": Pose2D(0.2, 0.1, math.pi / 2), "height": 0.4}
    limits = {"range_min": 0.1, "range_max": 10.0}
    return Scan(**{**values, "angles": angles, "ranges": ranges, **limits, **changes})


def test_the_points_of_a_scan_are_in_base_link():
    scan = make_scan(angles=[0.0, math.pi / 2, 0.0, 0.0, 0.0], ranges=[2.0, 1.0, math.inf, -math.inf, 11.0])
    assert scan.points() == pytest.approx(np.array([[0.2, 2.1], [-0.8, 0.1]]))


def test_the_arrays_of_a_scan_are_read_only_copies():
    angles = np.array([0.0, 1.0])
    scan = make_scan(angles=angles)
    angles[0] = 5.0
    assert scan.angles[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        scan.ranges[0] = 3.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ranges": [1.0]}, "as many ranges as angles"),
        ({"angles": [[0.0, 1.0]], "ranges": [[1.0, 1.0]]}, "one dimension"),
        ({"angles": [0.0, math.nan]}, "not finite"),
        ({"ranges": [1.0, -0.5]}, "negative"),
        ({"range_max": 0.05}, "not below"),
        ({"range_min": math.nan}, "range_min must be"),
        ({"time": math.inf}, "time must be"),
        ({"time_increment": -1.0}, "time_increment must be"),
        ({"mount": (0.0, 0.0, 0.0)}, "Pose2D"),
    ],
)
def test_a_scan_that_cannot_be_is_refused(changes, message):
    with pytest.raises(InputError, match=message):
        make_scan(**changes)


def test_ranges_without_a_measurement_are_kept():
    scan = make_scan(ranges=[math.nan, -math.inf])
    assert scan.points().shape == (0, 2)


def test_what_is_no_scan_is_refused():
    assert len(check_scans([make_scan()])) == 1
    with pytest.raises(InputError, match="scans=\\[scan\\]"):
        check_scans([1.0])
    with pytest.raises(InputError, match="scans=\\[scan\\]"):
        check_scans(make_scan())


def test_an_estimate_knows_the_pose_in_odom():
    estimate = Estimate(0.0, Pose2D(3.0, 2.0, math.pi / 2), None, Pose2D(1.0, 2.0, math.pi / 2))
    assert estimate.odom_pose.as_tuple() == pytest.approx((0.0, -2.0, 0.0))


def test_poses_between_two_times_are_interpolated():
    buffer = PoseBuffer()
    assert buffer.at(0.0) is None
    buffer.add(1.0, Pose2D(0.0, 0.0, 3.0))
    assert buffer.at(1.05) == Pose2D(0.0, 0.0, 3.0)
    buffer.add(2.0, Pose2D(1.0, 2.0, -3.0))
    assert buffer.at(1.5).as_tuple() == pytest.approx((0.5, 1.0, math.pi), abs=1e-9)
    assert buffer.at(2.1).as_tuple()[:2] == pytest.approx((1.1, 2.2))
    assert buffer.at(0.5) is None
    assert buffer.at(2.2) is None
    with pytest.raises(InputError, match="times must increase"):
        buffer.add(2.0, Pose2D(0.0, 0.0))


def test_old_poses_are_forgotten():
    buffer = PoseBuffer()
    for step in range(1000):
        buffer.add(0.1 * step, Pose2D(float(step), 0.0))
    assert buffer.at(50.0) is None
    assert buffer.at(95.0).x == pytest.approx(950.0)


def test_a_pose_is_looked_up_again_when_there_are_newer_ones():
    buffer = PoseBuffer()
    buffer.add(1.0, Pose2D(0.0, 0.0))
    buffer.add(2.0, Pose2D(1.0, 0.0))
    assert buffer.at(2.05).x == buffer.at(2.05).x == pytest.approx(1.05)
    buffer.add(2.1, Pose2D(3.0, 0.0))
    assert buffer.at(2.05).x == pytest.approx(2.0)
    buffer.clear()
    assert buffer.at(2.05) is None
