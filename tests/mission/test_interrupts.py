"""Ctrl-C while a run is driven in real time, wherever it comes."""

import math
import signal
import threading

import pytest

from trundle.mission import LiveRun, Restart, Session, Steering
from trundle.mission.steering import live

GOAL = (3.0, 4.5)


class Acts:
    """An observer that does something in every control period but the first, and counts those that it came through."""

    def __init__(self, act):
        self.act, self.periods = act, 0

    def on_start(self, run):
        pass

    def on_step(self, step):
        if step.index:
            self.act()
            self.periods += 1

    def on_end(self, episode):
        pass


class Pressed(threading.Condition):
    """A lock that a Ctrl-C finds when it was just taken."""

    def __enter__(self):
        taken = super().__enter__()
        signal.raise_signal(signal.SIGINT)
        return taken


@pytest.fixture
def drive(make_sim, navigator, start):
    """Drives a run, by `steering` if that is given, whose observer acts."""

    def drive(act, steering=None):
        steering, acts, sessions = steering or Steering(), Acts(act), []

        def make(_):
            sessions.append(Session(make_sim(), navigator, start, GOAL, steering=steering, observers=[acts]))
            return sessions[-1]

        episode = LiveRun(make, steering, speed=math.inf).run()
        assert isinstance(sessions[-1].error, KeyboardInterrupt) == (episode.message == "stopped by Ctrl-C")
        return episode, acts.periods, len(sessions)

    before = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored
    yield drive
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_leaves_no_lock_behind(drive):
    lock = Pressed()

    def act():
        with lock:
            pass

    episode, periods, _ = drive(act)
    assert (episode.message, periods) == ("stopped by Ctrl-C", 1)
    free = []
    other = threading.Thread(target=lambda: free.append(lock.acquire(blocking=False)))
    other.start()
    other.join()
    assert free == [True]


def test_ctrl_c_is_not_lost_where_python_drops_exceptions(drive):
    class Dropped:
        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    episode, periods, _ = drive(Dropped)
    assert (episode.message, periods) == ("stopped by Ctrl-C", 1)


def test_a_second_ctrl_c_interrupts_the_control_period(drive):
    def act():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    episode, periods, _ = drive(act)
    assert (episode.message, periods) == ("stopped by Ctrl-C", 0)


def test_a_control_period_that_goes_on_is_interrupted(drive, monkeypatch):
    monkeypatch.setattr(live, "PATIENCE_S", 0.01)

    def act():
        signal.raise_signal(signal.SIGINT)
        threading.Event().wait(600.0)

    episode, periods, _ = drive(act)
    assert (episode.message, periods) == ("stopped by Ctrl-C", 0)


def test_ctrl_c_at_a_restart_ends_it(drive):
    steering = Steering()

    def act():
        steering.put(Restart())
        signal.raise_signal(signal.SIGINT)

    *_, runs = drive(act, steering)
    assert runs == 1
