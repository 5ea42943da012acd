"""`RoutePlanner`: one path through the goals ahead, from free ends, made of a leg to each; `join_legs` joins these."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.control import GoalChecker
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import BlockedPoseError, PlanningError
from trundle.fault import check_result
from trundle.geometry import FloatArray, Goal, Pose2D, wrap_angle
from trundle.navigation.planning_limits import timed_out
from trundle.navigation.progress import FollowedPath
from trundle.navigation.sensing import SensedMap
from trundle.path import Path
from trundle.planning import Cancellation, PathCheck, Planner, Smoother
from trundle.planning.cancellation import nominal_expansions

_LEAST_S = 1e-3  # what is left of a deadline for the legs of a path
_ROUND_WITHIN = 0.7
"""Share of the tolerance of a goal that the robot drives through which rounding a bend there may use.

The controller needs the rest: it does not stay on the path exactly.
"""


class RoutePlanner:
    """Plans to each goal up to the next stop, from the one before, and joins the paths.

    Args:
        sensed: The costmap with what the scans saw.
        smoother: A smoother of every planned path, or None.
        goal_checker: Its tolerance is how far from an occupied goal a path may end.
        through_tolerance: How far from a goal that the robot drives through a path may pass [m].

    Attributes:
        smoother: The same; may be replaced.
        goal_checker: The same; may be replaced.
        ends_short: Whether the last path ends before its goal, which lies outside of a moving window.
        expansions: Nodes that were expanded; who plans sets it to 0.
    """

    def __init__(
        self, sensed: SensedMap, smoother: Smoother | None, goal_checker: GoalChecker, through_tolerance: float
    ) -> None:
        self._sensed, self._through_tolerance = sensed, through_tolerance
        self.smoother, self.goal_checker = smoother, goal_checker
        self.ends_short = False
        self.expansions = 0

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goals: Sequence[Goal],
        first_number: int,
        planner: Planner,
        deadline_s: float | None,
    ) -> FollowedPath:
        """Plan one path.

        Args:
            costmap: Where it is to lead.
            start: Where the robot is, map frame.
            goals: The robot drives through all but the last of these, where it stops.
            first_number: Number of the first of them, for errors.
            planner: Plans each leg.
            deadline_s: For all legs together [s]. If None, planning takes as long as it takes.

        Raises:
            PlanningError: If there is no path.
        """
        began, left_s = clock.perf_counter(), deadline_s
        planned, smooth = list[Path](), list[Path]()
        self.ends_short = False
        for index, goal in enumerate(goals):
            try:
                leg = self._plan_leg(costmap, start, goal, planner, left_s, is_stop=index == len(goals) - 1)
            except PlanningError as error:
                if len(goals) > 1:
                    error.args = (f"goal {first_number + index}: {error}",)
                raise
            if deadline_s is not None:
                left_s = max(_LEAST_S, deadline_s - (clock.perf_counter() - began))
            planned.append(leg)
            if (smoother := self.smoother) is not None:
                leg = check_result(smoother.smooth(leg, costmap), Path, smoother, "smooth")
            smooth.append(leg)
            start = planned[-1].goal
            if self.ends_short:
                break
        path, joints = join_legs(smooth, costmap, _ROUND_WITHIN * self._through_tolerance)
        raw = path if self.smoother is None else join_legs(planned, costmap, 0.0)[0]
        return FollowedPath(raw, path, joints)

    def plan_aside(
        self, costmap: Costmap, start: Pose2D, goals: Sequence[Goal], planner: Planner, deadline_s: float | None
    ) -> FollowedPath:
        """Plan a path that is not the one to the goal; see `plan`. `expansions` is of this search alone then."""
        ends_short, self.expansions = self.ends_short, 0
        try:
            return self.plan(costmap, start, goals, 1, planner, deadline_s)
        finally:
            self.ends_short = ends_short

    def is_closed(self, start: Pose2D, goals: Sequence[Goal], planner: Planner, deadline_s: float | None) -> bool:
        """Whether the map alone has no path, and not because a goal is occupied; False if it takes too long [s].

        `expansions` is of this search alone then.
        """
        if (static := self._sensed.static) is None:
            return False
        try:
            self.plan_aside(static, start, goals, planner, deadline_s)
        except PlanningError as error:
            return not (timed_out(error) or is_of_goal(error, goals))
        return False

    def _plan_leg(
        self, costmap: Costmap, start: Pose2D, goal: Goal, planner: Planner, deadline_s: float | None, *, is_stop: bool
    ) -> Path:
        target = goal
        if self._sensed.is_active:
            aim = goal_in_window(costmap, start, goal) if self._sensed.may_contain(goal.pose) else goal
            tolerance = self.goal_checker.xy_tolerance if is_stop else self._through_tolerance
            start, target = free_ends(costmap, self._sensed.static, start, aim, tolerance)
            self.ends_short = aim is not goal
        count = Cancellation()
        path: Path | None = None
        try:
            made = planner.plan(costmap, start, target, deadline_s=deadline_s, cancel=count)
            path = check_result(made, Path, planner, "plan")
            return path
        finally:
            if count.expansions is None:
                count.count(nominal_expansions(costmap.shape, None if path is None else _cells_of(path, costmap)))
            self.expansions += count.expansions or 0


def is_of_goal(error: PlanningError, goals: Sequence[Goal]) -> bool:
    """Return whether a plan failed because the robot does not fit on one of the goals."""
    pose = error.pose if isinstance(error, BlockedPoseError) else None
    return pose is not None and any((goal.pose.x, goal.pose.y) == pose[:2] for goal in goals)


def _cells_of(path: Path, costmap: Costmap) -> FloatArray:
    """Return the points of a path in cells, shape (N, 2)."""
    return costmap.origin.inverse().transform_points(path.poses[:, :2]) / costmap.resolution


_SAME_PLACE_M = 1e-6
_ROUNDED_RAD = (math.radians(15.0), math.radians(150.0))
"""Bends at a pose that are rounded: a smaller one is driven as it is, and a larger one is turned back."""
_PIECE_RAD = math.radians(15.0)
_LONGEST_CUT_M = 1.0


def join_legs(legs: Sequence[Path], costmap: Costmap, within_m: float) -> tuple[Path, tuple[int, ...]]:
    """Join paths, each from where the one before ends, to one that is driven without stopping between them.

    Turns in place between two legs are left out: the robot need not have the yaw of a pose that it drives through. A
    sharp bend there is rounded, as far as the path then still passes within `within_m` of the pose and the robot fits.

    Args:
        legs: The paths.
        costmap: Where they lead.
        within_m: How far from the poses between them the path may pass [m].

    Returns:
        The path, and the index of its pose at each place where two legs meet, or nearest to it.
    """
    if len(legs) == 1:
        return legs[0], ()
    parts = [_without_turns(leg, start=k > 0, end=k < len(legs) - 1) for k, leg in enumerate(legs)]
    poses, backward = parts[0]
    joints: list[int] = []
    for after, behind in parts[1:]:
        arc = _arc(poses, after, within_m) if not (backward[-1:].any() or behind[:1].any()) else None
        if arc is not None and _is_free(poses[-2], arc, after[1], costmap):
            joints.append(len(poses) - 1 + len(arc) // 2)
            poses = np.concatenate([poses[:-1], arc, after[1:]])
            backward = np.concatenate([backward, np.zeros(len(arc) - 1, np.bool_), behind])
        else:
            joints.append(len(poses) - 1)
            poses = np.concatenate([poses, after])
            backward = np.concatenate([backward, [False], behind])
    names = dict.fromkeys(leg.planner for leg in legs)
    joined = replace(
        legs[-1],
        poses=poses,
        backward=backward,
        cost=math.fsum(leg.cost for leg in legs),
        planner="+".join(names),
        replans=sum(leg.replans for leg in legs),
        start_snapped_m=legs[0].start_snapped_m,
    )
    return joined, tuple(joints)


def _without_turns(leg: Path, *, start: bool, end: bool) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Return poses and directions of a leg, without the turns in place at its start or its end."""
    poses, backward = leg.poses, leg.backward
    first, last = 0, len(poses) - 1
    while start and first < last and math.dist(poses[first + 1, :2], poses[0, :2]) <= _SAME_PLACE_M:
        first += 1
    while end and last > first and math.dist(poses[last - 1, :2], poses[-1, :2]) <= _SAME_PLACE_M:
        last -= 1
    return poses[first : last + 1], backward[first:last]


