"""`Navigator`: planning, control and recovery behind one call per control period."""

from __future__ import annotations

import os
from collections.abc import Sequence
from types import NoneType
from typing import Literal, overload

from trundle.control import create_controller
from trundle.control.controller import ControllerLike
from trundle.control.latency import DelayedCommands
from trundle.costmap import Costmap, CostmapSettings
from trundle.costmap.layers import LayersSettings
from trundle.errors import NoValidControlError
from trundle.fault import check_result
from trundle.files.choice import split_choice
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask, SpeedMask, check_overlap
from trundle.navigation.agent import Agent
from trundle.navigation.behaviors import Behavior, create_behavior
from trundle.navigation.command_check import AssistedCommand, CommandCheck, SpeedLimiter, assist_teleop, slow_down
from trundle.navigation.goal_queue import GoalQueue
from trundle.navigation.inputs import CredibleTwist, Given, load_costmap, read_observed, read_update
from trundle.navigation.navigator_requests import NavigatorRequests
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.progress import PathProgress, Retries
from trundle.navigation.recovery import BehaviorRunner, Recovery
from trundle.navigation.relocalization import Relocalization
from trundle.navigation.replanner import Replanner
from trundle.navigation.retreat import Retreat
from trundle.navigation.route_planner import RoutePlanner
from trundle.navigation.sensing import SensedMap, SensedTracks, make_placer
from trundle.navigation.state import Decision, NavigationStatus, Snapshot
from trundle.observation import Estimate, Observation, Scan
from trundle.planning import create_planner, create_smoother
from trundle.planning.planner import PlannerLike
from trundle.planning.smoother import SmootherLike
from trundle.robots import Robot
from trundle.tracking import TrackerSettings
from trundle.values import check_kind

_STAND = Twist2D(0.0, 0.0)
_STUCK = Decision(_STAND, status=NavigationStatus.STUCK)


