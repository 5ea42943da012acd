"""`Targets`: which frontier comes next, and which are given up for what reason."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.navigation.exploration.frontiers import ExplorerSettings, Frontier

_SAME_M = 1.0
"""Frontiers that are nearer to each other than this are one and the same [m]: they move as more is seen."""
_STAYS = 1.5
"""So much better must another frontier be before the robot turns away from the one that it drives to."""
_LOOKS = 3
"""So often a frontier may come back after it was looked at."""
_TURN_M = 1.5
"""Added to the distance of every frontier [m], so that a close one does not count without limit."""


@dataclass(frozen=True, slots=True)
class GivenUp:
    """A frontier that the robot could not look at.

    Attributes:
        x, y: Its middle, map frame [m].
        reason: Why.
        gain: How much unknown space it would have shown [m²].
    """

    x: float
    y: float
    reason: str
    gain: float


@dataclass(slots=True)
class _Refused:
    """Tries to get to a frontier that have failed.

    Attributes:
        frontier: The frontier.
        reason: Why the last one failed.
        tries: How many.
        waits: Whether others come first.
        is_forgiven: Whether one of them was taken back, or none may be: it was refused for good.
    """

    frontier: Frontier
    reason: str
    tries: int = 0
    waits: bool = True
    is_forgiven: bool = False


class Targets:
    """Chooses among frontiers, and remembers those that could not be reached.

    A frontier at which a try has failed is tried again once no other is left: what was in the way may have moved.

    Args:
        settings: How frontiers are rated, and how often each is tried.
    """

    def __init__(self, settings: ExplorerSettings) -> None:
        self._settings = settings
        self._refused: list[_Refused] = []
        self._visited: list[tuple[float, float]] = []

    def choose(self, frontiers: Sequence[Frontier], current: Frontier | None) -> Frontier | None:
        """Return the frontier to drive to; None where none is left to be tried.

        Args:
            frontiers: All that there are now.
            current: The one that the robot drives to.
        """
        open_ones = [one for one in frontiers if not self._waits(one)]
        if not open_ones:
            for refused in self._refused:
                refused.waits = refused.tries >= self._settings.tries
            open_ones = [one for one in frontiers if not self._waits(one)]
        if not open_ones:
            return None

        def worth(frontier: Frontier) -> float:
            rated = frontier.gain**self._settings.gain_exponent / (frontier.distance + _TURN_M)
            return rated * _STAYS if current is not None and is_same(frontier, current) else rated

        return max(open_ones, key=worth)

    def refuse(self, frontier: Frontier, reason: str, *, for_good: bool = False) -> None:
        """Note that a try to look at a frontier has failed."""
        refused = next((one for one in self._refused if is_same(one.frontier, frontier)), None)
        if refused is None:
            refused = _Refused(frontier, reason)
            self._refused.append(refused)
        refused.reason, refused.waits = reason, True
        refused.tries = self._settings.tries if for_good else refused.tries + 1
        refused.is_forgiven = refused.is_forgiven or for_good

    def forgive(self, frontiers: Sequence[Frontier]) -> None:
        """Take back a failed try at each of these frontiers, once, unless it was refused for good."""
        for one in self._refused:
            if not one.is_forgiven and any(is_same(one.frontier, frontier) for frontier in frontiers):
                one.tries, one.waits, one.is_forgiven = one.tries - 1, False, True

    def note_vanished(self, frontier: Frontier) -> None:
        """Note that a frontier was looked at, and is none any more.

        One that comes back again and again, as where beams graze a wall, is given up.
        """
        places = [*self._visited, (frontier.x, frontier.y)]
        self._visited = places
        if sum(math.dist(place, places[-1]) < _SAME_M for place in places) > _LOOKS:
            self.refuse(frontier, f"looked at {_LOOKS + 1} times, and unknown again", for_good=True)

    def given_up(self, frontiers: Sequence[Frontier]) -> tuple[GivenUp, ...]:
        """Return those of the frontiers that there are now that were given up."""
        return tuple(
            GivenUp(one.x, one.y, refused.reason, one.gain)
            for one in frontiers
            for refused in self._refused
            if refused.waits and is_same(refused.frontier, one)
        )

    def _waits(self, frontier: Frontier) -> bool:
        return any(one.waits and is_same(one.frontier, frontier) for one in self._refused)


def is_same(one: Frontier, other: Frontier) -> bool:
    """Whether two frontiers, of one time or of two, are one and the same."""
    return math.hypot(one.x - other.x, one.y - other.y) < _SAME_M