def _arc(before: FloatArray, after: FloatArray, within_m: float) -> FloatArray | None:
    """Return poses of the arc that rounds the bend between two legs; None where there is none to round."""
    if len(before) < 2 or len(after) < 2 or within_m <= 0.0:
        return None
    corner = after[0, :2]
    into, out = corner - before[-2, :2], after[1, :2] - corner
    lengths = float(np.hypot(*into)), float(np.hypot(*out))
    if min(lengths) <= _SAME_PLACE_M:
        return None
    heading = math.atan2(into[1], into[0])
    bend = wrap_angle(math.atan2(out[1], out[0]) - heading)
    least, most = _ROUNDED_RAD
    if not least < abs(bend) < most:
        return None
    half = 0.5 * abs(bend)
    farthest = within_m / (1.0 / math.cos(half) - 1.0)  # the radius of which the arc passes so far from the corner
    radius = min(min(*lengths, _LONGEST_CUT_M) / math.tan(half), farthest)
    begin = corner - radius * math.tan(half) * into / lengths[0]
    side = math.copysign(1.0, bend)
    centre = begin + side * radius * np.array([-math.sin(heading), math.cos(heading)])
    yaws = heading + np.linspace(0.0, bend, math.ceil(abs(bend) / _PIECE_RAD) + 1)
    x, y = centre[0] + side * radius * np.sin(yaws), centre[1] - side * radius * np.cos(yaws)
    return np.column_stack([x, y, yaws])


def _is_free(before: FloatArray, arc: FloatArray, after: FloatArray, costmap: Costmap) -> bool:
    return PathCheck(Path(np.vstack([before, arc, after]))).first_hit(costmap) is None


