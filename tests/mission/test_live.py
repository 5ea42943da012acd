"""Runs in real time; the clock is made up, so that no test depends on how busy the computer is."""

import math
import random
import threading

import pytest

from trundle.errors import InputError
from trundle.mission import End, LiveRun, Manual, Outcome, Pause, Restart, Session, SetGoal, Speed, Steering, StepOnce
from trundle.mission.steering.live import Pace
from trundle.navigation import CommandScript

GOAL = (3.0, 4.5)


class Wall:
    """Real time [s] that passes only while somebody waits, and by `work_s` in every control period."""

    def __init__(self, monkeypatch):
        self.now = 1000.0
        monkeypatch.setattr("time.monotonic", lambda: self.now)
        monkeypatch.setattr(Steering, "wait", lambda steering, timeout_s=None: self._wait(steering, timeout_s))
        self.calls = []

    def at(self, when, what):
        """Call `what` when real time has come to `when` [s] after now."""
        self.calls.append((self.now + when, what))
        self.calls.sort(key=lambda call: call[0])

    def _wait(self, steering, timeout_s):
        until = math.inf if timeout_s is None else self.now + timeout_s
        while self.calls and self.calls[0][0] <= until and steering.waiting == 0:
            self.now, what = self.calls.pop(0)
            what()
        if steering.waiting:
            return True
        assert until < math.inf
        self.now = until
        return False


class Marks:
    """An observer that notes at what real time each step ended."""

    def __init__(self, wall, work_s=0.0):
        self.wall, self.work_s, self.times = wall, work_s, []

    def on_start(self, run):
        pass

    def on_step(self, step):
        self.wall.now += self.work_s
        self.times.append((self.wall.now - 1000.0, step.state.time))

    def on_end(self, episode):
        pass


@pytest.fixture
def wall(monkeypatch):
    return Wall(monkeypatch)


def run_live(make_sim, start, wall, *, seconds=2.0, speed=1.0, work_s=0.0, directives=()):
    """Drive a script, with directives at real times; what was noted, and the live run."""
    steering, marks = Steering(), Marks(wall, work_s)
    for when, directive in directives:
        wall.at(when, lambda directive=directive: steering.put(directive))
    script = CommandScript([(0.1, 0.0, seconds)])
    live = LiveRun(
        lambda _: Session(make_sim(), script, start, observers=[marks], measure=None, steering=steering),
        steering,
        speed=speed,
    )
    episode = live.run()
    assert episode.outcome in (Outcome.FINISHED, Outcome.ABORTED)
    return marks.times, live


@pytest.mark.parametrize("speed", [0.1, 1.0, 10.0, 50.0])
def test_a_run_takes_the_real_time_of_its_speed(make_sim, start, wall, speed):
    times, _ = run_live(make_sim, start, wall, speed=speed)
    assert len(times) == 41
    for real, simulated in times[1:]:
        assert real == pytest.approx((simulated - 0.05) / speed, abs=1e-9)


def test_a_run_at_most_speed_never_waits(make_sim, start, wall):
    times, live = run_live(make_sim, start, wall, speed=math.inf)
    assert {real for real, _ in times} == {0.0}
    assert live.status.speed == math.inf


def test_a_pause_holds_the_time_without_drift(make_sim, start, wall):
    times, _ = run_live(make_sim, start, wall, directives=[(0.525, Pause()), (7.3, Pause(False))])
    before = [real for real, _ in times if real < 1.0]
    after = [real for real, _ in times if real >= 1.0]
    assert before[-1] == pytest.approx(0.5)
    assert after[0] == pytest.approx(7.3)
    assert after == pytest.approx([7.3 + 0.05 * k for k in range(len(after))])
    assert len(before) + len(after) == 41


def test_a_paused_run_steps_at_once_and_by_one_period(make_sim, start, wall):
    steps = [(1.0, StepOnce()), (1.5, StepOnce()), (2.5, End("enough"))]
    times, live = run_live(make_sim, start, wall, directives=[(0.02, Pause()), *steps])
    assert times[-2:] == [pytest.approx((1.0, 0.1)), pytest.approx((1.5, 0.15))]
    assert live.status.time == pytest.approx(0.15)
    assert live.status.factor == 0.0


def test_another_speed_counts_from_now_on(make_sim, start, wall):
    times, live = run_live(make_sim, start, wall, directives=[(0.92, Speed(10.0))])
    assert times[19] == pytest.approx((0.9, 0.95))
    assert times[-1][0] == pytest.approx(0.92 + 0.005 * 20)
    assert live.status.speed == 10.0


