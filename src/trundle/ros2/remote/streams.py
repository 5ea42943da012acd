"""`Stream`: how often something arrives, and whether it has fallen silent; `RobotClock`: what time it is there."""

from __future__ import annotations

import math
from collections import Counter

LEAST_SILENCE_S, MOST_SILENCE_S = 0.25, 0.4
"""A stream is silent after three of its periods, within these [s of real time]: a robot stops within half a second."""

SLOW_PERIODS = 2.2
"""A stream that is slower than five times a second is silent after so many of its periods."""

_SHARE = 0.1
"""Weight of a new interval in the mean one."""


class Stream:
    """How often something arrives, by the time of this machine [s].

    Args:
        name: What it is, for messages.

    Attributes:
        name: The same.
        count: How many arrived.
        last: When the last one arrived; minus infinity before the first.
        period: The mean interval [s]; None before the second.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.count = 0
        self.last = -math.inf
        self.period: float | None = None

    def mark(self, now: float) -> None:
        """Note that one arrived now."""
        if self.count:
            gap = now - self.last
            # A silence is no rate: after it the stream has the rate that it had.
            if self.period is None:
                self.period = min(gap, 1.0)
            elif gap < 4.0 * self.period + 0.02:
                self.period += _SHARE * (gap - self.period)
        self.count += 1
        self.last = now

    @property
    def allowed_s(self) -> float:
        """After so long it is silent [s]."""
        period = 0.0 if self.period is None else self.period
        usual = min(MOST_SILENCE_S, max(LEAST_SILENCE_S, 3.0 * period))
        return max(usual, SLOW_PERIODS * period)

    def silent_s(self, now: float) -> float:
        """Return how long nothing has arrived [s], where that is too long; else 0."""
        gap = now - self.last
        return gap if self.count and gap > self.allowed_s else 0.0


JUMP_BACK_S, JUMP_AHEAD_S = 0.5, 5.0
"""A time that goes back by more than this, or ahead while this machine's went by less, has jumped [s]."""

WALL_S = 2.0
"""Stamps that are within this of this machine's clock [s] are of a clock that is set like it."""


class RobotClock:
    """The time on the robot's network [s]: that of /clock, or of this machine, or of the robot's stamps.

    Where there is a /clock, it counts. Otherwise stamps within two seconds of this machine's clock are of the same
    time. Else the robot's clock is set differently, and its newest stamp is what time it is there.

    Attributes:
        is_simulated: Whether there is a /clock.
        offset: How far the robot's clock is ahead of this machine's [s], where it is set differently; else 0.
        jumps: How often the time has jumped.
        settings: How often `offset` has changed, which makes all times before those of another clock.
        age: Mean age of stamps on arrival [s].
        least_step: The shortest step of /clock [s].
    """

    def __init__(self) -> None:
        self.is_simulated = False
        self.offset = 0.0
        self.jumps = self.settings = 0
        self.age = 0.0
        self.stream = Stream("/clock")
        self._clock: float | None = None
        self._stamp: float | None = None
        self.least_step = math.inf
        self._leads: Counter[str] = Counter()

    @property
    def epoch(self) -> tuple[int, int, bool]:
        """Which time it tells: where this changes, times of before are those of another clock."""
        return self.jumps, self.settings, self.is_simulated

    def set(self, time: float, real: float) -> bool:
        """Set the time of /clock [s] as received at a real time [s]; return whether the time has jumped.

        A clock that repeats its time stands: that is no sign of life.
        """
        before, self._clock, self.is_simulated = self._clock, time, True
        if before is None:
            self._stamp = None
            self.stream.mark(real)
            return False
        gap, passed = time - before, real - self.stream.last
        if gap != 0.0:
            self.stream.mark(real)
            self.least_step = min(self.least_step, abs(gap))
        if gap < -JUMP_BACK_S or gap > max(JUMP_AHEAD_S, 100.0 * passed):
            self.jumps += 1
            self._stamp = None
            return True
        return False

    @property
    def is_slow(self) -> bool:
        """Whether /clock has just turned out to go on in long steps; it is true for one message."""
        return self.stream.count == MANY and self.least_step > SLOW_S

    def lead(self, what: str, stamp: float) -> float:
        """Return how far a stamp of a topic is ahead of /clock [s], where many in a row are; else 0."""
        ahead = stamp - self._clock if self.is_simulated and self._clock is not None else 0.0
        self._leads[what] = self._leads[what] + 1 if ahead > LEADS_S else 0
        return ahead if self._leads[what] >= MANY else 0.0

    def see(self, stamp: float, wall: float) -> None:
        """Compare a message's stamp [s] with when it arrived by this machine's clock [s]; 0 is no stamp."""
        if stamp == 0.0:
            return
        if not self.is_simulated:
            ahead = stamp - wall
            if abs(ahead) <= WALL_S:
                self.settings += self.offset != 0.0
                self.offset = 0.0
            elif self.offset == 0.0 or abs(ahead - self.offset) > WALL_S:
                self.settings += 1
                self.offset = ahead
            else:  # the least delayed stamp tells the most
                self.offset = max(self.offset, ahead)
        self.age += 0.05 * (max(0.0, self.now(wall) - stamp) - self.age)
        limit = math.inf if self._clock is None or not self.is_simulated else self._clock + AHEAD_S
        if stamp <= limit and (self._stamp is None or stamp > self._stamp):
            self._stamp = stamp

    def now(self, wall: float) -> float:
        """Return the time there [s] at a time of this machine's clock [s].

        Stamps may be ahead of a /clock that comes seldom: the newest counts, as long as it is no more than 0.2 s ahead.
        """
        if self.is_simulated and self._clock is not None:
            return self._clock if self._stamp is None else max(self._clock, self._stamp)
        return wall + self.offset


MANY = 20
"""So many messages show what a robot sends: a busy machine makes some of any robot look late."""

SLOW_S, LEADS_S = 0.08, 0.12
"""Remarked on are a /clock all of whose steps are longer than the first [s], and stamps that are farther ahead of it
than the second, which is a little more than the step of one of 10 Hz."""

AHEAD_S = 0.25
"""Stamps are taken that are ahead of /clock by up to this [s]: 0.2 s are usual where /clock comes at 10 Hz."""
