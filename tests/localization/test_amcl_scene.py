"""When the lidars suddenly see another place."""

import math

import numpy as np
import pytest

from trundle.geometry import Pose2D
from trundle.localization.amcl.scene import Scene
from trundle.observation import Scan

ANGLES = np.linspace(-math.pi, math.pi, 360, endpoint=False)


def room(width, depth, *, at=(0.0, 0.0), yaw=0.0):
    """Ranges in a room of this size round (0, 0), from a place in it."""
    across, along = np.cos(ANGLES + yaw), np.sin(ANGLES + yaw)
    with np.errstate(divide="ignore"):
        x = np.where(across > 0.0, 0.5 * width - at[0], -0.5 * width - at[0]) / across
        y = np.where(along > 0.0, 0.5 * depth - at[1], -0.5 * depth - at[1]) / along
    return np.minimum(x, y)


def scan(time, ranges, increment=1.0):
    return Scan("front", time, Pose2D(0.0, 0.0), 0.3, increment * ANGLES, ranges, 0.1, 12.0)


HALL = room(8.0, 6.0)
ELSEWHERE = room(4.0, 14.0)
CROWDED = np.where(np.abs(ANGLES) < 2.5, np.minimum(HALL, 1.2), HALL)


def says(*seen, odometry=()):
    """What a scene says of scans, each of which is surprising."""
    scene, poses = Scene(math.inf), [*odometry, *[Pose2D(0.0, 0.0)] * len(seen)]
    return [
        scene.is_another([scan(0.1 * k, ranges)], pose, surprising=True)
        for k, (ranges, pose) in enumerate(zip(seen, poses, strict=False))
    ]


def test_another_place_is_told_by_the_second_scan_of_it():
    assert says(HALL, HALL, ELSEWHERE, ELSEWHERE, ELSEWHERE) == [False, False, False, True, False]


def test_one_odd_scan_is_no_other_place():
    assert not any(says(HALL, ELSEWHERE, HALL, HALL))


def test_it_is_the_same_place_for_a_robot_that_drives_turns_and_slips():
    moves = [Pose2D(0.08 * k, 0.0, 0.07 * k) for k in range(8)]
    seen = [room(8.0, 6.0, at=(1.3 * move.x, 0.0), yaw=move.yaw + 0.02 * k) for k, move in enumerate(moves)]
    assert not any(says(*seen, odometry=moves))
    assert any(says(*[seen[0], *seen[5:], *seen[5:]]))  # an odometry that says nothing of it


@pytest.mark.parametrize("before", [HALL, CROWDED], ids=["come near", "leave"])
def test_people_who_come_near_or_leave_are_no_other_place(before):
    after = CROWDED if before is HALL else HALL
    assert not any(says(before, after, after, after))


def test_what_is_no_surprise_is_not_looked_at():
    scene = Scene(math.inf)
    for k, ranges in enumerate((HALL, ELSEWHERE, ELSEWHERE)):
        assert not scene.is_another([scan(0.1 * k, ranges)], Pose2D(0.0, 0.0), surprising=False)


def test_scans_that_are_far_apart_in_time_are_not_compared():
    scene = Scene(math.inf)
    for time, ranges in ((0.0, HALL), (2.0, ELSEWHERE), (4.0, HALL), (6.0, ELSEWHERE)):
        assert not scene.is_another([scan(time, ranges)], Pose2D(0.0, 0.0), surprising=True)


def test_a_lidar_that_turns_the_other_way_is_compared_as_well():
    scene = Scene(math.inf)
    seen = [HALL, HALL, room(8.0, 6.0, yaw=0.3), ELSEWHERE, ELSEWHERE]
    poses = [*[Pose2D(0.0, 0.0)] * 2, *[Pose2D(0.0, 0.0, 0.3)] * 3]
    said = [
        scene.is_another([scan(0.1 * k, ranges[(-np.arange(360)) % 360], -1.0)], pose, surprising=True)
        for k, (ranges, pose) in enumerate(zip(seen, poses, strict=True))
    ]
    assert said == [False, False, False, False, True]


def test_scans_without_a_return_tell_nothing():
    assert not any(says(HALL, np.full(360, math.inf), np.full(360, math.nan), np.full(360, -math.inf)))
