"""`NavigatorRequests`: what a program asks of a `Navigator` between two updates: goals, behaviors, plans, reports."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from trundle.control.latency import DelayedCommands, Latency
from trundle.costmap.layers import ScanPlacer
from trundle.errors import InputError, PlanningError, PlanningStoppedError
from trundle.fault import check_result
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.agent import AgentInfo, AgentReport
from trundle.navigation.behaviors import Behavior
from trundle.navigation.behaviors.behavior import check_behavior_kind
from trundle.navigation.goal_queue import Route
from trundle.navigation.inputs import read_goal
from trundle.navigation.navigator_attributes import NavigatorAttributes
from trundle.navigation.progress import FollowedPath
from trundle.navigation.recovery import Recovery
from trundle.navigation.relocalization import Relocalization
from trundle.navigation.sensing import SensedTracks
from trundle.navigation.state import NOTHING, Decision, DriveState, NavigationStatus, Snapshot
from trundle.path import Path
from trundle.values import check_kind

_STAND = Twist2D(0.0, 0.0)


class NavigatorRequests(NavigatorAttributes):
    """What a `Navigator` can be asked for, and the one place where its drive changes; `update` is the navigator's."""

    _delayed: DelayedCommands
    _recovery: Recovery
    _relocalization: Relocalization
    _tracked: SensedTracks
    _placer: ScanPlacer
    _command: Twist2D
    _time: float
    _clock: float
    _is_held: bool
    _has_scans: bool

    # Goals ----------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal and everything about it, and what was sensed."""
        self._clock = 0.0
        self._is_held = self._has_scans = False
        self._delayed.clear()
        self._runner.reset()
        self._sensed.begin_run()
        self._tracked.reset()
        self._placer.reset()
        self.tracks = ()
        self._begin(None)
        self.controller.reset(seed=seed)

    def set_goal(
        self, goal: Pose2D | Sequence[float] | float, y: float | None = None, yaw: float | None = None
    ) -> None:
        """Set where to go: `set_goal(5.0, 3.5)`, `set_goal(5.0, 3.5, 1.57)` or `set_goal((5.0, 3.5, 1.57))`.

        Without a yaw the robot may stop at the goal in any direction. The old plan is forgotten; the new one is made
        at the next `update`.

        Raises:
            InputError: If these are not two or three finite numbers.
        """
        self.set_goals([read_goal(goal, y, yaw)])

    def set_goals(self, goals: Sequence[Pose2D | Sequence[float]], *, through: bool = False) -> None:
        """Set several goals, to be reached in order: `set_goals([(5.0, 3.5), (8.0, 1.0, 1.57)])`.

        The robot stops at each, runs the tasks of a `Waypoint`, and has ARRIVED at the last one. With `through` it
        drives through them without stopping, but for waypoints with tasks and the last one: one path leads through all
        of them, and each is passed within `settings.through_tolerance`.

        Raises:
            InputError: If there is none, or one is not two or three finite numbers.
        """
        self._begin(Route(goals, through=through))

    def follow(self, path: Path) -> None:
        """Follow this path to its end from the next `update` on, instead of planning one.

        No other path is planned. In front of what was sensed on it the robot waits, and gives up after
        `settings.patience_s`; where it makes no progress otherwise, it gives up at once.

        Raises:
            InputError: If it is no path, or is too long to be checked.
        """
        check_kind(path, Path, "a path to follow", "a planner returns one, and Path([(x, y, yaw), …]) makes one")
        given = FollowedPath(path, path)
        self._begin(Route([Goal.of(path.goal)]))
        self._apply(self._replanner.take_given(given))

    def cancel(self) -> None:
        """Stop: interrupt what is running, and forget the goal. The robot stands, and the status is IDLE."""
        self._begin(None)

    # Behaviors ------------------------------------------------------------------------------------------------------

    def run(self, behavior: Behavior) -> None:
        """Run a behavior from the next `update` on: `navigator.run(BackUp(0.3))`. The status is BEHAVING meanwhile.

        Another one that runs is interrupted. Afterwards the robot plans again and drives on to its goal. Without a goal
        it is FINISHED; or STUCK, if the behavior failed, and `message` says why.

        Raises:
            InputError: If it is no behavior.
        """
        check_behavior_kind(behavior)
        self._apply(self._goal_queue.ask(behavior, self._state))

    def cancel_behavior(self) -> None:
        """Stop only the behavior that was asked for, if one runs: then the robot plans again, and drives on."""
        self._apply(self._goal_queue.drop(self._state))

    def clear_obstacles(
        self, region: Literal["all", "around", "except"] = "all", size: float = 0.0, *, at: Pose2D | None = None
    ) -> None:
        """Forget what the scans saw; the map stays.

        Args:
            region: All of it, a square around the robot ("around"), or all but that square ("except").
            size: Edge of the square [m], which is aligned with the odom frame.
            at: The middle of the square, map frame. If None, it is the robot.

        Raises:
            InputError: If the region is none of these, or its size is not positive.
        """
        if region not in ("all", "around", "except"):
            raise InputError(f"the region to clear is 'all', 'around' or 'except', got {region!r}")
        if region == "all":
            self._sensed.reset()
        else:
            self._sensed.clear_region(region, size, at)

    # Latency --------------------------------------------------------------------------------------------------------

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late commands arrive; a session calls it before a run.

        A command is then computed for the pose that the robot has when the command takes effect. Scans of some age
        need nothing: they have their own times.
        """
        check_kind(latency, Latency, "a latency", "Latency(command_delay_s=0.1) makes one")
        self._delayed.delay_s = latency.command_delay_s
        self.controller.set_latency(latency)

    def set_map(self, grid: OccupancyGrid, *, corrected: bool = False) -> None:
        """Drive on the map that a localizer has made so far; what the scans saw is kept beside it.

        A navigator that was made with a map, or was given a `static_costmap`, keeps that.

        Args:
            grid: The map, of any extent; its yaw is 0.
            corrected: Whether what was mapped before has moved since the last call: what the scans saw is forgotten,
                and seen again.

        Raises:
            InputError: If it is no map, or is turned.
            MapError: If it is too large.
        """
        check_kind(grid, OccupancyGrid, "a navigator's map", "a localizer's map() returns one")
        followed = self._replanner.followed
        self._sensed.grow(grid, None if followed is None else followed.path, corrected=corrected)

    def set_sent_command(self, command: Twist2D) -> None:
        """Take what was sent to the robot instead of the last command, where something changed it on the way.

        A session calls it with what its collision monitor made of the command.
        """
        check_kind(command, Twist2D, "a command", "Twist2D(v, w) makes one")
        self._is_held = command == _STAND != self._command
        self._command = command
        self._delayed.replace_last(command)

    # Planning -------------------------------------------------------------------------------------------------------

    def plan(self, start: Pose2D | Sequence[float]) -> Path:
        """Plan from `start` to the goal and follow that path from now on.

        Raises:
            InputError: If there is no goal.
            PlanningError: If there is no path.
        """
        here = Pose2D.of(start)
        made = self._replanner.plan(self._snapshot(self._time, here, _STAND), self._state)
        # The error goes to the caller: `error` is the one of a plan that a drive has made.
        self._apply(made._replace(error=None, clears_error=False))
        if made.path is None:
            raise made.error or PlanningError("there is no path")
        return made.path.path

    def plan_between(self, start: Pose2D, goal: Goal) -> Path | None:
        """Plan a path between two poses, and follow it not; None where planning took too long, or there is no map yet.

        Raises:
            PlanningError: If the map shows that there is no path.
        """
        try:
            return check_result(self.planner.plan(self.costmap, start, goal), Path, self.planner, "plan")
        except PlanningStoppedError:
            return None
        except PlanningError:
            if self.has_map:
                raise
            return None

    # What it says -----------------------------------------------------------------------------------------------------

    def info(self) -> AgentInfo:
        """Return what it is and drives with."""
        return AgentInfo(
            self.controller_name,
            self.planner_name,
            self.robot,
            self.grid,
            self.costmap,
            self.speed_mask,
            self.goal_checker,
            plugins=(self, self.controller, self.planner, self.smoother, self.goal_checker),
        )

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Return what it is doing, and why."""
        # It is asked in every control period: what stands in the properties above is read without them.
        state, replanner, controller = self._state, self._replanner, self._controller
        followed = replanner.followed
        return AgentReport(
            status=state.status,
            message=state.message,
            error=state.error,
            path=None if followed is None else followed.path,
            distance_remaining=None if followed is None else followed.left_m,
            costmap=self._sensed.costmap,
            tracks=self.tracks,
            rollouts=controller.rollouts() if rollouts else None,
            intent=controller.intent,
            goals_reached=self._goal_queue.goals_reached,
            behaviors=self._runner.runs,
            replans=state.replans,
            planning_time_s=state.planning_time_s,
            standing_reasons=state.standing_reasons,
            waits_to_plan=replanner.tries.pending,
            follows_given=replanner.is_given,
        )

    # How a drive changes --------------------------------------------------------------------------------------------

    def _apply(self, decision: Decision) -> Twist2D | None:
        """Apply the decision of a part; return its command, and None where the update goes on.

        This is the one place where a drive changes: parts read its state, and answer with decisions.
        """
        if decision is NOTHING:
            return None
        if decision.path is not None:
            self._replanner.followed = decision.path
            self.controller.set_path(decision.path.path)
            self._check.set_path(decision.path)
        if decision.restarts_progress:
            self.progress_checker.reset()
        state = self._state.after(decision)
        if state is not self._state:
            self._enter(state)
        return decision.command

    def _enter(self, state: DriveState) -> None:
        """Replace the state of the drive; `trundle.navigation.state` has the changes of status that happen."""
        self._state = state

    def _begin(self, route: Route | None) -> None:
        """Start over with these goals, or without one."""
        if route is None:
            self._enter(DriveState())
        else:
            self._enter(DriveState(NavigationStatus.DRIVING, ahead=route.ahead))
        self.progress_checker.reset()
        self._time = 0.0
        self._command = _STAND
        self._sensed.begin()
        self._tracked.begin()
        self._check.begin()
        self._replanner.begin(self.costmap)
        self._runner.interrupt("there is another goal" if route is not None else "cancelled")
        self._recovery.reset()
        self._relocalization.reset()
        self._goal_queue.begin(route)

    def _snapshot(self, time: float, pose: Pose2D, twist: Twist2D) -> Snapshot:
        sensed = self._sensed
        return Snapshot(
            time,
            pose,
            twist,
            sensed.costmap,
            self.dt,
            self.robot,
            sensed.is_active,
            sensed.reset,
            self._runner.replan,
            self.tracks,
        )
