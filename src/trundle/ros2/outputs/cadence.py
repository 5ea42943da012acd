"""`Cadence`: when something is due that is published once in each period of simulated time."""

from __future__ import annotations

import math

_SAME_S = 1e-9


class Cadence:
    """Says when something is due; where time goes back, it is due at once.

    Args:
        period_s: The period [s].
    """

    def __init__(self, period_s: float) -> None:
        self._period_s = period_s
        self._last_s = -math.inf

    def is_due(self, time: float) -> bool:
        """Whether a period has passed at a time [s] since the last `mark`, or there was none."""
        return not 0.0 <= time - self._last_s < self._period_s - _SAME_S

    def mark(self, time: float) -> None:
        """It was published at this time [s]."""
        self._last_s = time
