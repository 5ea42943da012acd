"""Where something was seen to move, remembered for a minute."""

import numpy as np

from support.walls import CARTER, Surroundings
from trundle.geometry import Pose2D
from trundle.navigation.obstacle_watch import KEPT_S, MoverMemory
from trundle.observation import Track
from trundle.tracking import Tracker, TrackerSettings

HERE = Pose2D(0.0, 0.0)


def track(x, y, *, confirmed=True):
    return Track(1, 0.0, x, y, 0.0, 0.0, np.eye(4), 0.3, confirmed)


def test_it_remembers_where_a_confirmed_track_was_after_it_ended():
    memory = MoverMemory()
    memory.note([track(2.0, 1.0), track(8.0, 1.0, confirmed=False)], 0.0)
    memory.note([], KEPT_S)
    assert memory.was_near(2.5, 1.0, 0.25)
    assert not memory.was_near(3.0, 1.0, 0.25)
    assert not memory.was_near(8.0, 1.0, 1.0)


def test_after_a_minute_it_forgets():
    memory = MoverMemory()
    memory.note([track(2.0, 1.0)], 0.0)
    memory.note([], KEPT_S + 0.1)
    assert not memory.was_near(2.0, 1.0, 1.0)


def test_it_forgets_where_the_time_goes_back_and_when_it_is_cleared():
    memory = MoverMemory()
    memory.note([track(2.0, 1.0)], 5.0)
    memory.note([], 0.0)
    assert not memory.was_near(2.0, 1.0, 1.0)
    memory.note([track(2.0, 1.0)], 1.0)
    memory.clear()
    assert not memory.was_near(2.0, 1.0, 1.0)
    memory.note([track(2.0, 1.0)], 1.0)
    assert memory.was_near(2.0, 1.0, 1.0)


def test_places_of_a_track_that_no_scan_sees_are_not_kept():
    robot = CARTER.model_copy(update={"lidars": {"front": CARTER.lidars["front"]}})
    tracker, memory = Tracker(robot, TrackerSettings(hidden_s=3.0)), MoverMemory()
    wall = (2.0, 0.0, 2.0, 3.0)  # hides who walks behind it at x = 3
    ends = []
    for tick in range(120):
        time, y = 0.05 * tick, -4.0 + 0.05 * tick
        scans = [Surroundings([wall], [(3.0, y, 0.25)]).scan(time, HERE)] if tick % 2 == 0 else []
        tracks = tracker.update(scans, time, HERE)
        memory.note(tracks, time)
        ends.extend(track.y for track in tracks if track.confirmed)
    assert max(ends) > 1.0
    assert -1.0 < memory.recent[:, 1].max() < 0.5
    assert len(memory.recent) > 3


def test_places_of_a_track_that_stands_still_are_kept():
    memory = MoverMemory()
    for tick in range(100):
        memory.note([track(2.0, 1.0)], 0.1 * tick)
    assert len(memory.recent) > 8