class Navigator(NavigatorRequests):
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
        smoother: A smoother of every planned path, likewise. If None, paths are driven as they are planned.
        costmap: How the costmap is made of the map.
        keepout: Where the robot must not go: a mask, or the path of its YAML.
        speed_mask: How fast it may drive where: a mask, or the path of its YAML.
        layers: How scans are put into the costmap. If None, by the defaults; if False, scans are left out.
        tracking: When something in the scans counts as moving. If None, the defaults say so; if False, nothing is
            tracked.
        settings: When the goal is reached, when the robot is stuck, and when it plans again.
        recovery: The steps of recovery, by name or as objects, instead of those of the settings.

    Attributes:
        settings: As given, or the defaults.
        dt: Length of the control period [s].
        robot: The robot.
        grid: The map, or None where a costmap or no map was given.
        speed_mask: The speed mask, or None.
        planner_name: Name of the planner, for reports.
        controller_name: Name of the controller, for reports.
        progress_checker: Says whether the robot makes progress; may be replaced.
        tracks: What its scans show to move, predicted to the time of the last `update`, map frame.

    Raises:
        UnknownNameError: If a name is not known.
        MapError: If the map cannot be read.
        InputError: If an option is out of range, or a keep-out mask or `unknown` is given for a costmap.
    """

    plans = True
    needs_goal = True

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
        if layers is not False:
            check_kind(layers, (LayersSettings, NoneType), "layers", "LayersSettings(rolling_window=True) makes them")
        if tracking is not False:
            check_kind(tracking, (TrackerSettings, NoneType), "tracking", "TrackerSettings(max_range=10.0) makes them")
        self.settings = settings = NavigatorSettings() if settings is None else settings
        self.dt = 1.0 / settings.control_frequency
        self.progress_checker = settings.make_progress_checker()
        self.grid, static = load_costmap(grid, self.robot, costmap, keepout)
        self._sensed = SensedMap(static, self.robot, costmap=costmap, layers=layers)
        self._tracked = SensedTracks(self.robot, tracking, warn=layers is False)
        self._placer = make_placer(self.robot, layers, tracking)
        limiter: SpeedLimiter | None = None
        self.speed_mask = (
            speed_mask if speed_mask is None or isinstance(speed_mask, SpeedMask) else SpeedMask.load(speed_mask)
        )
        if self.speed_mask is not None:
            if static is not None:
                check_overlap(self.speed_mask.grid, static, self.speed_mask.name)
            limiter = SpeedLimiter(self.speed_mask, self.robot)
        self.planner_name, planner, options = split_choice(planner)
        made_planner = create_planner(planner, self.robot, self.grid, **options)
        self.controller_name, controller, options = split_choice(controller)
        self._controller = create_controller(controller, self.robot, self.grid, **options)
        made_smoother = None if smoother is None else create_smoother(smoother)
        steps = [step.make() for step in settings.recovery] if recovery is None else recovery
        self._credible = CredibleTwist(self.robot)
        self._delayed = DelayedCommands(self.robot.limits)
        self._check = CommandCheck(self.robot, self._sensed, limiter, self.dt)
        through = settings.through_tolerance
        self._routes = RoutePlanner(self._sensed, made_smoother, settings.make_goal_checker(), through)
        self._replanner = Replanner(settings, self.robot, self._sensed, self._routes, made_planner)
        self._runner = BehaviorRunner(self._sensed, self._replanner, self._check)
        self._recovery = Recovery(
            self._sensed,
            self._replanner,
            self._runner,
            [create_behavior(step) for step in steps],
            Retries(self.dt, settings.recovery_retries),
            PathProgress(self.dt),
            Retreat(self._sensed, self._replanner, self._routes),
        )
        self._relocalization = Relocalization(self.robot)
        self._goal_queue = GoalQueue(self._runner, self._replanner, self._recovery, through)
        self.reset()

    # Driving --------------------------------------------------------------------------------------------------------

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
            twist: How it moves now, base_link. If None, as the last command says. More than four times its limits is
                clipped to that, with a `RobotWarning` the first time.
            time: Now [s], any origin, on the clock of the scans. If None, one control period after the last call.
            scans: Scans of the robot's lidars that arrived since the last call, oldest first.
            observation: What the robot knows of its surroundings and its motion: it has twist, time and scans.
            estimate: Where a localizer believes the robot to be.

        Returns:
            The twist to send. It is (0, 0) when there is nothing to do; `status` says why.

        Raises:
            InputError: If the pose, the twist or the time is none, or not finite, the scans are none, or an observation
                comes without an estimate, or with what it has itself.

        Warns:
            SensorWarning: If scans are left out, or what was sensed is forgotten since the pose or the time jumped.
        """
        given = read_update(pose, twist, time, scans, observation, estimate)
        now = self._sense(given)
        soon = self._when_taking_effect(now)
        # The first stage that has a command for this control period ends it.
        command = self._run_tasks(soon)
        if command is None and given.estimate is not None:
            command = self._find_itself(given.estimate, given.scans, now)
        if command is None:
            command = self._arrive(now, soon)
        if command is None:
            command = self._apply(self._recovery.make_room(soon, self._state))
        if command is None and not self._recovery.makes_room:
            soon = soon._replace(costmap=self._sensed.costmap)  # one that has made room has forgotten who stood there
            command = self._plan_or_replan(soon)
        if command is None and self._runner.is_recovering:
            command = self._apply(self._recovery.continue_step(soon, self._state))
        if command is None:
            wish, reason = self._control(soon)
            checked = self._check.cut(wish, soon)
            command = self._apply(self._recovery.watch(checked, soon, self._state, reason))
        return self._send(_STAND if command is None else command, now)

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
        now = self._sense(read_observed(observation, estimate))
        soon = self._when_taking_effect(now)
        wish = self.robot.limits.clamp(command)
        allowed = self._check.slow_down(wish, soon, self._replanner.followed)
        assisted = assist_teleop(
            wish, allowed, lambda slower: self._check.can_stop(slower, soon), "an obstacle of the costmap"
        )
        self._send(assisted.command, now)
        return assisted

    # The stages of an update, in order ------------------------------------------------------------------------------

    def _sense(self, given: Given) -> Snapshot:
        """Put scans into the costmap; drop the path where the robot turns out to be somewhere else."""
        pose, scans = given.pose, given.scans
        now = self._clock + self.dt if given.time is None else given.time
        twist = self._last_command(now) if given.twist is None else self._credible.cut(given.twist)
        if self._state.message and not self._replanner.obstacle.is_blocked and not self._state.is_final:
            self._apply(Decision(message=""))
        if scans or self._has_scans:  # a robot without scans pays nothing for them
            self._has_scans = True
            estimate = Estimate(now, pose) if given.estimate is None else given.estimate
            placed = self._placer.place(scans, estimate)
            if not self._relocalization.is_needed(estimate):  # where it would be marked is not known otherwise
                self._sensed.update(placed, self._state.target, self._replanner.movers.recent)
            self.tracks = self._tracked.update(placed)
        self._replanner.movers.note(self.tracks, now)
        self._controller.set_tracks(self.tracks)
        fastest = max(self.robot.limits.linear_speed, abs(self._command.v))
        jump_m = self._sensed.jump(pose, fastest * max(0.0, now - self._time), given.estimate)
        if jump_m is not None and self._replanner.followed is not None:
            self._replanner.drop_path()
            if self._runner.is_recovering:
                self._runner.interrupt("the pose jumped")
            self._recovery.reset()
            then = "it left the path that it was given" if self._replanner.is_given else "planning a new path"
            self._apply(Decision(message=f"the pose jumped by {jump_m:.1f} m: {then}", restarts_progress=True))
        self._clock = self._time = now
        return self._snapshot(now, pose, twist)

    def _run_tasks(self, soon: Snapshot) -> Twist2D | None:
        """Run what was asked for, or the tasks of the goal that was reached."""
        self._runner.hold(self._is_held, soon.time)
        if not self._goal_queue.has_tasks:
            return None
        command = self._apply(self._goal_queue.run_tasks(soon, self._state))
        if command is not None:
            self._is_held = False
        return command

    def _find_itself(self, estimate: Estimate, scans: Sequence[Scan], now: Snapshot) -> Twist2D | None:
        """Look around while the localizer does not know where the robot is; then go on, from where that turns out."""
        search = self._relocalization
        if search.is_needed(estimate):
            if not self._state.ahead or self._state.is_final:
                return None
            if self._runner.is_recovering:
                self._runner.interrupt("the robot does not know where it is")
            return self._apply(search.decide(estimate, scans, now.time))
        if search.is_active:
            if search.end(estimate):
                self._sensed.reset()
                self._replanner.drop_path()
            self._recovery.reset()
        return None

    def _arrive(self, now: Snapshot, soon: Snapshot) -> Twist2D | None:
        """Stand where there is nothing to do; count goals that are passed, and stop at the one that is reached."""
        if not self._state.ahead or self._state.is_final:
            return _STAND
        if len(self._state.ahead) > 1:
            self._apply(self._goal_queue.pass_goals(now.pose, self._state))
        # The robot has to be there now, and still be there when the command takes effect that stops it.
        if len(self._state.ahead) == 1 and self._is_reached(now) and self._is_reached(soon):
            return self._apply(self._goal_queue.stop_at_goal(soon, self._state))
        return None

    def _plan_or_replan(self, soon: Snapshot) -> Twist2D | None:
        """Plan where there is no path, replan where it is blocked; stand while a plan has to wait, or give up."""
        replanner, recovering = self._replanner, self._runner.is_recovering
        held, self._is_held = self._is_held, False
        replanner.follow(soon)
        if replanner.lost_given:
            return self._apply(_STUCK)
        if replanner.must_plan:
            command = self._apply(replanner.plan_first(soon, self._state))
            if command is not None:
                return command
        if held and not replanner.obstacle.gives_up:  # what stops the robot may move away
            self.progress_checker.reset()
        if not recovering and not self.progress_checker.is_moving_on(soon.pose, soon.time):
            return self._apply(_STUCK)
        followed = replanner.followed
        if followed is not None:
            followed.advance(soon.pose)
            if not recovering:
                self._apply(replanner.reconsider(followed, soon, self._state))
        return _STAND if replanner.tries.pending else None

    def _control(self, soon: Snapshot) -> tuple[Twist2D, str]:
        """Ask the controller for a command; return it, and why it makes no progress where it says so."""
        controller, replanner = self._controller, self._replanner
        followed = replanner.followed
        limit = self._check.limit_speed(soon, followed)
        if limit is not None:
            controller.set_speed_limit(limit)
        controller.set_through([] if followed is None else followed.marks, self.settings.through_tolerance)
        blocked = ""
        try:
            command = controller.compute_velocity(soon.pose, soon.twist, soon.costmap, self.dt)
            if type(command) is not Twist2D:  # a plug-in may return anything
                check_result(command, Twist2D, controller, "compute_velocity")
        except NoValidControlError:
            command, blocked = _STAND, "no valid control"
        if command != _STAND and (command := slow_down(command, replanner.fastest)) == _STAND:
            blocked = "blocked by a mover"
        if blocked and replanner.obstacle.is_blocked and replanner.standing_reason(self._state) == "goal occupied":
            blocked = "goal occupied"
        reason = controller.reason or blocked
        if reason:
            self._apply(Decision(reasons=(reason,)))
        return command, reason

    def _send(self, command: Twist2D, now: Snapshot) -> Twist2D:
        """Remember the command that takes effect after the delay."""
        self._command = command
        if self._delayed.delay_s > 0.0:
            self._delayed.send(command, now.time)
        return command

    def _last_command(self, now: float) -> Twist2D:
        """Return the command that the robot follows now."""
        arrived = self._delayed.in_effect(now)
        return self._command if arrived is None else arrived

    def _when_taking_effect(self, now: Snapshot) -> Snapshot:
        """Return where the robot is when the next command reaches its wheels."""
        if self._delayed.delay_s <= 0.0:
            return now
        pose, twist = self._delayed.predict(now.pose, now.twist, now.time)
        return now._replace(pose=pose, twist=twist)

    def _is_reached(self, now: Snapshot) -> bool:
        goal = self._state.ahead[0]
        return self._routes.goal_checker.is_reached(now.pose, now.twist, goal.pose, any_yaw=goal.yaw_free)


def choose_navigator(*, robot: Robot, map: OccupancyGrid | None = None, navigator: Agent | None = None) -> Agent:
    """Return the navigator that drives where no agent is chosen: the agent `navigator`, for comparisons with others."""
    return Navigator(map, robot) if navigator is None else navigator
