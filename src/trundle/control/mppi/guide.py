"""`Guide`: the window around the robot, and the cost to go in it, kept as long as nothing changes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from trundle.control.mppi.fields import FieldStyle, Window
from trundle.control.mppi.route import Route
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Track

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
