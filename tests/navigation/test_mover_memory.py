"""Where something was seen to move, remembered for a minute."""

import numpy as np

from trundle.navigation.obstacle_watch import KEPT_S, MoverMemory
from trundle.observation import Track


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
