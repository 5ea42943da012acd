"""`LiveDriver`: drives the bridge's runs in the thread that calls it."""

from __future__ import annotations

from collections.abc import Callable

from trundle.mission import Episode, LiveRun, LiveStatus, Session, Steering


class LiveDriver:
    """Drives sessions at a speed relative to real time, and again after restarts.

    Args:
        speed: How fast the first run passes, 0.1 to 50, or infinity for as fast as it can.

    Attributes:
        steering: Where the session of each run takes its directives from.
    """

    def __init__(self, *, speed: float = 1.0) -> None:
        self.steering = Steering()
        self._speed = speed
        self._live: LiveRun | None = None

    @property
    def status(self) -> LiveStatus:
        """What runs now."""
        return LiveStatus("idle", speed=self._speed) if self._live is None else self._live.status

    def drive(self, make_session: Callable[[int | None], Session]) -> Episode:
        """Drive to the end, and again after each restart; see `LiveRun`."""
        self._live = LiveRun(make_session, self.steering, speed=self._speed)
        return self._live.run()
