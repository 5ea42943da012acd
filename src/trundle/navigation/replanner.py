"""`Replanner`: plans the path that a navigator follows, checks it against the costmap, and plans again."""

from __future__ import annotations

import math
import time as clock

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, PlanningError, PlanningStoppedError
from trundle.geometry import Twist2D
from trundle.navigation.command_check import BRAKING_SHARE
from trundle.navigation.map_doubts import MapDoubts
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.obstacle_watch import MoverMemory, ObstacleWatch
from trundle.navigation.planning_limits import FailedPlan, PlanningBudget, PlanningTries, moves, timed_out
from trundle.navigation.progress import FollowedPath
from trundle.navigation.route_planner import RoutePlanner, is_of_goal
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import NOTHING, Decision, DriveState, NavigationStatus, Snapshot
from trundle.planning import PathHit, Planner
from trundle.robots import Robot

_STAND = Twist2D()

_EXTEND_BEFORE_M, _EXTEND_EVERY_S = 2.5, 1.0
"""A path that ends short of the goal, as that lies outside of a moving window, is planned again before its end [m]."""

_AROUND_M, _BESIDE_M = 2.0, 0.3
"""What was seen to move so near the robot [m] may be what leaves no path; so near the path, what blocks it."""
_SEE_AGAIN_S = 1.0
"""After it has forgotten what it saw, the robot takes in new scans for so long [s] before it gives up."""
_NEARER_M = 1.0  # to the goal than at the last stop: so often at most it forgets what it saw


