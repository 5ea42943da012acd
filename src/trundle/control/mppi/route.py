"""`Route`: a path as closely spaced poses, and where the robot is on it; `Headway`: whether it advances along it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.path import Path

_STEP_M = 0.05
_STEP_RAD = 0.1
_AHEAD_M = 1.0
_SAME_PLACE_M = 1e-6


class Route:
    """A path that is followed from its beginning.

    Args:
        path: The path.

    Attributes:
        path: The same.
        poses: At most 0.05 m and 0.1 rad apart, the corners of the path among them, shape (N, 3).
        along: Length of path up to each of them [m], shape (N,).
        backward: Whether the stretch that leads to each of them is driven backwards, shape (N,).
        index: Where the robot is, an index into `poses`.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        pieces = [path.poses[:1]]
        backward = [np.array(path.backward[:1], np.bool_) if len(path.backward) else np.zeros(1, np.bool_)]
        for first, last, back in zip(path.poses[:-1], path.poses[1:], path.backward, strict=True):
            piece = _leg(first.tolist(), last.tolist(), back=bool(back))
            pieces.append(piece)
            backward.append(np.full(len(piece), back))
        self.poses: FloatArray = np.concatenate(pieces)
        self.backward: npt.NDArray[np.bool_] = np.concatenate(backward)
        steps = np.hypot(*np.diff(self.poses[:, :2], axis=0).T)
        self.along: FloatArray = np.concatenate([[0.0], np.cumsum(steps)])
        turned = np.flatnonzero(self.backward[1:] != self.backward[:-1])
        self._ends = np.append(turned, len(self.along) - 1)
        self.index = 0

    @property
    def left_m(self) -> float:
        """How much of it is left [m]."""
        return float(self.along[-1] - self.along[self.index])

    @property
    def section_end(self) -> int:
        """Index of the pose where the direction of driving changes next, or of the last one."""
        return int(self._ends[int(self._ends.searchsorted(self.index))])

    @property
    def last_turn(self) -> FloatArray:
        """The poses at its end: one, or those of a turn in place, shape (N, 3)."""
        return self.poses[int(self.along.searchsorted(float(self.along[-1]) - _SAME_PLACE_M)) :]

    def ahead(self, length: float) -> slice:
        """Return the poses from the robot's on, over a length [m]."""
        end = int(self.along.searchsorted(float(self.along[self.index]) + length, side="right"))
        return slice(self.index, max(end, self.index + 1))

    def advance(self, pose: Pose2D) -> None:
        """Find the robot's place on it, from the last one on, up to the next change of direction."""
        poses = self.poses
        end = min(self.section_end + 1, self.ahead(_AHEAD_M).stop)
        dx, dy = poses[self.index : end, 0] - pose.x, poses[self.index : end, 1] - pose.y
        distances = dx * dx + dy * dy
        # The last of the nearest ones: a turn in place is passed at once.
        self.index += len(distances) - 1 - int(np.argmin(distances[::-1]))

    def jump(self, left_m: float) -> None:
        """Set how much of the route is left [m]."""
        self.reach(float(self.along[-1]) - left_m)

    def reach(self, along_m: float) -> None:
        """Set how far along the route the robot is at least [m]."""
        self.index = max(self.index, int(self.along.searchsorted(along_m - 1e-9)))
        self.index = min(self.index, len(self.along) - 1)

    def rest(self, pose: Pose2D) -> Path:
        """Return what is left of it, from the robot's place on it, with the robot's own yaw first."""
        legs = slice(self.index + 1, None)
        here = self.poses[self.index].copy()
        first = here.copy()
        first[2] = pose.yaw
        poses = np.concatenate([first[np.newaxis], here[np.newaxis], self.poses[legs]])
        backward = np.concatenate([self.backward[self.index : self.index + 1], self.backward[legs]])
        return Path(poses, planner=self.path.planner, backward=backward)


def _leg(first: list[float], last: list[float], *, back: bool) -> FloatArray:
    """Return poses from one pose to the next, without the first."""
    (x0, y0, yaw0), (x1, y1, yaw1) = first, last
    length = math.hypot(x1 - x0, y1 - y0)
    if length <= _SAME_PLACE_M:
        turn = wrap_angle(yaw1 - yaw0)
        pieces = max(1, math.ceil(abs(turn) / _STEP_RAD))
        shares = np.arange(1, pieces + 1) / pieces
        return np.column_stack([np.full(pieces, x1), np.full(pieces, y1), yaw0 + shares * turn])
    yaw = math.atan2(y1 - y0, x1 - x0) + (math.pi if back else 0.0)
    pieces = max(1, math.ceil(length / _STEP_M))
    shares = np.arange(1, pieces + 1) / pieces
    poses = np.column_stack([x0 + shares * (x1 - x0), y0 + shares * (y1 - y0), np.full(pieces, yaw)])
    poses[-1, 2] = yaw1
    return poses


_BY_M = 0.3
_WITHIN_M, _WITHIN_RAD = 2.0, 2.0 * math.pi
"""Headway is 0.3 m less of the path after so much driving: samples may drive to and fro a little, but not for ever."""

_STRETCH_M, _MOST_M = 0.3, 10.0
_FORGET_M = 5.0
"""The stretch that is followed doubles up to 10 m, until 5 m of the path were made: then the place is behind."""


class Headway:
    """Compares what a robot drives with what is left of its path.

    It is lost where 2 m are driven, or a full turn is made, and no 0.3 m less of the path is left, or where the robot
    stands. It then follows a stretch of the path itself: 0.3 m, and twice as much each time that headway is lost again
    within 5 m of path.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Start over: nothing was driven, and the next stretch is short."""
        self._stretch_m = _STRETCH_M
        self._kept_m = 0.0
        self.begin()

    def begin(self) -> None:
        """Start over from here, on another path or another part of this one."""
        self._least_m = math.inf
        self._driven_m = self._turned_rad = 0.0

    def is_lost(self, left_m: float, twist: Twist2D, dt: float) -> bool:
        """Return whether the robot makes no headway, by its motion in a period [s] and the rest of the path [m]."""
        if left_m <= self._least_m - _BY_M:
            self._kept_m += 0.0 if math.isinf(self._least_m) else self._least_m - left_m
            self._least_m, self._driven_m, self._turned_rad = left_m, 0.0, 0.0
            if self._kept_m >= _FORGET_M:
                self._stretch_m, self._kept_m = _STRETCH_M, 0.0
        self._driven_m += abs(twist.v) * dt
        self._turned_rad += abs(twist.w) * dt
        return self._driven_m >= _WITHIN_M or self._turned_rad >= _WITHIN_RAD

    def lose(self) -> float:
        """Return how long a stretch of the path to follow [m], now that there is none."""
        stretch_m, self._kept_m = self._stretch_m, 0.0
        self._stretch_m = min(2.0 * stretch_m, _MOST_M)
        self.begin()
        return stretch_m
