"""`Replanner`: the path that a navigator follows; planned, checked against the costmap, and planned again."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, PlanningError, PlanningStoppedError
from trundle.fault import check_result
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.navigation.drive import Drive, Now
from trundle.navigation.followed_path import FollowedPath, join_legs
from trundle.navigation.obstacle_watch import MoverMemory, ObstacleWatch
from trundle.navigation.plan_ends import free_ends, goal_in_window
from trundle.navigation.planning_limits import FailedPlan, PlanningBudget, PlanningTries, moves, timed_out
from trundle.navigation.sensing import SensedMap
from trundle.navigation.speed_limiter import BRAKING_SHARE
from trundle.navigation.status import NavigationStatus
from trundle.path import Path
from trundle.planning import Cancellation, PathHit, Planner
from trundle.planning.effort import nominal_expansions
from trundle.robots import Robot

_EXTEND_BEFORE_M, _EXTEND_EVERY_S = 2.5, 1.0
"""A path that ends short of the goal, as that lies outside of a moving window, is planned again before its end [m]."""

_LEAST_S = 1e-3  # what is left of a deadline for the legs of a path
_AROUND_M, _BESIDE_M = 2.0, 0.3
"""What was seen to move so near the robot [m] may be what leaves no path; so near the path, what blocks it."""
_SEE_AGAIN_S = 1.0
_NEARER_M = 1.0  # to the goal than at the last stop: so often at most it forgets what it saw
_ROUND_WITHIN = 0.7
"""Share of the tolerance of a goal that the robot drives through which rounding a bend there may use."""


class Replanner:
    """Plans a path to the goal of a drive, and replans where that is blocked or there may be a better one.

    Args:
        drive: The drive, whose status, error and counts it keeps.
        robot: The robot.
        sensed: The costmap with what its scans saw.
        quick: What plans instead round something that was sensed, while the robot moves; none means the planner.
        take: Called with every path that is followed from now on.

    Attributes:
        followed: The path that is followed, or None.
        tries: The deadline of plans.
        budget: How much plans after the first one may search.
        obstacle: Since when the path is blocked by something that was sensed.
        movers: Where something was seen to move.
        is_given: Whether the path was given, and is followed as it is: no other one is planned.
    """

    def __init__(
        self,
        drive: Drive,
        robot: Robot,
        sensed: SensedMap,
        quick: Planner | None,
        take: Callable[[FollowedPath], None],
    ) -> None:
        self._drive, self._robot, self._sensed = drive, robot, sensed
        self._quick, self._take_up = quick, take
        settings = drive.settings
        self.tries = PlanningTries(settings.planning_deadline_s)
        self.budget = PlanningBudget(settings.replan_rate, settings.replan_expansions)
        self.obstacle = ObstacleWatch(settings.wait_s, settings.patience_s, settings.mover_patience_s)
        self.movers = MoverMemory()
        self.followed: FollowedPath | None = None
        self.is_given = False
        self._ends_short = False
        self._checked: Costmap | None = None
        self._planned_at = 0.0
        self._forgot_at, self._forgot_m = -math.inf, math.inf
        self._failed: FailedPlan | None = None
        self._searched_at = -math.inf

    def begin(self, costmap: Costmap) -> None:
        """Forget the path: there is another goal."""
        self.followed = None
        self.is_given = self._ends_short = False
        self._checked = costmap
        self._planned_at = 0.0
        self._forgot_at, self._forgot_m = -math.inf, math.inf
        self.obstacle.reset()
        self.tries.reset()
        self.budget.reset()
        self._failed = None
        self._searched_at = -math.inf

    def take_given(self, path: Path) -> None:
        """Follow a path that was not planned here."""
        self.is_given = True
        self._checked = None
        self.take(FollowedPath(path, path))

    def pass_goal(self) -> None:
        """The robot has passed the next goal that the path leads through."""
        if self.followed is not None:
            self.followed.pass_mark()
        self._failed = None

    def drop_path(self) -> None:
        """Forget the path: the robot is somewhere else."""
        self.followed = self._failed = None
        self.obstacle.clear()
        self.movers.clear()

    @property
    def searches_less(self) -> bool:
        """Whether plans round what was sensed search less than the planner does."""
        return self._quick is not None

    # Planning -------------------------------------------------------------------------------------------------------

    def plan(self, now: Now, planner: Planner | None = None, *, needed: bool = True) -> FollowedPath:
        """Plan from here to the goal, by another planner if one is given; the path that is followed stays.

        Args:
            now: Where the robot is.
            planner: Another planner.
            needed: Whether there is no path to follow, or it is blocked.

        Raises:
            InputError: If there is no goal.
            PlanningError: If there is no path.
        """
        drive = self._drive
        if drive.target is None:
            raise InputError("there is no goal to plan to; call set_goal first")
        self._planned_at, self._checked = now.time, now.costmap
        deadline_s = self.tries.deadline_s(now.twist)
        planner = self._choose_planner(now) if planner is None else planner
        began, expanded = clock.perf_counter(), drive.planning_expansions
        try:
            followed = self._plan_legs(now, planner, deadline_s)
        except PlanningError as error:
            if timed_out(error):
                self.tries.time_out(now.twist, now.time)
            elif planner is not self._quick:
                self._failed = FailedPlan(error, planner, now.pose, drive.ahead, now.costmap)
            elif self._failed is not None and isinstance(error, PlanningStoppedError):
                # It says more than that a short search found no path either.
                raise self._failed.error.with_traceback(None) from None
            raise
        finally:
            seconds = clock.perf_counter() - began
            drive.planning_time_s += seconds
            self.budget.spend(drive.planning_expansions - expanded, now.time, needed=needed)
            if planner is not self._quick:
                self._searched_at = now.time
        self.tries.succeed(seconds)
        self._failed = None
        return followed

    def _plan_legs(self, now: Now, planner: Planner, deadline_s: float | None) -> FollowedPath:
        """Plan to each goal up to the next stop, from the one before, and join the paths."""
        drive = self._drive
        began, left_s = clock.perf_counter(), deadline_s
        start, planned, smooth = now.pose, list[Path](), list[Path]()
        self._ends_short = False
        for number, goal in enumerate(drive.ahead, drive.first_number):
            try:
                leg = self._plan_leg(now.costmap, start, goal, planner, left_s)
            except PlanningError as error:
                if len(drive.ahead) > 1:
                    error.args = (f"goal {number}: {error}",)
                raise
            if deadline_s is not None:
                left_s = max(_LEAST_S, deadline_s - (clock.perf_counter() - began))
            planned.append(leg)
            if (smoother := drive.smoother) is not None:
                leg = check_result(smoother.smooth(leg, now.costmap), Path, smoother, "smooth")
            smooth.append(leg)
            start = planned[-1].goal
            if self._ends_short:
                break
        path, joints = join_legs(smooth, now.costmap, _ROUND_WITHIN * drive.settings.through_tolerance)
        raw = path if drive.smoother is None else join_legs(planned, now.costmap, 0.0)[0]
        return FollowedPath(raw, path, joints)

    def _plan_leg(
        self, costmap: Costmap, start: Pose2D, goal: Goal, planner: Planner, deadline_s: float | None
    ) -> Path:
        drive, target = self._drive, goal
        if self._sensed.is_active:
            aim = goal_in_window(costmap, start, goal) if self._sensed.may_contain(goal.pose) else goal
            is_stop = goal is drive.ahead[-1]
            tolerance = drive.goal_checker.xy_tolerance if is_stop else drive.settings.through_tolerance
            start, target = free_ends(costmap, self._sensed.static, start, aim, tolerance)
            self._ends_short = aim is not goal
        count = Cancellation()
        path: Path | None = None
        try:
            made = planner.plan(costmap, start, target, deadline_s=deadline_s, cancel=count)
            path = check_result(made, Path, planner, "plan")
            return path
        finally:
            if count.expansions is None:
                count.count(nominal_expansions(costmap.shape, None if path is None else _cells_of(path, costmap)))
            drive.planning_expansions += count.expansions or 0

    def take(self, followed: FollowedPath) -> None:
        """Follow a path from now on."""
        self.followed = followed
        self._take_up(followed)

    def _choose_planner(self, now: Now) -> Planner:
        """The planner; while something that was sensed blocks the path and the robot moves, one that searches less.

        That one also plans where the last plans are not paid for yet.
        """
        if self._quick is None or not self.obstacle.is_blocked:
            return self._drive.planner
        if self.budget.must_wait(now.time):
            return self._quick
        stands = not moves(now.twist)
        return self._drive.planner if self.obstacle.is_thorough(now.time, stands=stands) else self._quick

    def _must_wait(self, now: Now) -> bool:
        """Whether no plan may be made now: the last ones are not paid for, and there is none that searches less."""
        return self.budget.must_wait(now.time) and (self._quick is None or not self.obstacle.is_blocked)

    def _refusal(self, now: Now, planner: Planner) -> PlanningError | None:
        """Why a plan by this planner is not made: there were too many, or it would fail as the last one did."""
        drive, failed = self._drive, self._failed
        if self.budget.is_spent(now.time):
            return self.budget.refuse(drive.error)
        if failed is None:
            return None
        is_same = planner is failed.planner or (planner is self._quick and failed.planner is drive.planner)
        holds = is_same and failed.holds(now.pose, drive.ahead, now.costmap, noisy=self._sensed.is_active)
        return failed.error if holds else None

    def plan_first(self, now: Now) -> bool:
        """Make the plan that the robot waits for; return whether it may drive on."""
        if self.obstacle.is_blocked and not self.obstacle.may_plan(now.time):
            return False
        if not self._attempt(now):
            self.obstacle.fail()
            return True if self.followed is not None else self._wait_for_path(now)
        if not self.tries.pending:
            self.obstacle.clear()
        return not self.tries.pending

    def _wait_for_path(self, now: Now) -> bool:
        """Stand where there is no path, for a while if what was sensed may move away; return False."""
        drive = self._drive
        drive.status = NavigationStatus.NO_PATH
        if self._sensed.is_active:
            self._see(now, None)
            if not self.gives_up(now):
                drive.status, drive.message = NavigationStatus.BLOCKED, f"blocked: {drive.error}"
        return False

    @property
    def standing_reason(self) -> str:
        """Why a robot that stands has no path to follow, by the last plan; empty where it has one."""
        drive = self._drive
        if drive.error is None:
            return "waiting to plan" if self.tries.pending else ""
        pose = drive.error.pose if isinstance(drive.error, BlockedPoseError) else None
        if pose is not None and any((goal.pose.x, goal.pose.y) == pose[:2] for goal in drive.ahead):
            return "goal occupied"
        return "no path"

    def follow(self, now: Now) -> None:
        """Take where the robot is: it is more patient where something was seen to move beside it."""
        obstacle = self.obstacle
        obstacle.beside_mover = False
        obstacle.follow(now.pose, now.time)
        if obstacle.gives_up:
            reach = self._robot.circumscribed_radius + _BESIDE_M
            obstacle.beside_mover = self.movers.was_near(now.pose.x, now.pose.y, reach)

    def _see(self, now: Now, hit: PathHit | None) -> None:
        """The path is blocked now, or there is none; remember whether by what was seen to move, and how far ahead."""
        obstacle, drive = self.obstacle, self._drive
        obstacle.see(now.time, self._gap_m(now, hit))
        if obstacle.by_mover:
            return
        reach = self._robot.circumscribed_radius
        x, y = (now.pose.x, now.pose.y) if hit is None else hit.pose[:2]
        near = [(x, y, reach + (_AROUND_M if hit is None else _BESIDE_M))]
        near += [(goal.pose.x, goal.pose.y, reach + drive.goal_checker.xy_tolerance) for goal in drive.ahead[-1:]]
        obstacle.by_mover = any(self.movers.was_near(*place) for place in near)

    def _gap_m(self, now: Now, hit: PathHit | None) -> float:
        """How far ahead the path is blocked [m]: along it, or straight, where the robot has backed up."""
        if hit is None or self.followed is None:
            return math.inf
        along_m = hit.along - float(self.followed.check.along[self.followed.index])
        return max(along_m, math.hypot(hit.pose[0] - now.pose.x, hit.pose[1] - now.pose.y))

    def gives_up(self, now: Now) -> bool:
        """Whether the robot has stood for too long, and sees no path even if it forgets what it saw elsewhere.

        It forgets once in a stop. A stop counts as another one where the robot is nearer to the goal by 1 m: otherwise
        it would drive to a wall, forget it and drive there again, without end.
        """
        if not self.obstacle.gives_up:
            return False
        left_m = math.inf if self._drive.target is None else now.pose.distance_to(self._drive.target.pose)
        if math.isinf(self._forgot_at) or left_m < self._forgot_m - _NEARER_M:
            self._forgot_at, self._forgot_m = now.time, left_m
            self._sensed.reset()
            self.obstacle.plan_soon()
        if self.budget.must_wait(now.time) and self._searched_at < self._forgot_at:
            return False
        return now.time - self._forgot_at > _SEE_AGAIN_S

    @property
    def fastest(self) -> float:
        """How fast the robot may drive on [m/s] towards something that moves and blocks its path."""
        braking = BRAKING_SHARE * self._robot.limits.linear_acceleration
        return math.sqrt(2.0 * braking * max(0.0, self.obstacle.room_m))

    # Planning again -------------------------------------------------------------------------------------------------

    def reconsider(self, followed: FollowedPath, now: Now) -> None:
        """Plan again where a changed map blocks the path, or it is time to look for a better one."""
        if self.is_given:
            self._watch_given(followed, now)
            return
        if followed.has_missed(self._drive.settings.through_tolerance):
            self.replan(now)
            return
        changed = now.costmap is not self._checked
        if self._ends_short and followed.left_m < _EXTEND_BEFORE_M and now.time - self._planned_at >= _EXTEND_EVERY_S:
            self.replan(now)
            return
        interval_s = self._drive.settings.replan_interval_s
        due = interval_s is not None and now.time - self._planned_at >= interval_s - 1e-9
        if not (changed or due or self.obstacle.is_blocked):
            return
        self._checked = now.costmap
        hit = followed.first_hit(now.costmap)
        if hit is None:
            self._drive.error = None
            self.obstacle.clear()
        if hit is not None and self._sensed.is_active:
            self._go_round(hit, followed, now)
        elif hit is not None:
            self.replan(now)
        elif due and not self.tries.stops_first(now.twist):
            self._look_for_better(now)

    def _watch_given(self, followed: FollowedPath, now: Now) -> None:
        """Note whether something that was sensed blocks a path that is followed as it is."""
        if now.costmap is self._checked and not self.obstacle.is_blocked:
            return
        self._checked = now.costmap
        hit = followed.first_hit(now.costmap)
        if hit is None or not self._sensed.is_active:
            self.obstacle.clear()
            return
        self._see(now, hit)
        self._say_blocked(hit)

    def _say_blocked(self, hit: PathHit) -> None:
        x, y = self._sensed.obstacle_near(hit.pose[0], hit.pose[1], self._robot.circumscribed_radius + 0.2)
        self._drive.message = f"blocked: obstacle ahead at ({x:.2f}, {y:.2f})"

    def _go_round(self, hit: PathHit, followed: FollowedPath, now: Now) -> None:
        """Plan a path round what was sensed on this one, and take it unless waiting is better."""
        drive = self._drive
        self._see(now, hit)
        self._say_blocked(hit)
        if self._must_wait(now) or not self.obstacle.may_plan(now.time) or self.tries.must_wait(now.twist, now.time):
            return
        try:
            found = self._plan_again(now, self._choose_planner(now))
        except PlanningError as error:
            drive.error = error
            if isinstance(error, BlockedPoseError):
                drive.message = f"blocked: {error}"
            self.obstacle.fail()
            self.tries.settle()
            return
        drive.error = None
        if self.obstacle.takes(float(found.check.along[-1]), followed.left_m, now.time):
            self.take(found)
            self.obstacle.clear()

    def replan(self, now: Now, planner: Planner | None = None) -> bool:
        """Plan now, by another planner if one is given, and follow the new path; False if there is none."""
        return self._attempt(now, planner, again=True)

    def _plan_again(self, now: Now, planner: Planner, *, again: bool = True) -> FollowedPath:
        """Plan and count that, unless there is no use in it or there were too many plans.

        Raises:
            PlanningError: If there is no path, or no plan is made.
        """
        refusal = self._refusal(now, planner)
        if refusal is not None:
            raise refusal.with_traceback(None)
        self._drive.replans += again
        return self.plan(now, planner)

    def _attempt(self, now: Now, planner: Planner | None = None, *, again: bool = False) -> bool:
        """Plan now, or leave the plan pending until the robot stands or a pause is over; False if there is no path."""
        drive = self._drive
        if self.tries.must_wait(now.twist, now.time):
            drive.replans += again
            return True
        if self._must_wait(now):
            drive.replans += again
            drive.progress_checker.reset()
            self.tries.pending, drive.status = True, NavigationStatus.BLOCKED
            return True
        is_last = self.budget.is_spent(now.time) and not self.obstacle.is_blocked
        try:
            followed = self._plan_again(now, self._choose_planner(now) if planner is None else planner, again=again)
        except PlanningError as error:
            drive.error = error
            if is_last:
                drive.status, self.tries.pending = NavigationStatus.NO_PATH, True
                return True
            if not timed_out(error):
                self.tries.settle()
                return False
            drive.progress_checker.reset()
            drive.status = NavigationStatus.PLANNING_TIMED_OUT if self.tries.all_spent else NavigationStatus.BLOCKED
            return True
        drive.error = None
        self.take(followed)
        return True

    def _look_for_better(self, now: Now) -> None:
        """Plan again, unless much was planned of late, and follow the new path if it is cheaper by the margin."""
        drive = self._drive
        if self.budget.must_wait(now.time):
            return
        drive.replans += 1
        try:
            followed = self.plan(now, needed=False)
        except PlanningError as error:
            drive.error = error
            self.tries.settle()
            return
        drive.error = None
        if self._is_cheaper(followed, now):
            self.take(followed)

    def _is_cheaper(self, other: FollowedPath, now: Now) -> bool:
        """Whether a new path from here is cheaper by the margin than what is left of the old one."""
        if self.followed is None:
            return True
        left = self.followed.cost_from(now.costmap, now.pose)
        return other.check.cost_from(now.costmap) < (1.0 - self._drive.settings.replan_margin) * left


def _cells_of(path: Path, costmap: Costmap) -> FloatArray:
    """The points of a path in cells, shape (N, 2)."""
    return costmap.origin.inverse().transform_points(path.poses[:, :2]) / costmap.resolution
