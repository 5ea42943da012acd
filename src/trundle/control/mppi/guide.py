"""`Guide`: the window around the robot, and the cost to go in it; `Route`: the path, and where the robot is on it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from trundle.control.mppi.fields import FieldStyle, Window
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angle
from trundle.observation import Track
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


_LEFT_OUT_MARGIN_M, _LEFT_OUT_S = 0.15, 0.4
"""What moves is left out with this margin, and where it was in this time: its last marks stand where it no longer is,
until several scans have passed through them."""

_SLACK_M = 1.0
"""The window reaches so much farther than the samples [m], so that it need not be made anew in every period."""

_LEAST_REACH_M = 2.0
"""Samples of slow robots end early, and a detour may begin beyond their ends [m]."""

_MOST_CELLS = 120
"""Half the window's side at most: the time for its fields grows with the square."""

_EDGE_CELLS = 2
"""A pose of the route this near the window's edge counts as outside: the cost to go is interpolated there."""

_BESIDE_CELLS = 2
"""Where the robot stands in a cell without a cost to go, the cheapest cell this far around counts instead."""

_BEYOND_M = 3.0
"""The cost to go is left out where it is so much more than the robot's [m]: no sample gets there."""

_LEFT_M, _REJOIN_M, _SAME_COST_M = 0.5, 0.4, 0.6
"""A robot has left its route that is so far from its place there, and rejoins it where it is so near [m]."""


