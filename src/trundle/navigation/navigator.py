"""`Navigator`: planning, control and recovery behind one call per control period."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import replace
from types import NoneType
from typing import Literal, cast, overload

from trundle.control import Rollouts, create_controller
from trundle.control.controller import ControllerLike
from trundle.control.intent import Intent
from trundle.control.latency import DelayedCommands, Latency
from trundle.costmap import Costmap, CostmapSettings
from trundle.costmap.layers import LayersSettings
from trundle.errors import InputError, PlanningError, PlanningStoppedError
from trundle.fault import check_result
from trundle.files.choice import split_choice
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask, SpeedMask, check_overlap
from trundle.navigation.agent import Agent, AgentInfo, AgentReport
from trundle.navigation.behavior_runner import BehaviorRunner
from trundle.navigation.behaviors import Behavior, BehaviorRun, create_behavior
from trundle.navigation.behaviors.behavior import check_behavior_kind
from trundle.navigation.command_check import AssistedCommand, CommandCheck, assist_teleop
from trundle.navigation.drive import Drive, Now
from trundle.navigation.followed_path import FollowedPath
from trundle.navigation.goal_queue import Agenda
from trundle.navigation.inputs import (
    UPDATE_TAKES,
    credible_twist,
    load_costmap,
    read_goal,
    read_observed,
    read_pose,
)
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.path_driver import PathDriver
from trundle.navigation.progress import PathProgress, Retries
from trundle.navigation.recovery import Recovery
from trundle.navigation.replanner import Replanner
from trundle.navigation.sensing import SensedMap, SensedTracks
from trundle.navigation.speed_limiter import SpeedLimiter
from trundle.navigation.status import FINAL, NavigationStatus
from trundle.navigation.waypoint import Route
from trundle.observation import Estimate, Observation, Scan, Track, check_scans
from trundle.path import Path
from trundle.planning import Planner, create_planner, create_smoother
from trundle.planning.planner import PlannerLike
from trundle.planning.smoother import SmootherLike
from trundle.robots import Robot
from trundle.tracking import TrackerSettings
from trundle.values import as_number, check_kind

_STAND = Twist2D(0.0, 0.0)
_AUTO = "auto"
_QUICK_EXPANSIONS = 5_000
"""Of hybrid A* in a plan round what was sensed, a tenth of a second: there may be no path, which takes it seconds."""


class Navigator(Drive, Agent):
    """Plans a path, follows it, replans when it is blocked, and reports its status.

    It knows no simulator: call `update` with the robot's pose once per control period and send the twist to the robot.

    The map may change during a drive: `navigator.static_costmap = navigator.static_costmap.update(rows, cols, values)`.
    The next `update` then checks the rest of the path, and replans if that is blocked. A path that is not blocked is
    replaced only by one that is cheaper by `settings.replan_margin`, so that the robot does not oscillate between
    equal-cost paths.

    Scans put what is not on the map into the costmap: `update(pose, twist, time=…, scans=…)`. Where that blocks the
    path, the robot plans a path round it; where that is long, it waits first for what may move. It never drives faster
    than allows a stop within the space that was seen to be free.

    Args:
        grid: The map: a grid, a costmap made for this robot, both (grid, costmap), or the path of a ROS map YAML; None
            without a map. Then unknown space can be driven, at a cost, unless `costmap` says otherwise.
        robot: A robot, a catalogue name or the path of a YAML file.
        planner: A planner, its class, a function, a name, or a `Choice` of name and options; see `PlannerLike`.
        controller: A controller, likewise; see `ControllerLike`.
        smoother: A smoother of every planned path, likewise; none drives paths as they are planned.
        costmap: How the costmap is made of the map.
        keepout: Where the robot must not go: a mask, or the path of its YAML.
        speed_mask: How fast it may drive where: a mask, or the path of its YAML.
        layers: How scans are put into the costmap; None means the defaults, False that scans are left out.
        tracking: When something in the scans counts as moving; None means the defaults, False that nothing is
            tracked.
        settings: When the goal is reached, when the robot is stuck, and when it plans again.
        recovery: The steps of recovery, by name or as objects, instead of those of the settings.

    Attributes:
        settings: As given, or the defaults.
        goal_checker: Says whether the goal is reached; may be replaced.
        progress_checker: Says whether the robot makes progress; may be replaced.
        robot: The robot.
        grid: The map, or None where a costmap or no map was given.
        costmap: What it plans and drives on: the static costmap with what the scans saw. Read-only.
        static_costmap: The costmap of the map, without what the scans saw; None without a map. May be replaced, also
            during a drive: what was seen stays, unless the new one has cells of another size.
        speed_mask: The speed mask, or None.
        speed_limit: What the speed mask allows now [m/s], infinite where it limits nothing.
        target: The goal, or None; as a goal, it says whether any yaw will do.
        tracks: What its scans show to move, predicted to the time of the last `update`, map frame.
        status: What it is doing.
        error: The last planning error, or None.
        message: What blocks the robot, such as "blocked: obstacle ahead at (2.00, 3.50)"; empty where nothing does.
        planning_time_s: Time spent on planning since the goal was set [s].
        planning_expansions: Nodes that were expanded in planning since the goal was set; see `Planner.plan`.
        replans: Number of plans since the goal was set, after the first.
        standing_reasons: In how many control periods since then the controller made no progress, by its reason, such
            as "blocked by a mover".

    Raises:
        UnknownNameError: If a name is not known.
        MapError: If the map cannot be read.
        InputError: If an option is out of range, or a keep-out mask or `unknown` is given for a costmap.
    """

    def __init__(
        self,
        grid: OccupancyGrid | Costmap | tuple[OccupancyGrid, Costmap] | str | os.PathLike[str] | None,
        robot: Robot | str | os.PathLike[str],
        *,
        planner: PlannerLike = "auto",
        controller: ControllerLike = "regulated_pure_pursuit",
        smoother: SmootherLike | None = None,
        costmap: CostmapSettings | None = None,
        keepout: KeepoutMask | str | os.PathLike[str] | None = None,
        speed_mask: SpeedMask | str | os.PathLike[str] | None = None,
        layers: LayersSettings | Literal[False] | None = None,
        tracking: TrackerSettings | Literal[False] | None = None,
        settings: NavigatorSettings | None = None,
        recovery: Sequence[str | Behavior] | None = None,
    ) -> None:
        self.robot = Robot.load(robot)
        check_kind(costmap, (CostmapSettings, NoneType), "costmap", "CostmapSettings(inflation_radius=0.5) makes them")
        check_kind(
            settings, (NavigatorSettings, NoneType), "settings", "NavigatorSettings(goal_tolerance=0.1) makes them"
        )
        super().__init__(NavigatorSettings() if settings is None else settings)
        if layers is not False:
            check_kind(layers, (LayersSettings, NoneType), "layers", "LayersSettings(rolling_window=True) makes them")
        self.grid, static = load_costmap(grid, self.robot, costmap, keepout)
        self._sensed = SensedMap(static, self.robot, costmap=costmap, layers=layers)
        if tracking is not False:
            check_kind(tracking, (TrackerSettings, NoneType), "tracking", "TrackerSettings(max_range=10.0) makes them")
        self._tracked = SensedTracks(self.robot, tracking, warn=layers is False)
        self.speed_mask = (
            speed_mask if speed_mask is None or isinstance(speed_mask, SpeedMask) else SpeedMask.load(speed_mask)
        )
        limiter: SpeedLimiter | None = None
        if self.speed_mask is not None:
            if static is not None:
                check_overlap(self.speed_mask.grid, static, self.speed_mask.name)
            limiter = SpeedLimiter(self.speed_mask, self.robot)
        self.planner_name, planner, options = split_choice(planner)
        self.planner = create_planner(planner, self.robot, self.grid, **options)
        quick: Planner | None = None
        if self.planner_name == _AUTO and "max_expansions" not in options:
            quick = create_planner(_AUTO, **options, max_expansions=_QUICK_EXPANSIONS)
        self.controller_name, controller, options = split_choice(controller)
        self.controller = create_controller(controller, self.robot, self.grid, **options)
        if smoother is not None:
            self.smoother = create_smoother(smoother)
        self.dt = 1.0 / self.settings.control_frequency
        self._delayed = DelayedCommands(self.robot.limits)
        self._check = CommandCheck(self, self.robot, self._sensed, limiter, self.dt)
        self._replanner = Replanner(self, self.robot, self._sensed, quick, self._take)
        self._runner = BehaviorRunner(self, self.robot, self._sensed, self._replanner, self._check, self.dt)
        steps = [step.make() for step in self.settings.recovery] if recovery is None else recovery
        self._recovery = Recovery(
            self,
            self._sensed,
            self._replanner,
            self._runner,
            [create_behavior(step) for step in steps],
            Retries(self.dt, self.settings.recovery_retries),
            PathProgress(self.dt),
        )
        self._agenda = Agenda(self, self._runner, self._replanner, self._recovery)
        self._driver = PathDriver(self, self._replanner, self._runner, self._recovery, self._check, self.dt)
        self.reset()

    def __repr__(self) -> str:
        goal = "no goal" if self.target is None else repr(self.target)
        names = f"{self.robot.name}, {self.planner_name}, {self.controller_name}"
        return f"Navigator({names}, {goal}, {self.status.value})"

    # What it says of itself -----------------------------------------------------------------------------------------

    def info(self) -> AgentInfo:
        """Say what it is and drives with."""
        return AgentInfo(
            self.controller_name,
            self.planner_name,
            self.robot,
            self.grid,
            self.costmap,
            self.speed_mask,
            self.goal_checker,
            plans=True,
            needs_goal=True,
            plugins=(self, self.controller, self.planner, self.smoother, self.goal_checker),
        )

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Say what it is doing, and why."""
        return AgentReport(
            status=self.status,
            message=self.message,
            error=self.error,
            path=self.path,
            distance_remaining=self.distance_remaining,
            costmap=self.costmap,
            tracks=self.tracks,
            rollouts=self.rollouts if rollouts else None,
            intent=self.intent,
            goals_reached=self.goals_reached,
            behaviors=self.behavior_runs,
            replans=self.replans,
            planning_time_s=self.planning_time_s,
            standing_reasons=self.standing_reasons,
            waits_to_plan=self.waits_to_plan,
            follows_given=self.follows_given,
        )

    # Latency --------------------------------------------------------------------------------------------------------

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late commands arrive; a session calls it before a run.

        A command is then computed for the pose that the robot has when the command takes effect. Scans of some age
        need nothing: they have their own times.
        """
        check_kind(latency, Latency, "a latency", "Latency(command_delay_s=0.1) makes one")
        self._delayed.delay_s = latency.command_delay_s
        report_latency = getattr(self.controller, "set_latency", None)
        if callable(report_latency):
            report_latency(latency)

    @property
    def intent(self) -> Intent | None:
        """What the controller means to command next, for a collision monitor; none where it does not say."""
        return getattr(self.controller, "intent", None)

    def set_sent_command(self, command: Twist2D) -> None:
        """Take what was sent to the robot instead of the last command, where something changed it on the way.

        A session calls it with what its collision monitor made of the command.
        """
        check_kind(command, Twist2D, "a command", "Twist2D(v, w) makes one")
        self._is_held = command == _STAND != self._command
        self._command = command
        self._delayed.replace_last(command)

    # Goals ----------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal and everything about it, and what was sensed."""
        self._clock = 0.0
        self._is_held = False
        self._delayed.clear()
        self._runner.reset()
        self._sensed.reset()
        self._tracked.reset()
        self.tracks: tuple[Track, ...] = ()
        self._begin(None)
        self.controller.reset(seed=seed)
        self.status = NavigationStatus.IDLE

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
        route = Route(goals, through=through)
        self._begin(route.ahead[0])
        self._agenda.begin(route)
        self.status = NavigationStatus.DRIVING

    def follow(self, path: Path) -> None:
        """Follow this path to its end from the next `update` on, instead of planning one.

        No other path is planned. In front of what was sensed on it the robot waits, and gives up after
        `settings.patience_s`; where it makes no progress otherwise, it gives up at once.

        Raises:
            InputError: If it is no path, or is too long to be checked.
        """
        check_kind(path, Path, "a path to follow", "a planner returns one, and Path([(x, y, yaw), …]) makes one")
        route = Route([Goal.of(path.goal)])
        self._begin(route.ahead[0])
        self._agenda.begin(route)
        self._replanner.take_given(path)
        self.status = NavigationStatus.DRIVING

    @property
    def follows_given(self) -> bool:
        """Whether it follows a path that `follow` gave it."""
        return self._replanner.is_given

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals that were set, in order; empty without a goal."""
        return self._agenda.goals

    @property
    def goals_reached(self) -> int:
        """How many of them were reached or passed."""
        return self._agenda.goals_reached

    @property
    def goal(self) -> Pose2D | None:
        """The goal pose; its yaw is 0 where any yaw will do."""
        return None if self.target is None else self.target.pose

    @property
    def path(self) -> Path | None:
        """The path that it follows, or None."""
        return None if self._replanner.followed is None else self._replanner.followed.path

    @property
    def path_left(self) -> Path | None:
        """What is left of the path that it follows, or None."""
        return None if self._replanner.followed is None else self._replanner.followed.rest

    @property
    def distance_remaining(self) -> float | None:
        """Length of what is left of that path [m]; None without one."""
        return None if self._replanner.followed is None else self._replanner.followed.left_m

    @property
    def planned(self) -> Path | None:
        """The path before smoothing, as the planner returned it."""
        return None if self._replanner.followed is None else self._replanner.followed.planned

    @property
    def rollouts(self) -> Rollouts | None:
        """The best samples of the controller in the last control period, or none; see `MppiController.rollouts`."""
        best = getattr(self.controller, "rollouts", None)
        return cast("Rollouts | None", best()) if callable(best) else None

    @property
    def costmap(self) -> Costmap:
        """What it plans and drives on: the static costmap with what the scans saw."""
        return self._sensed.costmap

    @costmap.setter
    def costmap(self, costmap: object) -> None:
        raise InputError(
            "a navigator's costmap has what the scans saw and cannot be replaced; replace its static_costmap: "
            "navigator.static_costmap = navigator.static_costmap.update(rows, cols, values)"
        )

    @property
    def static_costmap(self) -> Costmap | None:
        """The costmap of the map, without what the scans saw; None without a map."""
        return self._sensed.static

    @static_costmap.setter
    def static_costmap(self, costmap: Costmap) -> None:
        check_kind(costmap, Costmap, "a static costmap", "CostmapSettings().make_costmap(grid, robot) makes one")
        self._sensed.replace_static(costmap)

    @property
    def has_map(self) -> bool:
        """Whether it drives on a map, and not only on what its scans see."""
        return self._sensed.static is not None

    @property
    def waits_to_plan(self) -> bool:
        """Whether the robot waits for a plan: the last one missed its deadline, or took many expansions."""
        return self._replanner.tries.pending

    def _begin(self, target: Goal | None) -> None:
        super()._begin(target)
        self._time = 0.0
        self._command = _STAND
        self._sensed.begin()
        self._tracked.begin()
        self._replanner.begin(self.costmap)
        self._runner.interrupt("there is another goal" if target is not None else "cancelled")
        self._recovery.reset()
        self._agenda.begin(None)

    # Behaviors ------------------------------------------------------------------------------------------------------

    def run(self, behavior: Behavior) -> None:
        """Run a behavior from the next `update` on: `navigator.run(BackUp(0.3))`. The status is BEHAVING meanwhile.

        Another one that runs is interrupted. Afterwards the robot plans again and drives on to its goal. Without a goal
        it is FINISHED; or STUCK, if the behavior failed, and `message` says why.

        Raises:
            InputError: If it is no behavior.
        """
        check_behavior_kind(behavior)
        self._agenda.ask(behavior)

    def cancel(self) -> None:
        """Stop: interrupt what is running, and forget the goal. The robot stands, and the status is IDLE."""
        self._begin(None)
        self.status = NavigationStatus.IDLE

    def cancel_behavior(self) -> None:
        """Stop only the behavior that was asked for, if one runs: then the robot plans again, and drives on."""
        self._agenda.drop()

    def clear_obstacles(self, region: Literal["all", "around", "except"] = "all", size: float = 0.0) -> None:
        """Forget what the scans saw; the map stays.

        Args:
            region: All of it, a square around the robot ("around"), or all but that square ("except").
            size: Edge of the square [m], which is aligned with the odom frame.

        Raises:
            InputError: If the region is none of these, or its size is not positive.
        """
        if region not in ("all", "around", "except"):
            raise InputError(f"the region to clear is 'all', 'around' or 'except', got {region!r}")
        if region == "all":
            self._sensed.reset()
        else:
            self._sensed.clear_region(region, size)

    @property
    def behavior_runs(self) -> tuple[BehaviorRun, ...]:
        """The behaviors that ran since the last `reset`, in order: steps of recovery and what it was asked for."""
        return self._runner.runs

    # Driving --------------------------------------------------------------------------------------------------------

    def plan(self, start: Pose2D | Sequence[float]) -> Path:
        """Plan from `start` to the goal and follow that path from now on.

        Raises:
            InputError: If there is no goal.
            PlanningError: If there is no path.
        """
        here = Pose2D.of(start)
        if self.target is not None:
            self._sensed.contain(here, *(goal.pose for goal in self.ahead))
        followed = self._replanner.plan(Now(self._time, here, _STAND, self.costmap))
        self._replanner.take(followed)
        return followed.path

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

    def _take(self, followed: FollowedPath) -> None:
        """Follow a path from now on."""
        self.controller.set_path(followed.path)
        self._check.set_path(followed)

    @overload
    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D: ...

    @overload
    def update(self, *, observation: Observation, estimate: Estimate) -> Twist2D: ...

    @overload
    def update(
        self,
        pose: Pose2D | Sequence[float],
        twist: Twist2D | None = None,
        *,
        time: float | None = None,
        scans: Sequence[Scan] = (),
    ) -> Twist2D: ...

    def update(
        self,
        pose: Pose2D | Sequence[float] | Observation | None = None,
        twist: Twist2D | Estimate | None = None,
        *,
        time: float | None = None,
        scans: Sequence[Scan] = (),
        observation: Observation | None = None,
        estimate: Estimate | None = None,
    ) -> Twist2D:
        """Return the command for the next control period.

        It takes where the robot is, `update(pose, twist, time=…, scans=…)`, or what a session and a localizer give,
        `update(observation, estimate)`, by position or by name.

        Args:
            pose: Where the robot is now, map frame: a pose or (x, y, yaw).
            twist: How it moves now, base_link; none means the last command. More than four times its limits is
                clipped to that, with a `RobotWarning`.
            time: Now [s], any origin; none means one control period after the last call. With scans, it is on their
                clock.
            scans: Scans of the robot's lidars that arrived since the last call, oldest first.
            observation: What the robot knows of its surroundings and its motion: it has twist, time and scans.
            estimate: Where a localizer believes the robot to be.

        Returns:
            The twist to send. It is (0, 0) when there is nothing to do; `status` says why.

        Raises:
            InputError: If the pose, the twist or the time is none, or not finite, the scans are none, or an observation
                comes without an estimate, or with what it has itself.

        Warns:
            SensorWarning: If scans are left out, what was sensed is forgotten since the pose or the time jumped.
        """
        observed = read_observed(pose, twist, observation, estimate)
        if observed is not None:
            if time is not None or scans:
                raise InputError(f"an observation has its own time and scans: leave these out; {UPDATE_TAKES}")
            observation, estimate = observed
            pose, twist, time, scans = estimate.pose, observation.twist, observation.time, observation.scans
        here = read_pose(cast("Pose2D | Sequence[float]", pose))
        now = self._clock + self.dt if time is None else as_number(time, "time")
        if not math.isfinite(now):
            raise InputError(f"time must be a finite number of seconds, got {time!r}")
        moving = self._last_command(now) if twist is None else credible_twist(twist, self.robot)
        self._look(here, now, check_scans(scans) if scans else (), estimate)
        self._clock = self._time = now
        self._command = self._decide(Now(now, here, moving, self.costmap))
        self._delayed.send(self._command, now)
        return self._command

    def assist_teleop(self, command: Twist2D, observation: Observation, estimate: Estimate) -> AssistedCommand:
        """Check a command by hand, instead of `update`: what of it may be sent in the next control period.

        It takes in what was observed, and slows the command down or stops it as it does with its own: before what is
        in the costmap, in space that was not seen, and by the speed mask. Goal and path stay; set the goal again when
        the robot is to drive on.

        Raises:
            InputError: If one of these is of another kind.
        """
        check_kind(command, Twist2D, "a command", "Twist2D(v, w) makes one")
        check_kind(observation, Observation, "an observation", "give assist_teleop(command, observation, estimate)")
        check_kind(estimate, Estimate, "an estimate", "give assist_teleop(command, observation, estimate)")
        time, scans = observation.time, observation.scans
        self._look(estimate.pose, time, check_scans(scans) if scans else (), estimate)
        self._clock = self._time = time
        moving = credible_twist(observation.twist, self.robot)
        soon = self._when_taking_effect(Now(time, estimate.pose, moving, self.costmap))
        wish = self.robot.limits.clamp(command)
        allowed = self._check.slow_down(wish, soon, self._replanner.followed)
        assisted = assist_teleop(
            wish, allowed, lambda slower: self._check.can_stop(slower, soon), "an obstacle of the costmap"
        )
        self._command = assisted.command
        self._delayed.send(self._command, time)
        return assisted

    def _last_command(self, now: float) -> Twist2D:
        """The command that the robot follows now."""
        arrived = self._delayed.in_effect(now)
        return self._command if arrived is None else arrived

    def _look(self, pose: Pose2D, now: float, scans: tuple[Scan, ...], estimate: Estimate | None) -> None:
        """Put scans into the costmap; drop the path where the robot turns out to be somewhere else."""
        if not self._replanner.obstacle.is_blocked and self.status not in FINAL:
            self.message = ""
        goal = None if self.target is None else self.target.pose
        estimate = Estimate(now, pose) if estimate is None else estimate
        self._sensed.update(scans, estimate, goal)
        self.tracks = self._tracked.update(scans, estimate)
        self._replanner.movers.note(self.tracks, now)
        if callable(set_tracks := getattr(self.controller, "set_tracks", None)):
            set_tracks(self.tracks)
        fastest = max(self.robot.limits.linear_speed, abs(self._command.v))
        jump_m = self._sensed.jump(pose, fastest * max(0.0, now - self._time))
        if jump_m is not None and self._replanner.followed is not None:
            self._replanner.drop_path()
            if self._runner.is_recovering:
                self._runner.interrupt("the pose jumped")
            self._recovery.reset()
            self.progress_checker.reset()
            then = "it left the path that it was given" if self._replanner.is_given else "planning a new path"
            self.message = f"the pose jumped by {jump_m:.1f} m: {then}"

    def _decide(self, now: Now) -> Twist2D:
        soon = self._when_taking_effect(now)
        self._runner.hold(self._is_held, now.time)
        command = self._agenda.run_tasks(soon)
        if command is not None:
            self._is_held = False
            return command
        if self.target is None or self.status in FINAL:
            return _STAND
        self._agenda.pass_goals(now.pose)
        if len(self.ahead) == 1 and self._is_reached(now) and self._is_reached(soon):
            return self._agenda.stop_at_goal(soon)
        held, self._is_held = self._is_held, False
        return self._driver.step(soon, held=held)

    def _when_taking_effect(self, now: Now) -> Now:
        """Where the robot is when the next command reaches its wheels."""
        if self._delayed.delay_s <= 0.0:
            return now
        pose, twist = self._delayed.predict(now.pose, now.twist, now.time)
        return replace(now, pose=pose, twist=twist)

    def _is_reached(self, now: Now) -> bool:
        goal = self.target
        return goal is not None and self.goal_checker.is_reached(now.pose, now.twist, goal.pose, any_yaw=goal.yaw_free)
