"""`LiveRun`: drives a session at a speed relative to real time, as directives say, and again after a restart."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from trundle.mission.episode import Episode
from trundle.mission.running.session import Session
from trundle.mission.steering.directives import Speed
from trundle.mission.steering.pace import Pace
from trundle.mission.steering.queue import Steering
from trundle.mission.steering.report import SteeringReport

_HELD_S = 1.0
"""A run that is held looks for its end this often [s], real time."""


@dataclass(frozen=True, slots=True)
class LiveStatus:
    """What a live run does now.

    Attributes:
        state: "idle" before the first run and between two of them, "running", "paused", or "ended".
        run: Number of the run, from 1; 0 before the first one.
        time: Simulated time [s].
        speed: How fast it is to pass relative to real time; infinity for as fast as it can.
        factor: How fast it really passed in the last second; 0 while it is paused.
        steering: How it is steered; None before the first run.
    """

    state: Literal["idle", "running", "paused", "ended"]
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
            if session.restart is None:
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
            while session.outcome is None:
                if not session.steer():
                    pace.hold()
                    self._show(session, "paused")
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
            session.abort(error)
        return session.conclude()

    def _take_speed(self) -> None:
        self._is_at_speed = True

    def _show(self, session: Session, state: Literal["idle", "running", "paused", "ended"]) -> None:
        report = session.steering
        if report is not None and self._is_at_speed:  # else a restart came first: the next run has it
            self._speed = Speed(report.speed)
        factor = self._pace.factor if state == "running" else 0.0
        self.status = LiveStatus(state, self.status.run, session.time, self._speed.factor, factor, report)