def test_a_computer_that_is_too_slow_reports_its_speed_and_does_not_hurry_later(make_sim, start, wall):
    times, live = run_live(make_sim, start, wall, seconds=4.0, work_s=0.1)
    assert times[-1][0] == pytest.approx(0.1 * 81, abs=0.3)
    assert live.status.state == "ended"
    pace = Pace()
    for k in range(30):
        pace.mark(0.05 * k)
        wall.now += 0.1
    assert pace.factor == pytest.approx(0.5)
    assert pace.left_s(5.0, 1.0) == 0.0
    wall.now += 10.0
    assert pace.left_s(5.05, 1.0) == 0.0
    assert pace.left_s(5.10, 1.0) == pytest.approx(0.05)


def test_restarts_make_new_sessions_with_the_seed_that_was_asked_for(make_sim, navigator, start):
    steering, seeds = Steering(), []

    def make(seed):
        seeds.append(seed)
        return Session(make_sim(), navigator, start, GOAL, steering=steering, seed=seed or 0)

    live = LiveRun(make, steering, speed=math.inf)
    assert live.status.state == "idle"
    for directive in (Pause(), StepOnce(), Restart("next")):
        steering.put(directive)
    steering.put(Restart(), run=2)
    steering.put(Restart(7), run=3)
    episode = live.run()
    assert (episode.outcome, episode.seed, seeds) == (Outcome.ARRIVED, 7, [None, 1, 1, 7])
    assert (live.status.state, live.status.run, live.status.speed) == ("ended", 4, math.inf)


def test_a_live_run_in_another_thread_is_paused_and_ended(make_sim, navigator, start):
    steering = Steering()
    live = LiveRun(lambda _: Session(make_sim(), navigator, start, GOAL, steering=steering), steering)
    episodes = []
    thread = threading.Thread(target=lambda: episodes.append(live.run()))
    steering.put(Pause())
    thread.start()
    steering.put(End("seen enough"))
    thread.join(60.0)
    assert [episode.message for episode in episodes] == ["seen enough"]


def test_directives_after_the_end_are_refused_and_not_kept_for_the_next_run(make_sim, navigator, start):
    steering, said = Steering(), []
    live = LiveRun(lambda _: Session(make_sim(), navigator, start, GOAL, steering=steering), steering)
    steering.put(End())
    steering.put(Pause(), refused=said.append)
    assert live.run().outcome is Outcome.ABORTED
    assert said == ["the run has ended"]
    assert steering.waiting == 0


def test_ctrl_c_ends_a_live_run(make_sim, navigator, start, monkeypatch):
    def interrupt(self, timeout_s=None):
        raise KeyboardInterrupt

    monkeypatch.setattr(Steering, "wait", interrupt)
    steering, sessions = Steering(), []

    def make(_):
        sessions.append(Session(make_sim(), navigator, start, GOAL, steering=steering))
        return sessions[-1]

    assert LiveRun(make, steering).run().message == "stopped by Ctrl-C"
    assert isinstance(sessions[0].error, KeyboardInterrupt)


@pytest.mark.parametrize("speed", [0.0, -1.0, 51.0, math.nan, "fast"])
def test_a_speed_out_of_range_is_refused(speed):
    with pytest.raises(InputError, match="the speed of a run"):
        LiveRun(lambda _: None, Steering(), speed=speed)


# Orders and their runs ------------------------------------------------------------------------------------------------


class AtEnd:
    """An observer that calls something at the end of a run, when it takes no more orders."""

    def __init__(self, call):
        self.call = call

    def on_start(self, run):
        pass

    def on_step(self, step):
        pass

    def on_end(self, episode):
        self.call(episode)


CLICKS = [End("a late click"), SetGoal((5.0, 1.0)), Pause(), Manual(0.2, 0.0), Restart(9), Speed(0.5)]


@pytest.mark.parametrize("click", CLICKS, ids=lambda click: type(click).__name__)
def test_a_click_between_two_runs_is_refused_and_does_not_reach_the_next_one(make_sim, navigator, start, click):
    steering, said, sessions = Steering(), [], []
    late = AtEnd(lambda _: steering.put(click, refused=said.append) if len(sessions) == 1 else None)

    def make(seed):
        sessions.append(Session(make_sim(), navigator, start, GOAL, steering=steering, observers=[late]))
        return sessions[-1]

    steering.put(Restart())
    episode = LiveRun(make, steering, speed=math.inf).run()
    assert said == ["the run has ended"]
    assert (episode.outcome, len(sessions)) == (Outcome.ARRIVED, 2)
    assert [given.directive for given in episode.directives] == [Speed(math.inf)]


