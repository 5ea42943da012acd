"""`Pace`: when the next control period of a run is due, and how fast the run really passes."""

from __future__ import annotations

import math
import time as clock
from collections import deque

_MOST_LAG_S = 0.25
_WINDOW_S = 1.0


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
        """Stand still: real time passes now, and simulated time does not."""
        self._anchor = None
        self._marks.clear()
