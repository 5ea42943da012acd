"""`LiveRun`: drives a session at a speed relative to real time, as directives say, until its end or Ctrl-C."""

from __future__ import annotations

import _thread
import math
import signal
import threading
import time as clock
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from types import FrameType
from typing import Literal, Self, TypeAlias

from trundle.mission.episode import Episode
from trundle.mission.observers import SteeringReport
from trundle.mission.running.session import Session
from trundle.mission.steering.directives import Speed
from trundle.mission.steering.queue import Steering

PATIENCE_S = 2.0
"""A control period that takes longer after Ctrl-C is interrupted where it is [s], real time."""

_Handler: TypeAlias = Callable[[int, FrameType | None], object]


class Interrupts:
    """Defers the handlers of SIGINT and SIGTERM to `check`; use it in a `with` block.

    A KeyboardInterrupt may be raised anywhere in Python's code: in `Condition.__enter__`, once the lock is taken, it
    leaves the lock held for ever, and in `__del__` or the callback of a weak reference it is dropped. So the program
    would hang, or go on. A handler is not deferred any longer than `PATIENCE_S`, or until the second signal.

    Outside the main thread, which alone gets signals, it does nothing.
    """

    def __init__(self) -> None:
        self._handlers: dict[int, _Handler] = {}
        self._pending: int | None = None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            found = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
            self._handlers = {number: handler for number, handler in found.items() if callable(handler)}
            for number in self._handlers:
                signal.signal(number, self._defer)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self.check()

    def check(self) -> None:
        """Call the handler of the signal that has come, which raises KeyboardInterrupt unless it was replaced."""
        number, self._pending = self._pending, None
        if number is not None:
            self._handlers[number](number, None)

    def _defer(self, number: int, frame: FrameType | None) -> None:
        if self._pending is not None:
            self._pending = None
            self._handlers[number](number, frame)
            return
        self._pending = number
        # Not a `Thread`, which takes locks to start: this may have interrupted whoever holds them.
        _thread.start_new_thread(self._insist, (number,))

    def _insist(self, number: int) -> None:
        clock.sleep(PATIENCE_S)
        if self._pending is not None:
            signal.pthread_kill(threading.main_thread().ident or 0, number)


_HELD_S = 1.0
"""A run that is held looks for its end this often [s], real time."""
_MOST_LAG_S = 0.25
_WINDOW_S = 1.0
"""How fast a run really passes is measured over so long [s], real time."""


State: TypeAlias = Literal["idle", "running", "paused", "waiting", "ended"]
"""What a live run does; see `LiveStatus`."""


@dataclass(frozen=True, slots=True)
class LiveStatus:
    """What a live run does now.

    Attributes:
        state: "idle" before the first run and between two of them, "running", "paused", "waiting" for another goal
            after a `WaitAtGoal`, or "ended".
        run: Number of the run, from 1; 0 before the first one.
        time: Simulated time [s].
        speed: How fast it is to pass relative to real time; infinity for as fast as it can.
        factor: How fast it really passed in the last second; 0 while it is paused.
        steering: How it is steered; None before the first run.
    """

    state: State
    run: int = 0
    time: float = 0.0
    speed: float = 1.0
    factor: float = 0.0
    steering: SteeringReport | None = None


