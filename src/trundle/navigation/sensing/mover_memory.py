"""`MoverMemory`: where something was seen to move."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

from trundle.observation import Track

KEPT_S = 60.0
_EVERY_S = 0.5


class MoverMemory:
    """Remembers for a minute where confirmed tracks were.

    A track ends soon after its mover stops: beside a shelf, or close to the robot, its hits look like any others. What
    stands there then may still drive off again.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget everything: the robot is somewhere else."""
        self._seen: deque[tuple[float, float, float, float]] = deque()
        self._noted_at = -math.inf

    def note(self, tracks: Sequence[Track], time: float) -> None:
        """Take the tracks of now [s]; twice a second their places are kept."""
        if time < self._noted_at:
            self.clear()
        while self._seen and self._seen[0][0] < time - KEPT_S:
            self._seen.popleft()
        if time - self._noted_at < _EVERY_S - 1e-9:
            return
        self._noted_at = time
        self._seen.extend((time, track.x, track.y, track.radius) for track in tracks if track.confirmed)

    def was_near(self, x: float, y: float, within_m: float) -> bool:
        """Whether something that moves was within this distance of a point in the last minute."""
        return any(math.hypot(at_x - x, at_y - y) < within_m + radius for _, at_x, at_y, radius in self._seen)
