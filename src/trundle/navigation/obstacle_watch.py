"""What blocks the path and may move away: `ObstacleWatch`, when to plan round it or wait; `MoverMemory`."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np

from trundle.control import ProgressChecker
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Track

PLAN_EVERY_S, SELDOM_S = 0.5, 4.0
"""Between two plans for the same blocked path [s]: twice as long after each that found none, up to the second."""
LONG_DETOUR_M = 3.0
"""A detour longer than what is left of the path by more than this [m] is taken after a wait."""
STAND_OFF_M = 1.2
"""Room that the robot leaves to what was seen to move and blocks its path [m], so that it can turn and drive off."""
STANDING_WITHIN = 0.5, 7.0
"""A robot stands at one place as long as it moves and turns by less than this [m, rad]."""
_BACK_UP_EVERY_S = 5.0
_THOROUGH_EVERY_S = 10.0
PAST_MOVERS_EVERY_S = 20.0
"""Between two long searches where what moves blocks the path, and before the first [s]: it may leave by itself.

One in vain takes up to 800,000 of the 1,200,000 expansions of a drive.
"""


class ObstacleWatch:
    """Remembers since when the path is blocked, and how long the robot has stood because of it.

    Args:
        wait_s: How long a long detour is put off [s]: what may move gets time to do so.
        patience_s: How long the robot stands without any path before it gives up [s].
        mover_patience_s: The same where what blocks the path, or stands beside the robot, was seen to move [s], if that
            is longer.

    Attributes:
        since: When the path was found blocked [s]; None where it is free.
        by_mover: Whether what blocks the path, or the goal, was seen to move.
        beside_mover: Whether something was seen to move beside the robot.
        gap_m: How far ahead on the path the footprint would first touch it [m]; infinite without a path.
    """

    def __init__(self, wait_s: float, patience_s: float, mover_patience_s: float = 0.0) -> None:
        self._wait_s, self._back_up_s = wait_s, max(wait_s, PLAN_EVERY_S)
        self._patience_s, self._mover_patience_s = patience_s, max(patience_s, mover_patience_s)
        self._progress = ProgressChecker(*STANDING_WITHIN)
        self.reset()

    def reset(self) -> None:
        """Start over."""
        self._progress.reset()
        self._standing_s = 0.0
        self.beside_mover = False
        self.clear()

    def clear(self) -> None:
        """The path is free."""
        self.since: float | None = None
        self.by_mover = False
        self.gap_m = math.inf
        self._planned_at: float | None = None
        self._every_s = PLAN_EVERY_S
        self._back_up_at = 0.0
        self._thorough_at = -math.inf

    @property
    def is_blocked(self) -> bool:
        """Whether something blocks the path."""
        return self.since is not None

    @property
    def gives_up(self) -> bool:
        """Whether the robot has stood at one place for too long."""
        return self._standing_s > (self._mover_patience_s if self.by_mover or self.beside_mover else self._patience_s)

    @property
    def room_m(self) -> float:
        """How far the robot may drive on towards what blocks its path [m]; below 0, how far it is to stand back."""
        return self.gap_m - STAND_OFF_M if self.is_blocked and self.by_mover else math.inf

    def see(self, time: float, gap_m: float = math.inf) -> None:
        """The path is blocked at this time [s], so far ahead [m]."""
        self.gap_m = gap_m
        if self.since is None:
            self.since, self._back_up_at = time, time + self._back_up_s

    def may_plan(self, time: float) -> bool:
        """Return whether it is time to plan [s]; if so, this counts as a plan."""
        if self._planned_at is not None and time - self._planned_at < self._every_s - 1e-9:
            return False
        self._planned_at = time
        return True

    def is_thorough(self, time: float, *, stands: bool) -> bool:
        """Whether this plan [s] may search for long, which only a robot that stands can afford; if so, it counts.

        The last plan before it gives up may, so that a path is not missed for want of effort.
        """
        if self.gives_up:
            return True
        every_s, last = _THOROUGH_EVERY_S, self._thorough_at
        if self.by_mover:
            every_s, last = PAST_MOVERS_EVERY_S, max(last, self.since or 0.0)
        if not stands or time - last < every_s - 1e-9:
            return False
        self._thorough_at = time
        return True

    def plan_soon(self) -> None:
        """Plan at the next chance, and thoroughly."""
        self._planned_at, self._every_s = None, PLAN_EVERY_S

    def fail(self) -> None:
        """The plan found no path."""
        self._every_s = min(2.0 * self._every_s, SELDOM_S)

    def takes(self, detour_m: float, left_m: float, time: float) -> bool:
        """Return whether to take a detour of this length now [s], with so much left of the blocked path [m]."""
        waited = self.since is not None and time - self.since >= self._wait_s - 1e-9
        return waited or detour_m <= left_m + LONG_DETOUR_M

    def backs_up(self, time: float) -> bool:
        """Whether a robot that stands and finds no path is to back up now [s], to see more and to have room to turn."""
        if time < self._back_up_at:
            return False
        self._back_up_at = time + _BACK_UP_EVERY_S
        return True

    @property
    def standing_s(self) -> float:
        """How long the robot has stood at one place [s]."""
        return self._standing_s

    def follow(self, pose: Pose2D, time: float) -> None:
        """Note where the robot is at a time [s]."""
        self._standing_s = self._progress.standing_s(pose, time)


KEPT_S = 60.0
_RECENT_S = 5.0
_EVERY_S = 0.5
_JUST_S = 0.15
"""A track that was seen within this time counts as seen now [s]: many lidars scan ten times a second."""
_SQUARE_M = 0.2
_SAME_SPEED_MPS = 1e-12


class MoverMemory:
    """Remembers for a minute where confirmed tracks were seen.

    A track ends soon after its mover stops: beside a shelf, or close to the robot, its hits look like any others. What
    stands there then may still drive off again.

    Attributes:
        recent: Where they were in the last 5 s: x, y and radius [m], map frame, shape (N, 3).
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget everything: the robot is somewhere else."""
        self._seen: deque[tuple[float, float, float, float]] = deque()
        self._followed: dict[int, tuple[Track, float]] = {}  # as it was last, and when a scan saw it
        self._noted_at = -math.inf
        self.recent: FloatArray = np.zeros((0, 3))

    def note(self, tracks: Sequence[Track], time: float) -> None:
        """Note the tracks at a time [s]; twice a second the places of those that scans see are kept."""
        if time < self._noted_at:
            self.clear()
        followed = [(track, self._seen_at(track, time)) for track in tracks]
        self._followed = {track.id: (track, seen_at) for track, seen_at in followed}
        while self._seen and self._seen[0][0] < time - KEPT_S:
            self._seen.popleft()
        if time - self._noted_at < _EVERY_S - 1e-9:
            return
        self._noted_at = time
        self._seen.extend(
            (time, track.x, track.y, track.radius)
            for track, seen_at in followed
            if track.confirmed and seen_at >= time - _JUST_S
        )
        if self._seen:
            self.recent = np.array([place for at, *place in self._seen if at >= time - _RECENT_S]).reshape(-1, 3)

    def _seen_at(self, track: Track, time: float) -> float:
        """When a scan last saw a track [s]: one that is only predicted keeps its speed and becomes less certain."""
        last, seen_at = self._followed.get(track.id, (None, time))
        if last is None:
            return time
        if abs(track.speed - last.speed) > _SAME_SPEED_MPS:
            return time
        now, before = track.covariance.item, last.covariance.item
        is_predicted = now(0, 0) + now(1, 1) > before(0, 0) + before(1, 1)
        return seen_at if is_predicted else time

    @property
    def places(self) -> FloatArray:
        """Where they were in the last minute: x, y and radius [m], map frame, shape (N, 3); one for each square."""
        squares = {(round(x / _SQUARE_M), round(y / _SQUARE_M)): (x, y, radius) for _, x, y, radius in self._seen}
        return np.array(list(squares.values())).reshape(-1, 3)

    def was_near(self, x: float, y: float, within_m: float) -> bool:
        """Return whether something that moves was within this distance of a point in the last minute."""
        return any(math.hypot(at_x - x, at_y - y) < within_m + radius for _, at_x, at_y, radius in self._seen)