def test_what_is_put_after_a_restart_is_refused_with_a_reason(make_sim, navigator, start):
    steering, said = Steering(), []
    assert not steering.is_restarting
    steering.put(Restart())
    assert steering.is_restarting
    for click in CLICKS:
        steering.put(click, refused=said.append)
    live = LiveRun(lambda _: Session(make_sim(), navigator, start, GOAL, steering=steering), steering, speed=math.inf)
    episode = live.run()
    assert (episode.outcome, live.status.run, live.status.speed) == (Outcome.ARRIVED, 2, math.inf)
    assert said == ["the run is about to start again: wait until it has"] * len(CLICKS)
    assert not steering.is_restarting


def test_an_order_for_the_next_run_waits_for_it(make_sim, navigator, start):
    steering = Steering()
    steering.put(End("the second one"), run=2)
    steering.put(Restart())
    live = LiveRun(lambda _: Session(make_sim(), navigator, start, GOAL, steering=steering), steering, speed=math.inf)
    assert (live.run().message, live.status.run) == ("the second one", 2)


def test_orders_of_sessions_one_after_another_do_not_mix(make_sim, navigator, start):
    steering, said = Steering(), []
    for number in (1, 2, 3):
        session = Session(make_sim(), navigator, start, GOAL, steering=steering)
        assert steering.run == number
        steering.put(End(f"of run {number}"))
        assert session.run().message == f"of run {number}"
        steering.put(End("too late"), refused=said.append)
        steering.put(End("far too late"), run=1, refused=said.append)
    assert said == ["the run has ended"] * 3 + ["run 1 has ended", "the run has ended", "run 1 has ended"]


def test_a_session_that_never_ended_leaves_no_orders_to_the_next_one(make_sim, navigator, start):
    steering, said = Steering(), []
    Session(make_sim(), navigator, start, GOAL, steering=steering)
    steering.put(End(), refused=said.append)
    second = Session(make_sim(), navigator, start, GOAL, steering=steering)
    assert said == ["another run has begun"]
    assert second.run().outcome is Outcome.ARRIVED


def test_a_watcher_of_a_goal_for_a_run_that_has_ended_hears_why(make_sim, navigator, start):
    class Watcher:
        refused = None

        def begin(self, time):
            raise AssertionError

        end = begin

        def refuse(self, error):
            self.refused = error

    steering, watcher = Steering(), Watcher()
    Session(make_sim(), navigator, start, GOAL, steering=steering).finish()
    steering.put(SetGoal((5.0, 1.0)), watcher=watcher)
    assert isinstance(watcher.refused, InputError)
    assert str(watcher.refused) == "the run has ended"


@pytest.mark.parametrize("run", [0, -1, 1.5, "2", True])
def test_a_number_that_is_no_run_is_refused(run):
    with pytest.raises(InputError, match="number of a run"):
        Steering().put(Pause(), run=run)


def test_many_threads_that_click_at_random_reach_only_the_run_that_they_saw(make_sim, navigator, start):
    """Every order is answered once, and each run gets the orders of its own number alone."""
    steering, answers, over = Steering(), [], threading.Event()
    given = [0] * 4
    runs = 12

    def make(_):
        return Session(make_sim(), navigator, start, GOAL, steering=steering, observers=[AtEnd(check)], name="run")

    seen = []

    def check(episode):
        number = steering.run
        seen.append(number)
        texts = [entry.by for entry in episode.directives if entry.by.startswith("click")]
        assert {text for text in texts if text != f"click {number}"} == set()

    def click(thread):
        rng = random.Random(thread)
        while not over.wait(rng.uniform(0.0, 0.002)):
            run = steering.run
            directive = Restart() if rng.random() < 0.1 and run < runs else Pause(False)
            note = lambda *_: answers.append(thread)  # noqa: E731
            steering.put(directive, by=f"click {run}", refused=note, applied=note, run=run)
            given[thread] += 1
            if run >= runs:
                steering.put(End(), by=f"click {run}", run=run)

    threads = [threading.Thread(target=click, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    live = LiveRun(make, steering, speed=50.0)
    try:
        episode = live.run()
    finally:
        over.set()
        for thread in threads:
            thread.join(60.0)
    assert not episode.observer_errors
    assert seen == list(range(1, live.status.run + 1))
    assert [answers.count(number) for number in range(4)] == given
    assert steering.waiting == 0