_STEP_M = 0.05
_START_OFF_M = 0.35  # as far as something may push a robot into what it sees; less than across anything
_STOPS_WITHIN_M = 0.05
_YAWS = np.arange(16) * (np.pi / 8.0)


def nearest_free_pose(costmap: Costmap, pose: Pose2D, within_m: float, *, any_yaw: bool = False) -> Pose2D | None:
    """Return the pose nearest to one where the footprint touches nothing, on a grid of 5 cm; None if there is none.

    Args:
        costmap: Where it stands.
        pose: Where it should stand, map frame.
        within_m: How far off the free pose may be [m].
        any_yaw: Whether any yaw will do; it is tried in 16 directions, and the given one stays where it fits.
    """
    count = int(within_m / _STEP_M + 1e-9)
    steps = np.arange(-count, count + 1) * _STEP_M
    dx, dy = (part.ravel() for part in np.meshgrid(steps, steps))
    distances = np.hypot(dx, dy)
    near = np.flatnonzero(distances <= within_m + 1e-9)
    near = near[distances[near].argsort(kind="stable")]
    x, y = pose.x + dx[near], pose.y + dy[near]
    reachable = np.flatnonzero(costmap.cost_at(x, y) < INSCRIBED)
    yaws = np.concatenate([[pose.yaw], pose.yaw + _YAWS[1:]]) if any_yaw else np.array([pose.yaw])
    for index in reachable.tolist():
        poses = np.column_stack([np.full(len(yaws), x[index]), np.full(len(yaws), y[index]), yaws])
        free = np.flatnonzero(~costmap.footprint_collides(poses))
        if len(free):
            return Pose2D(float(x[index]), float(y[index]), float(yaws[free[0]]))
    return None


def free_ends(
    costmap: Costmap, static: Costmap | None, start: Pose2D, goal: Goal, tolerance_m: float
) -> tuple[Pose2D, Goal]:
    """Return where to plan from and to: beside the robot and the goal, where what was sensed is too close to them.

    Args:
        costmap: With what was sensed.
        static: Without that; None without a map. A goal that is occupied there is left to the planner.
        start: Where the robot is, map frame.
        goal: The goal.
        tolerance_m: How far from the goal the robot may stop [m].

    Raises:
        BlockedPoseError: If the goal is occupied by something that is not on the map.
    """
    if costmap.footprint_collides(start.as_tuple())[0]:
        start = nearest_free_pose(costmap, start, _START_OFF_M) or start
    if not _is_occupied(costmap, goal) or (static is not None and _is_occupied(static, goal)):
        return start, goal
    found = nearest_free_pose(costmap, goal.pose, max(0.0, tolerance_m - _STOPS_WITHIN_M), any_yaw=goal.yaw_free)
    if found is None:
        raise BlockedPoseError(
            f"the goal ({goal.pose.x:.2f}, {goal.pose.y:.2f}) is occupied by something that is not on the map, and the "
            f"robot does not fit anywhere within the tolerance of {tolerance_m:g} m; clear it, or choose another goal",
            pose=goal.pose.as_tuple(),
        )
    return start, Goal(found.x, found.y, None if goal.yaw_free else found.yaw)


def _is_occupied(costmap: Costmap, goal: Goal) -> bool:
    if goal.yaw_free:
        return int(costmap.cost_at(goal.pose.x, goal.pose.y)) >= INSCRIBED
    return bool(costmap.footprint_collides(goal.pose.as_tuple())[0])


_FROM_EDGE_M = 0.1
_COST_M = 1.0  # a place at an obstacle counts as so much farther away from the goal


def goal_in_window(costmap: Costmap, start: Pose2D, goal: Goal) -> Goal:
    """The goal itself where the costmap contains it, otherwise the place nearest to it that the robot can get to.

    That is judged by the inscribed circle and in a straight line, so a window has dead ends that a map does not have.

    Args:
        costmap: The window.
        start: Where the robot is, map frame.
        goal: Where it is to go.

    Returns:
        A goal within the costmap, to be reached with any yaw where it is not the goal itself; the goal itself also
        where the robot cannot get anywhere.
    """
    edge = math.ceil((costmap.circumscribed_radius + _FROM_EDGE_M) / costmap.resolution)
    rows, cols = costmap.shape
    row, col = (int(index) for index in costmap.world_to_cell(goal.x, goal.y))
    if edge <= row < rows - edge and edge <= col < cols - edge:
        return goal
    labels, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), diagonal=False)
    row, col = (int(index) for index in costmap.world_to_cell(start.x, start.y))
    if not costmap.contains(row, col) or labels[row, col] == 0:
        return goal
    inner = labels[edge : rows - edge, edge : cols - edge]
    places = np.argwhere(inner == labels[row, col]) + edge
    if len(places) == 0:
        return goal
    x, y = costmap.cell_to_world(places[:, 0], places[:, 1])
    cost = costmap.data[places[:, 0], places[:, 1]] / (INSCRIBED - 1)
    nearest = int((np.hypot(x - goal.x, y - goal.y) + _COST_M * cost).argmin())
    return Goal(float(x[nearest]), float(y[nearest]))
