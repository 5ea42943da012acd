import pytest

from trundle.evaluation.pool import workers as module
from trundle.evaluation.pool.workers import Deadlines


@pytest.fixture
def clock(monkeypatch):
    class Clock:
        now = 100.0

        def monotonic(self):
            return self.now

    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


def test_times_of_several_lengths_pass_in_their_order(clock):
    deadlines = Deadlines()
    assert deadlines.soonest() is None
    deadlines.set(1, 10.0)
    deadlines.set(2, 3.0)
    clock.now = 101.0
    deadlines.set(3, 3.0)
    deadlines.set(4, None)
    assert deadlines.soonest() == 103.0
    assert deadlines.take_passed() == []
    clock.now = 104.0
    assert sorted(deadlines.take_passed()) == [2, 3]
    assert deadlines.soonest() == 110.0
    assert deadlines.take_passed() == []


def test_a_new_time_replaces_the_one_before(clock):
    deadlines = Deadlines()
    deadlines.set(1, 10.0)
    deadlines.set(1, 20.0)
    assert deadlines.soonest() == 120.0
    deadlines.clear(1)
    deadlines.clear(1)
    assert deadlines.soonest() is None