class LiveRun:
    """Drives sessions in real time, or at another speed, in the thread that calls `run`.

        steering = Steering()
        live = LiveRun(lambda seed: Session(sim, navigator, start, goal, steering=steering, seed=seed or 0), steering)
        threading.Thread(target=live.run).start()
        steering.put(Speed(2.0))

    Directives are applied as soon as they come, also while it waits for the next control period or is paused. Each run
    takes only its own; those that are given after its end or after a `Restart` are refused until the next one begins.

    Ctrl-C ends the run between two control periods; see `Interrupts`.

    Args:
        make_session: Makes the session of each run, steered by `steering`, from its seed: None for the first run, and
            where a `Restart` keeps the seed.
        steering: Where directives come from.
        speed: How fast the first run passes relative to real time, 0.1 to 50, or infinity for as fast as it can; the
            next ones keep the speed.

    Attributes:
        status: What it does now, for any thread: it is replaced as a whole.
    """

    def __init__(
        self, make_session: Callable[[int | None], Session], steering: Steering, *, speed: float = 1.0
    ) -> None:
        self._make_session, self._steering = make_session, steering
        self._speed = Speed(speed)
        self._is_at_speed = True
        self._pace = Pace()
        self._is_interrupted = False
        self.status = LiveStatus("idle", speed=self._speed.factor)

    def run(self) -> Episode:
        """Drive until a run ends without a `Restart`; Ctrl-C ends it as aborted.

        Returns:
            The episode of the last run.

        Raises:
            BaseException: What a plug-in raised; see `Session.step`.
        """
        seed: int | None = None
        while True:
            session = self._make_session(seed)
            self.status = LiveStatus("running", self.status.run + 1, speed=self._speed.factor)
            try:
                episode = self._drive(session)
            except BaseException:
                self._steering.refuse_all("the run has ended")
                self._show(session, "ended")
                raise
            if session.restart is None or self._is_interrupted:
                self._steering.refuse_all("the run has ended")
                self._show(session, "ended")
                return episode
            self._show(session, "idle")
            if session.restart.seed is not None:
                seed = episode.seed + 1 if session.restart.seed == "next" else session.restart.seed

    def _drive(self, session: Session) -> Episode:
        pace, run = self._pace, self._steering.run
        pace.hold()
        self._is_at_speed = self._speed.factor == 1.0
        if not self._is_at_speed:
            self._steering.put(self._speed, by="start", applied=self._take_speed, run=run)
        try:
            with Interrupts() as interrupts:
                while session.outcome is None:
                    interrupts.check()
                    if not session.steer():
                        pace.hold()
                        report = session.steering
                        self._show(session, "paused" if report is None or report.paused else "waiting")
                        if session.outcome is None:
                            self._steering.wait(_HELD_S)
                        continue
                    report = session.steering
                    speed = math.inf if report is None or report.paused else report.speed
                    left_s = pace.left_s(session.time, speed)
                    if left_s > 0.0 and self._steering.wait(left_s):
                        continue
                    session.drive()
                    pace.mark(session.time)
                    self._show(session, "running")
        except KeyboardInterrupt as error:  # between two periods
            self._is_interrupted = True
            session.abort(error)
        return session.conclude()

    def _take_speed(self) -> None:
        self._is_at_speed = True

    def _show(self, session: Session, state: State) -> None:
        report = session.steering
        if report is not None and self._is_at_speed:  # else a restart came first: the next run has it
            self._speed = Speed(report.speed)
        factor = self._pace.factor if state == "running" else 0.0
        self.status = LiveStatus(state, self.status.run, session.time, self._speed.factor, factor, report)


class Pace:
    """Keeps a run at a speed relative to real time.

    A run that is late by more than a quarter of a second, as the computer is too slow for its speed, goes on from
    where it is: it does not hurry to catch up. Neither does it after a pause.
    """

    def __init__(self) -> None:
        self._speed = 1.0
        self._anchor: tuple[float, float] | None = None
        self._marks: deque[tuple[float, float]] = deque()

    @property
    def factor(self) -> float:
        """Simulated time over real time in the last second; 0 while the run is held."""
        if len(self._marks) < 2:
            return 0.0
        (began, from_s), (now, to_s) = self._marks[0], self._marks[-1]
        return (to_s - from_s) / max(now - began, 1e-9)

    def left_s(self, time: float, speed: float) -> float:
        """Real time [s] until the period that begins at a simulated time [s] is due at this speed; 0 if it is."""
        now = clock.monotonic()
        if self._anchor is None or speed != self._speed:
            self._anchor, self._speed = (now, time), speed
        if speed == math.inf:
            return 0.0
        began, from_s = self._anchor
        left = began + (time - from_s) / speed - now
        if left < -_MOST_LAG_S:
            self._anchor = (now, time)
        return max(0.0, left)

    def mark(self, time: float) -> None:
        """Note the simulated time [s] that the run has reached now."""
        now = clock.monotonic()
        self._marks.append((now, time))
        while len(self._marks) > 2 and now - self._marks[0][0] > _WINDOW_S:
            self._marks.popleft()

    def hold(self) -> None:
        """Hold the simulated time while real time passes."""
        self._anchor = None
        self._marks.clear()