class Guide:
    """Leads along a route, round what blocks it within the window.

    Args:
        style: What the fields are made for.
        reach: How far samples go [m].

    Attributes:
        window: Around the robot.
        to_go: Cost from each of its cells to where the route leaves it, and what is left of the section from there
            [m], infinite where no path leads there; None if the route has no free place ahead in the window.
        target: Index of the pose of the route that it leads to.
        stops_short: Whether the discs do not pass the next pose of the route there.
    """

    def __init__(self, style: FieldStyle, reach: float) -> None:
        self._style, self._reach = style, max(reach + 0.5, _LEAST_REACH_M)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.window: Window | None = None
        self.to_go: npt.NDArray[np.float32] | None = None
        self.target = -1
        self.stops_short = False
        self._made_of: tuple[object, ...] = ()

    def look(self, costmap: Costmap, pose: Pose2D, movers: Sequence[Track] = ()) -> Window:
        """Return the window of a costmap around the robot.

        Args:
            costmap: Where it drives.
            pose: Where it is, map frame.
            movers: What moves, map frame: the obstacles in its place are left out.
        """
        window, left_out = self.window, _places_of(movers)
        if window is not None and window.costmap is costmap and len(left_out) == 0 and not window.leaves_out:
            room = window.room_around(*window.to_window(pose.x, pose.y))
            if room >= min(self._reach, 0.5 * _MOST_CELLS * costmap.resolution):
                return window
        row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
        half = min(math.ceil((self._reach + _SLACK_M) / costmap.resolution), _MOST_CELLS)
        self.window = Window(costmap, (row, col), half, self._style, left_out)
        return self.window

    def lead(self, window: Window, route: Route, end: int, pose: Pose2D) -> npt.NDArray[np.float32] | None:
        """Return the cost to go to the last free place of a route in the window, up to its pose `end`.

        Only the stretch up to where it first leaves the window counts. Where no path of the discs leads there, it is
        to the last place before the first that the discs do not pass. What is much farther from there than the robot is
        left out.
        """
        made_of = (window, route, end, self._last_inside(window, route, end))
        is_known = self.target > route.index or self.target == end
        if is_known and _are_same(made_of, self._made_of) and math.isfinite(self.cost_at(window, pose)):
            return self.to_go
        self._made_of = made_of
        free = window.passable(window.poses_in(route.poses[route.index : made_of[3] + 1])[:, :2])
        lasts = np.flatnonzero(free)
        if len(lasts) > 0:
            self._lead_to(window, route, end, route.index + int(lasts[-1]), pose)
            self.stops_short = route.index + int(lasts[-1]) < made_of[3]
            if math.isfinite(self.cost_at(window, pose)):
                return self.to_go
        self.stops_short = True
        first = len(free) if free.all() else int(np.argmin(free))
        if first > 1:
            self._lead_to(window, route, end, route.index + first - 1, pose)
        else:
            self.to_go, self.target = None, -1
        return self.to_go

    def rejoin(self, route: Route, pose: Pose2D) -> None:
        """Move the robot's place on the route, which it has left, on to the target that it is led to.

        The place is one of those up to the target, near the robot, that costs as much from there as from the robot:
        nothing stands between the two.
        """
        window, to_go = self.window, self.to_go
        if window is None or to_go is None or self.target <= route.index:
            return
        poses = route.poses[route.index : self.target + 1]
        distances = np.hypot(poses[:, 0] - pose.x, poses[:, 1] - pose.y)
        near = np.flatnonzero(distances < _REJOIN_M)
        here = self.cost_at(window, pose)
        if distances[0] < _LEFT_M or len(near) == 0 or not math.isfinite(here):
            return
        rows, cols = window.cells_of(window.poses_in(poses[near])[:, :2])
        inside = window.inside(rows, cols)
        costs = to_go[np.where(inside, rows, 0), np.where(inside, cols, 0)]
        near = near[inside & (np.abs(costs - here) < _SAME_COST_M)]
        if len(near) > 0:
            route.index += int(near[np.argmin(distances[near])])

    def _lead_to(self, window: Window, route: Route, end: int, target: int, pose: Pose2D) -> None:
        point = window.poses_in(route.poses[target : target + 1])[:, :2]
        left = float(route.along[end] - route.along[target])
        around = window.to_window(pose.x, pose.y)
        self.to_go, self.target = window.cost_to_go(point, np.array([left]), around, _BEYOND_M), target

    @staticmethod
    def _last_inside(window: Window, route: Route, end: int) -> int:
        """Return the index of the last pose of a route before it leaves the window."""
        ahead = window.poses_in(route.poses[route.index : end + 1])[:, :2]
        rows, cols = window.cells_of(ahead)
        edge = _EDGE_CELLS
        inside = window.inside(rows - edge, cols - edge) & window.inside(rows + edge, cols + edge)
        return route.index + (len(inside) if inside.all() else max(1, int(np.argmin(inside)))) - 1

    def cost_at(self, window: Window, pose: Pose2D) -> float:
        """Cost to go from the robot's place [m], or from the nearest cells that have one; infinite without."""
        if self.to_go is None:
            return math.inf
        x, y = window.to_window(pose.x, pose.y)
        row, col = int(y / window.resolution), int(x / window.resolution)
        near = self.to_go[
            max(0, row - _BESIDE_CELLS) : row + _BESIDE_CELLS + 1, max(0, col - _BESIDE_CELLS) : col + _BESIDE_CELLS + 1
        ]
        here = self.to_go[row, col] if 0 <= row < self.to_go.shape[0] and 0 <= col < self.to_go.shape[1] else math.inf
        return float(here) if math.isfinite(here) else float(near.min(initial=math.inf))


def _are_same(first: tuple[object, ...], second: tuple[object, ...]) -> bool:
    return len(first) == len(second) and all(a is b or a == b for a, b in zip(first, second, strict=True))


def _places_of(movers: Sequence[Track]) -> FloatArray:
    """Return capsules (x, y, x, y, radius) [m], map frame, from where each mover is to where it was, shape (N, 5)."""
    back = _LEFT_OUT_S
    capsules = [
        (track.x, track.y, track.x - back * track.vx, track.y - back * track.vy, track.radius + _LEFT_OUT_MARGIN_M)
        for track in movers
    ]
    return np.array(capsules, np.float64).reshape(-1, 5)