class Replanner:
    """Plans a path to the goals ahead, and plans again where that is blocked or there may be a better one.

    It answers with decisions: to follow a path, or why there is none.

    Args:
        settings: When it plans again, and how long it waits.
        robot: The robot.
        sensed: The costmap with what its scans saw.
        routes: Makes one path through the goals ahead.
        planner: What plans. If it makes a quick one, that plans round what was sensed while the robot moves.

    Attributes:
        planner: The same; may be replaced.
        followed: The path that is followed, or None.
        tries: The deadline of plans.
        budget: How much plans after the first one may search.
        obstacle: Since when the path is blocked by something that was sensed.
        movers: Where something was seen to move.
        is_given: Whether the path was given, and is followed as it is: no other one is planned.
    """

    def __init__(
        self,
        settings: NavigatorSettings,
        robot: Robot,
        sensed: SensedMap,
        routes: RoutePlanner,
        planner: Planner,
    ) -> None:
        self._settings, self._robot, self._sensed = settings, robot, sensed
        self._routes, self._doubts = routes, MapDoubts(sensed, routes)
        self.use(planner)
        self.tries = PlanningTries(settings.planning_deadline_s)
        self.budget = PlanningBudget(settings.replan_rate, settings.replan_expansions)
        self.obstacle = ObstacleWatch(settings.wait_s, settings.patience_s, settings.mover_patience_s)
        self.movers = MoverMemory()
        self.begin(None)

    def begin(self, costmap: Costmap | None) -> None:
        """Forget the path: there is another goal, and the path to it need not be checked on this costmap."""
        self.followed: FollowedPath | None = None
        self.is_given = self._routes.ends_short = False
        self._checked = costmap
        self._planned_at = 0.0
        self._forgot_at, self._forgot_m = -math.inf, math.inf
        self.obstacle.reset()
        self.tries.reset()
        self.budget.reset()
        self._failed: FailedPlan | None = None
        self._searched_at = -math.inf

    def take_given(self, given: FollowedPath) -> Decision:
        """Follow a path that was not planned here."""
        self.is_given = True
        self._checked = None
        return Decision(path=given)

    def pass_goal(self) -> None:
        """Note that the robot has passed the next goal that the path leads through."""
        if self.followed is not None:
            self.followed.pass_mark()
        self._failed = None

    def drop_path(self) -> None:
        """Forget the path: the robot is somewhere else."""
        self.followed = self._failed = None
        self.obstacle.clear()
        self.movers.clear()

    def use(self, planner: Planner) -> None:
        """Plan with this from now on, and round what was sensed with what it makes for that, if it does."""
        self.planner, self.quick = planner, planner.make_quick()

    @property
    def lost_given(self) -> bool:
        """Whether the pose has jumped away from a path that is followed as it is."""
        return self.is_given and self.followed is None

    @property
    def must_plan(self) -> bool:
        """Whether the robot needs a plan before it drives on."""
        return self.followed is None or self.tries.pending

    def plan(
        self, now: Snapshot, state: DriveState, planner: Planner | None = None, *, needed: bool = True
    ) -> Decision:
        """Plan from here to the goal: a path, or the error that says why there is none.

        Args:
            now: Where the robot is.
            state: Where it is to go.
            planner: Another planner than the navigator's.
            needed: Whether there is no path to follow, or it is blocked.

        Raises:
            InputError: If there is no goal.
        """
        if not state.ahead:
            raise InputError("there is no goal to plan to; call set_goal first")
        self._planned_at, self._checked = now.time, now.costmap
        deadline_s = self.tries.deadline_s(now.twist)
        planner = self._choose_planner(now) if planner is None else planner
        began, self._routes.expansions = clock.perf_counter(), 0
        try:
            if (extended := self._sensed.contain(now.pose, *(goal.pose for goal in state.ahead))) is not None:
                now, self._checked = now._replace(costmap=extended), extended
            path = self._routes.plan(now.costmap, now.pose, state.ahead, state.first_number, planner, deadline_s)
            found = Decision(path=path, clears_error=True)
        except PlanningError as error:
            found = Decision(error=self._note_failure(error, now, state, planner))
        finally:
            seconds = clock.perf_counter() - began
            self.budget.spend(self._routes.expansions, now.time, needed=needed)
            if planner is not self.quick:
                self._searched_at = now.time
        found = found._replace(planning_time_s=seconds, planning_expansions=self._routes.expansions)
        if found.path is not None:
            self.tries.succeed(seconds)
            self._failed = None
        elif found.error is not None and self._doubts_map(found.error, now, state, planner):
            return found.then(self.plan(now._replace(costmap=self._sensed.costmap), state, planner, needed=needed))
        return found

    def _doubts_map(self, error: PlanningError, now: Snapshot, state: DriveState, planner: Planner) -> bool:
        """Whether to plan again, as things were taken off the map."""
        if self._sensed.awaits_scan(now.time):
            self.tries.pending, self._failed = True, None
        if planner is self.quick:
            return self._doubts.help_short(error, now.pose, state.ahead, self.obstacle.standing_s)
        deadline_s = self.tries.deadline_s(now.twist)
        return self._doubts.help_long(error, now, state.ahead, planner, deadline_s, self.budget)

    def _note_failure(self, error: PlanningError, now: Snapshot, state: DriveState, planner: Planner) -> PlanningError:
        """Remember that a plan found no path; return the error that says most about it."""
        if timed_out(error):
            self.tries.time_out(now.twist, now.time)
        elif planner is not self.quick:
            self._failed = FailedPlan(error, planner, now.pose, state.ahead, now.costmap)
        elif isinstance(error, PlanningStoppedError):  # others say more than that a short search found no path either
            error = error if self._failed is None else self._failed.error.with_traceback(None)
            return self.budget.refuse(error) if self.budget.is_spent(now.time) else error
        return error

    def _choose_planner(self, now: Snapshot) -> Planner:
        """Return the planner; while something that was sensed blocks the path and the robot moves, the quick one.

        That one also plans where the last plans are not paid for, or all expansions are used up.
        """
        if self.quick is None or (not self.obstacle.is_blocked and not self._goes_on(now)):
            return self.planner
        if self.budget.must_wait(now.time) or self.budget.is_spent(now.time):
            return self.quick
        stands = not moves(now.twist)
        return self.planner if self.obstacle.is_thorough(now.time, stands=stands) else self.quick

    def _goes_on(self, now: Snapshot) -> bool:
        """Return whether it goes on by short searches, with all expansions used up: what was seen to move is near."""
        if self.quick is None or not self.budget.is_spent(now.time):
            return False
        return self.movers.was_near(now.pose.x, now.pose.y, self._robot.circumscribed_radius + _AROUND_M)

    def _must_wait(self, now: Snapshot) -> bool:
        """Return whether no plan may be made now: the rate is used up, and no planner searches less."""
        return self.budget.must_wait(now.time) and (self.quick is None or not self.obstacle.is_blocked)

    def _refusal(self, now: Snapshot, state: DriveState, planner: Planner) -> PlanningError | None:
        """Return why a plan by this planner is not made: there were too many, or it would fail as the last one did."""
        failed = self._failed
        if planner is not self.quick and self.budget.is_spent(now.time):
            return self.budget.refuse(state.error)
        if failed is None:
            return None
        is_same = planner is failed.planner or (planner is self.quick and failed.planner is self.planner)
        holds = is_same and failed.holds(now.pose, state.ahead, now.costmap, noisy=self._sensed.is_active)
        return failed.error if holds else None

    def plan_first(self, now: Snapshot, state: DriveState) -> Decision:
        """Make the plan that the robot waits for; the command is to stand where it may not drive on yet."""
        if self._sensed.await_scan(now.time) or (self.obstacle.is_blocked and not self.obstacle.may_plan(now.time)):
            return self._stand(state)
        made = self._attempt(now, state)
        if self.finds_none(made):
            self.obstacle.fail()
            if self.followed is not None:
                return made
            made = made.then(self._wait_for_path(now, state.after(made)))
        elif not self.tries.pending:
            self.obstacle.clear()
            return made
        return made.then(self._stand(state.after(made)))

    def _stand(self, state: DriveState) -> Decision:
        reason = self.standing_reason(state)
        return Decision(_STAND, reasons=(reason,) if reason else ())

    def _wait_for_path(self, now: Snapshot, state: DriveState) -> Decision:
        """Stand where there is no path, for a while if what was sensed may move away."""
        if self._sensed.is_active:
            self._see(now, state, None)
            if not self.gives_up(now, state):
                return Decision(status=NavigationStatus.BLOCKED, message=f"blocked: {state.error}")
        return Decision(status=NavigationStatus.NO_PATH)

    def standing_reason(self, state: DriveState) -> str:
        """Return why a robot that stands has no path to follow, by the last plan; empty where it has one."""
        error = state.error
        if error is None:
            return "waiting to plan" if self.tries.pending else ""
        return "goal occupied" if is_of_goal(error, state.ahead) else "no path"

    def follow(self, now: Snapshot) -> None:
        """Note where the robot is: it waits for longer where something was seen to move beside it."""
        obstacle = self.obstacle
        obstacle.beside_mover = False
        obstacle.follow(now.pose, now.time)
        if obstacle.gives_up:
            reach = self._robot.circumscribed_radius + _BESIDE_M
            obstacle.beside_mover = self.movers.was_near(now.pose.x, now.pose.y, reach)

    def _see(self, now: Snapshot, state: DriveState, hit: PathHit | None) -> None:
        """Note that the path is blocked or missing: whether by something that moves, and how far ahead."""
        obstacle, followed = self.obstacle, self.followed
        obstacle.see(now.time, math.inf if hit is None or followed is None else followed.gap_m(hit, now.pose))
        if obstacle.by_mover:
            return
        reach = self._robot.circumscribed_radius
        x, y = (now.pose.x, now.pose.y) if hit is None else hit.pose[:2]
        near = [(x, y, reach + (_AROUND_M if hit is None else _BESIDE_M))]
        around_goal = reach + self._routes.goal_checker.xy_tolerance
        near += [(goal.pose.x, goal.pose.y, around_goal) for goal in state.ahead[-1:]]
        obstacle.by_mover = any(self.movers.was_near(*place) for place in near)

    def gives_up(self, now: Snapshot, state: DriveState) -> bool:
        """Return whether the robot has stood for too long, and sees no path even if it forgets what it saw elsewhere.

        It forgets once in a stop. A stop counts as another one where the robot is nearer to the goal by 1 m: otherwise
        it would drive to a wall, forget it and drive there again, without end.
        """
        if not self.obstacle.gives_up:
            return False
        left_m = math.inf if state.target is None else now.pose.distance_to(state.target.pose)
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
        room_m = self.obstacle.room_m
        if room_m == math.inf:
            return math.inf
        return math.sqrt(2.0 * BRAKING_SHARE * self._robot.limits.linear_acceleration * max(0.0, room_m))

    def reconsider(self, followed: FollowedPath, now: Snapshot, state: DriveState) -> Decision:
        """Plan again where a changed map blocks the path, or it is time to look for a better one."""
        if self.is_given:
            return self._watch_given(followed, now, state)
        if followed.has_missed(self._settings.through_tolerance):
            return self.replan(now, state)
        changed = now.costmap is not self._checked
        since_s = now.time - self._planned_at
        if self._routes.ends_short and followed.left_m < _EXTEND_BEFORE_M and since_s >= _EXTEND_EVERY_S:
            return self.replan(now, state)
        interval_s = self._settings.replan_interval_s
        due = interval_s is not None and since_s >= interval_s - 1e-9
        if not (changed or due or self.obstacle.is_blocked):
            return NOTHING
        self._checked = now.costmap
        hit = followed.first_hit(now.costmap)
        if hit is not None:
            return self._go_round(hit, followed, now, state) if self._sensed.is_active else self.replan(now, state)
        self.obstacle.clear()
        free = NOTHING if state.error is None else Decision(clears_error=True)
        if due and not self.tries.stops_first(now.twist):
            return free.then(self._look_for_better(now, state))
        return free

    def _watch_given(self, followed: FollowedPath, now: Snapshot, state: DriveState) -> Decision:
        """Note whether something that was sensed blocks a path that is followed as it is."""
        if now.costmap is self._checked and not self.obstacle.is_blocked:
            return NOTHING
        self._checked = now.costmap
        hit = followed.first_hit(now.costmap)
        if hit is None or not self._sensed.is_active:
            self.obstacle.clear()
            return NOTHING
        self._see(now, state, hit)
        return self._say_blocked(hit)

    def _say_blocked(self, hit: PathHit) -> Decision:
        x, y = self._sensed.obstacle_near(hit.pose[0], hit.pose[1], self._robot.circumscribed_radius + 0.2)
        return Decision(message=f"blocked: obstacle ahead at ({x:.2f}, {y:.2f})")

    def _go_round(self, hit: PathHit, followed: FollowedPath, now: Snapshot, state: DriveState) -> Decision:
        """Plan a path round what was sensed on this one, and take it unless waiting is better."""
        self._see(now, state, hit)
        said = self._say_blocked(hit)
        if self._must_wait(now) or not self.obstacle.may_plan(now.time) or self.tries.must_wait(now.twist, now.time):
            return said
        found = said.then(self._plan_again(now, state, self._choose_planner(now)))
        if found.path is None:
            self.obstacle.fail()
            self.tries.settle()
            occupied = isinstance(found.error, BlockedPoseError)
            return found._replace(message=f"blocked: {found.error}") if occupied else found
        if not self.obstacle.takes(float(found.path.check.along[-1]), followed.left_m, now.time):
            return found._replace(path=None)
        self.obstacle.clear()
        return found

    def replan(self, now: Snapshot, state: DriveState, planner: Planner | None = None) -> Decision:
        """Plan now, by another planner if one is given, and follow the new path."""
        return self._attempt(now, state, planner, again=True)

    def finds_none(self, made: Decision) -> bool:
        """Return whether `replan` found no path, and no other plan is to be made before the robot drives on."""
        return made.error is not None and not self.tries.pending

    def _plan_again(self, now: Snapshot, state: DriveState, planner: Planner, *, again: bool = True) -> Decision:
        """Plan and count that, unless there is no use in it or there were too many plans."""
        if self._doubts.see_more(self._failed, now, state.ahead):
            now = now._replace(costmap=self._sensed.costmap)
        refusal = self._refusal(now, state, planner)
        if refusal is not None:
            return Decision(error=refusal.with_traceback(None))
        return Decision(replans=int(again)).then(self.plan(now, state, planner))

    def _attempt(
        self, now: Snapshot, state: DriveState, planner: Planner | None = None, *, again: bool = False
    ) -> Decision:
        """Plan now, or leave the plan pending until the robot stands or a pause is over."""
        if self.tries.must_wait(now.twist, now.time):
            return Decision(replans=int(again))
        if self._must_wait(now):
            self.tries.pending = True
            return Decision(status=NavigationStatus.BLOCKED, replans=int(again), restarts_progress=True)
        is_last = self.budget.is_spent(now.time) and not (self.obstacle.is_blocked or self._goes_on(now))
        planner = self._choose_planner(now) if planner is None else planner
        made = self._plan_again(now, state, planner, again=again)
        if made.error is None:
            return made
        if is_last:
            self.tries.pending = True
            return made._replace(status=NavigationStatus.NO_PATH)
        if not timed_out(made.error):
            self.tries.settle()
            return made
        status = NavigationStatus.PLANNING_TIMED_OUT if self.tries.all_spent else NavigationStatus.BLOCKED
        return made._replace(status=status, restarts_progress=True)

    def _look_for_better(self, now: Snapshot, state: DriveState) -> Decision:
        """Plan again, unless much was planned of late, and follow the new path if it is cheaper by the margin."""
        if self.budget.must_wait(now.time):
            return NOTHING
        found = Decision(replans=1).then(self.plan(now, state, needed=False))
        if found.path is None:
            self.tries.settle()
            return found
        left = 0.0 if self.followed is None else self.followed.cost_from(now.costmap, now.pose)
        is_cheaper = found.path.check.cost_from(now.costmap) < (1.0 - self._settings.replan_margin) * left
        return found if self.followed is None or is_cheaper else found._replace(path=None)
