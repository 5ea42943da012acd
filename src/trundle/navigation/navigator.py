"""`Navigator`: planning, control and recovery behind one call per control period."""

from __future__ import annotations

import math
import os
import time as clock
from collections.abc import Sequence
from types import NoneType
from typing import Literal, cast, overload

from trundle.control import Controller, create_controller
from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop
from trundle.costmap import Costmap, CostmapSettings
from trundle.costmap.layers import LayersSettings
from trundle.errors import BlockedPoseError, InputError, NoValidControlError, PlanningError, PlanningStoppedError
from trundle.files.choice import Choice
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask, SpeedMask, check_overlap
from trundle.navigation.followed_path import FollowedPath
from trundle.navigation.free_pose import free_ends
from trundle.navigation.inputs import credible_twist, load_costmap, read_goal, read_pose, split_choice
from trundle.navigation.obstacle_watch import ObstacleWatch
from trundle.navigation.planning_tries import PlanningTries, moves, timed_out
from trundle.navigation.recovery import Recovery
from trundle.navigation.sensed_map import SensedMap
from trundle.navigation.settings import NavigatorSettings
from trundle.navigation.speed_limiter import SpeedLimiter, slow_down
from trundle.navigation.status import FINAL, NavigationStatus
from trundle.navigation.unseen_space import slow_down_in_unseen
from trundle.navigation.window_goal import goal_in_window
from trundle.observation import Estimate, Observation, Scan, check_scans
from trundle.path import Path
from trundle.planning import PathHit, Planner, Smoother, create_planner, create_smoother
from trundle.robots import Robot
from trundle.values import as_number, check_kind

_STAND = Twist2D(0.0, 0.0)
_AUTO = "auto"
_EXTEND_BEFORE_M, _EXTEND_EVERY_S = 2.5, 1.0
"""A path that ends short of the goal, as that lies outside of a moving window, is planned again before its end [m]."""
_QUICK_EXPANSIONS = 5_000
"""Of hybrid A* in a plan round what was sensed, a tenth of a second: there may be no path, which takes it seconds."""


class Navigator:
    """Plans a path, follows it, replans when it is blocked, and reports its status.

    It knows no simulator: call `update` with the robot's pose once per control period and send the twist to the robot.

    The map may change during a drive: `navigator.costmap = navigator.costmap.update(rows, cols, values)`. The next
    `update` then checks the rest of the path, and replans if that is blocked. A path that is not blocked is replaced
    only by one that is cheaper by `settings.replan_margin`, so that the robot does not oscillate between equal-cost
    paths.

    Scans put what is not on the map into the costmap: `update(pose, twist, time=…, scans=…)`. Where that blocks the
    path, the robot plans a path round it; where that is long, it waits first for what may move. It never drives faster
    than allows a stop within the space that was seen to be free.

    Args:
        grid: The map: a grid, a costmap made for this robot, or the path of a ROS map YAML; None without a map. Then
            unknown space can be driven, at a cost, unless `costmap` says otherwise.
        robot: A robot, a catalogue name or the path of a YAML file.
        planner: A planner, the name of one, or a `Choice` of name and options.
        controller: A controller, likewise.
        smoother: A smoother of every planned path, likewise; none drives paths as they are planned.
        costmap: How the costmap is made of the map.
        keepout: Where the robot must not go: a mask, or the path of its YAML.
        speed_mask: How fast it may drive where: a mask, or the path of its YAML.
        layers: How scans are put into the costmap; None means the defaults, False that scans are left out.
        settings: When the goal is reached, when the robot is stuck, and when it plans again.

    Attributes:
        settings: As given, or the defaults.
        goal_checker: Says whether the goal is reached; may be replaced.
        progress_checker: Says whether the robot makes progress; may be replaced.
        robot: The robot.
        grid: The map, or None where a costmap or no map was given.
        costmap: What it plans and drives on, with what the scans saw; may be replaced during a drive, by a costmap of
            the map without that.
        speed_mask: The speed mask, or None.
        speed_limit: What the speed mask allows now [m/s], infinite where it limits nothing.
        status: What it is doing.
        error: The last planning error, or None.
        message: What blocks the robot, such as "blocked: obstacle ahead at (2.00, 3.50)"; empty where nothing does.
        planning_time_s: Time spent on planning since the goal was set [s].
        replans: Number of plans since the goal was set, after the first.

    Raises:
        UnknownNameError: If a name is not known.
        MapError: If the map cannot be read.
        InputError: If an option is out of range, or a keep-out mask or `unknown` is given for a costmap.
    """

    def __init__(
        self,
        grid: OccupancyGrid | Costmap | str | os.PathLike[str] | None,
        robot: Robot | str | os.PathLike[str],
        *,
        planner: str | Choice | Planner = "auto",
        controller: str | Choice | Controller = "regulated_pure_pursuit",
        smoother: str | Choice | Smoother | None = None,
        costmap: CostmapSettings | None = None,
        keepout: KeepoutMask | str | os.PathLike[str] | None = None,
        speed_mask: SpeedMask | str | os.PathLike[str] | None = None,
        layers: LayersSettings | Literal[False] | None = None,
        settings: NavigatorSettings | None = None,
    ) -> None:
        self.robot = Robot.load(robot)
        check_kind(costmap, (CostmapSettings, NoneType), "costmap", "CostmapSettings(inflation_radius=0.5) makes them")
        check_kind(
            settings, (NavigatorSettings, NoneType), "settings", "NavigatorSettings(goal_tolerance=0.1) makes them"
        )
        self.settings = NavigatorSettings() if settings is None else settings
        if layers is not False:
            check_kind(layers, (LayersSettings, NoneType), "layers", "LayersSettings(rolling_window=True) makes them")
        self.grid, static = load_costmap(grid, self.robot, costmap, keepout)
        self._sensed = SensedMap(static, self.robot, costmap=costmap, layers=layers)
        self.costmap = self._sensed.costmap
        self.speed_mask = (
            speed_mask if speed_mask is None or isinstance(speed_mask, SpeedMask) else SpeedMask.load(speed_mask)
        )
        self._limiter: SpeedLimiter | None = None
        if self.speed_mask is not None:
            if static is not None:
                check_overlap(self.speed_mask.grid, static, self.speed_mask.name)
            self._limiter = SpeedLimiter(self.speed_mask, self.robot)
        self.planner_name, planner, options = split_choice(planner)
        self.planner = create_planner(planner, **options)
        self._quick: Planner | None = None
        if self.planner_name == _AUTO and "max_expansions" not in options:
            self._quick = create_planner(_AUTO, **options, max_expansions=_QUICK_EXPANSIONS)
        self.controller_name, controller, options = split_choice(controller)
        self.controller = create_controller(controller, self.robot, **options)
        self.smoother: Smoother | None = None
        if smoother is not None:
            _, smoother, options = split_choice(smoother)
            self.smoother = create_smoother(smoother, **options)
        self.goal_checker = self.settings.make_goal_checker()
        self.progress_checker = self.settings.make_progress_checker()
        self.dt = 1.0 / self.settings.control_frequency
        self._recovery = Recovery(self.dt)
        self._padded = self.robot.planar.padded(FOOTPRINT_PADDING_M).outline
        self._tries = PlanningTries(self.settings.planning_deadline_s)
        self._obstacle = ObstacleWatch(self.settings.wait_s, self.settings.patience_s)
        self.reset()

    def __repr__(self) -> str:
        goal = "no goal" if self._goal is None else repr(self._goal)
        names = f"{self.robot.name}, {self.planner_name}, {self.controller_name}"
        return f"Navigator({names}, {goal}, {self.status.value})"

    # Goals ----------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal and everything about it, and what was sensed."""
        self._goal: Goal | None = None
        self._clock = 0.0
        self._sensed.reset(self.costmap)
        self.costmap = self._sensed.costmap
        self._forget_progress()
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
        self._goal = read_goal(goal, y, yaw)
        self._forget_progress()
        self.status = NavigationStatus.DRIVING

    @property
    def goal(self) -> Pose2D | None:
        """The goal pose; its yaw is 0 where any yaw will do."""
        return None if self._goal is None else self._goal.pose

    @property
    def path(self) -> Path | None:
        """The path that it follows, or None."""
        return None if self._followed is None else self._followed.path

    @property
    def planned(self) -> Path | None:
        """The path before smoothing, as the planner returned it."""
        return None if self._followed is None else self._followed.planned

    @property
    def waits_to_plan(self) -> bool:
        """Whether the robot waits for a plan: the last one missed its deadline."""
        return self._tries.pending

    def _forget_progress(self) -> None:
        self._followed: FollowedPath | None = None
        self._ends_short = False
        self._checked = self.costmap
        self._planned_at = 0.0
        self.speed_limit = math.inf
        self.error: PlanningError | None = None
        self.planning_time_s = 0.0
        self.replans = 0
        self.progress_checker.reset()
        self.message = ""
        self._time = 0.0
        self._command = _STAND
        self._obstacle.reset()
        self._sensed.begin()
        self._recovery.reset()
        self._tries.reset()

    # Driving --------------------------------------------------------------------------------------------------------

    def plan(self, start: Pose2D | Sequence[float]) -> Path:
        """Plan from `start` to the goal and follow that path from now on.

        Raises:
            InputError: If there is no goal.
            PlanningError: If there is no path.
        """
        here = Pose2D.of(start)
        if self._goal is not None:
            self.costmap = self._sensed.contain(here, self._goal.pose)
        followed = self._call_planner(here, _STAND)
        self._take(followed)
        return followed.path

    def _call_planner(self, start: Pose2D, twist: Twist2D) -> FollowedPath:
        if self._goal is None:
            raise InputError("there is no goal to plan to; call set_goal first")
        self._planned_at, self._checked = self._time, self.costmap
        deadline_s = self._tries.deadline_s(twist)
        began = clock.perf_counter()
        try:
            target, goal = self._goal, self._goal.pose
            if self._sensed.is_active:
                target = goal_in_window(self.costmap, start, target)
                tolerance = self.goal_checker.xy_tolerance
                start, goal = free_ends(self.costmap, self._sensed.static, start, target, tolerance)
            self._ends_short = target is not self._goal
            path = self._choose_planner(twist).plan(
                self.costmap, start, goal, goal_yaw_free=target.yaw_free, deadline_s=deadline_s
            )
            smooth = path if self.smoother is None else self.smoother.smooth(path, self.costmap)
        except PlanningStoppedError as error:
            if timed_out(error):
                self._tries.time_out(twist, self._time)
            raise
        finally:
            seconds = clock.perf_counter() - began
            self.planning_time_s += seconds
        self._tries.succeed(seconds)
        return FollowedPath(path, smooth)

    def _choose_planner(self, twist: Twist2D) -> Planner:
        """The planner; while something that was sensed blocks the path and the robot moves, one that searches less."""
        if self._quick is None or not self._obstacle.is_blocked:
            return self.planner
        stands = not moves(twist)
        return self.planner if self._obstacle.is_thorough(self._time, stands=stands) else self._quick

    def _take(self, followed: FollowedPath) -> None:
        """Follow a path from now on."""
        self._followed = followed
        self.controller.set_path(followed.path)
        if self._limiter is not None:
            self._limiter.set_path(followed.check)

    @overload
    def update(self, pose: Observation, twist: Estimate, /) -> Twist2D: ...

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
        pose: Pose2D | Sequence[float] | Observation,
        twist: Twist2D | Estimate | None = None,
        *,
        time: float | None = None,
        scans: Sequence[Scan] = (),
    ) -> Twist2D:
        """Return the command for the next control period: `update(pose, twist)`, or `update(observation, estimate)`.

        Args:
            pose: Where the robot is now, map frame: a pose or (x, y, yaw).
            twist: How it moves now, base_link; none means the last command. More than four times its limits is
                clipped to that, with a `RobotWarning`.
            time: Now [s], any origin; none means one control period after the last call. With scans, it is on their
                clock.
            scans: Scans of the robot's lidars that arrived since the last call, oldest first.

        Returns:
            The twist to send. It is (0, 0) when there is nothing to do; `status` says why.

        Raises:
            InputError: If the pose, the twist or the time is none, or not finite, the scans are none, or an observation
                comes without an estimate.

        Warns:
            SensorWarning: If scans are left out, what was sensed is forgotten since the pose or the time jumped.
        """
        if isinstance(pose, Observation) or isinstance(twist, Estimate):
            check_kind(pose, Observation, "an update's observation", "give update(observation, estimate)")
            check_kind(twist, Estimate, "an update's estimate", "give update(observation, estimate)")
            observation, estimate = cast("Observation", pose), cast("Estimate", twist)
            pose, twist, time, scans = estimate.pose, observation.twist, observation.time, observation.scans
        else:
            estimate = None
        here = read_pose(pose)
        moving = self._command if twist is None else credible_twist(twist, self.robot)
        now = self._clock + self.dt if time is None else as_number(time, "time")
        if not math.isfinite(now):
            raise InputError(f"time must be a finite number of seconds, got {time!r}")
        self._look(here, now, check_scans(scans) if scans else (), estimate)
        self._clock = self._time = now
        self._command = self._decide(here, moving)
        return self._command

    def _look(self, pose: Pose2D, now: float, scans: tuple[Scan, ...], estimate: Estimate | None) -> None:
        """Put scans into the costmap; drop the path where the robot turns out to be somewhere else."""
        if not self._obstacle.is_blocked and self.status not in FINAL:
            self.message = ""
        goal = None if self._goal is None else self._goal.pose
        estimate = Estimate(now, pose) if estimate is None else estimate
        self.costmap = self._sensed.update(self.costmap, scans, estimate, goal)
        fastest = max(self.robot.limits.linear_speed, abs(self._command.v))
        jump_m = self._sensed.jump(pose, fastest * max(0.0, now - self._time))
        if jump_m is not None and self._followed is not None:
            self._followed = None
            self._recovery.reset()
            self._obstacle.clear()
            self.progress_checker.reset()
            self.message = f"the pose jumped by {jump_m:.1f} m: planning a new path"

    def _decide(self, pose: Pose2D, twist: Twist2D) -> Twist2D:
        if self._goal is None or self.status in FINAL:
            return _STAND
        if self.goal_checker.is_reached(pose, twist, self._goal.pose, any_yaw=self._goal.yaw_free):
            self.status = NavigationStatus.ARRIVED
            return _STAND
        self._obstacle.follow(pose, self._time)
        if (self._followed is None or self._tries.pending) and not self._plan_first(pose, twist):
            return _STAND
        if not self.progress_checker.is_moving_on(pose, self._time):
            self.status = NavigationStatus.STUCK
            return _STAND
        followed = cast("FollowedPath", self._followed)
        followed.advance(pose)
        self._reconsider(followed, pose, twist)
        if self._tries.pending:
            return _STAND
        self._limit_speed(pose, twist)
        if self._recovery.is_backing_up:
            return self._slow_in_unseen(slow_down(self._back_up(pose, twist), self.speed_limit), pose, twist)
        try:
            command = self.controller.compute_velocity(pose, twist, self.costmap, self.dt)
        except NoValidControlError:
            command = _STAND
        command = self._slow_in_unseen(slow_down(command, self.speed_limit), pose, twist)
        return self._watch_for_block(command, pose, twist)

    # Speed limits ---------------------------------------------------------------------------------------------------

    def _limit_speed(self, pose: Pose2D, twist: Twist2D) -> None:
        """Hand the speed that the mask allows to the controller."""
        if self._limiter is None:
            return
        index = 0 if self._followed is None else self._followed.index
        backwards = self._recovery.is_backing_up
        self.speed_limit = self._limiter.limit(pose, twist, index, self.dt, backwards=backwards)
        self.controller.set_speed_limit(self.speed_limit)

    def _slow_in_unseen(self, command: Twist2D, pose: Pose2D, twist: Twist2D) -> Twist2D:
        if not self._sensed.is_active:
            return command
        return slow_down_in_unseen(self.costmap, self.robot.limits, pose, twist, command, self.dt, padded=self._padded)

    # Planning again -------------------------------------------------------------------------------------------------

    def _reconsider(self, followed: FollowedPath, pose: Pose2D, twist: Twist2D) -> None:
        """Plan again where a changed map blocks the path, or it is time to look for a better one."""
        if self._recovery.is_backing_up:
            return
        changed = self.costmap is not self._checked
        if self._ends_short and followed.left_m < _EXTEND_BEFORE_M and self._time - self._planned_at >= _EXTEND_EVERY_S:
            self._replan(pose, twist)
            return
        interval_s = self.settings.replan_interval_s
        due = interval_s is not None and self._time - self._planned_at >= interval_s - 1e-9
        if not (changed or due or self._obstacle.is_blocked):
            return
        self._checked = self.costmap
        hit = followed.first_hit(self.costmap)
        if hit is None:
            self.error = None
            self._obstacle.clear()
        if hit is not None and self._sensed.is_active:
            self._go_round(hit, followed, pose, twist)
        elif hit is not None:
            self._replan(pose, twist)
        elif due and not self._tries.stops_first(twist):
            self._look_for_better(pose, twist)

    def _go_round(self, hit: PathHit, followed: FollowedPath, pose: Pose2D, twist: Twist2D) -> None:
        """Plan a path round what was sensed on this one, and take it unless waiting is better."""
        self._obstacle.see(self._time)
        x, y = self._sensed.obstacle_near(hit.pose[0], hit.pose[1], self.robot.circumscribed_radius + 0.2)
        self.message = f"blocked: obstacle ahead at ({x:.2f}, {y:.2f})"
        if not self._obstacle.may_plan(self._time) or self._tries.must_wait(twist, self._time):
            return
        self.replans += 1
        try:
            found = self._call_planner(pose, twist)
        except PlanningError as error:
            self.error = error
            if isinstance(error, BlockedPoseError):
                self.message = f"blocked: {error}"
            self._obstacle.fail()
            self._tries.settle()
            return
        self.error = None
        if self._obstacle.takes(float(found.check.along[-1]), followed.left_m, self._time):
            self._take(found)
            self._obstacle.clear()

    def _plan_first(self, pose: Pose2D, twist: Twist2D) -> bool:
        """Make the plan that the robot waits for; return whether it may drive on."""
        if self._obstacle.is_blocked and not self._obstacle.may_plan(self._time):
            return False
        if not self._attempt(pose, twist):
            self._obstacle.fail()
            return True if self._followed is not None else self._wait_for_path()
        if not self._tries.pending:
            self._obstacle.clear()
        return not self._tries.pending

    def _wait_for_path(self) -> bool:
        """Stand where there is no path, for a while if what was sensed may move away; return False."""
        self.status = NavigationStatus.NO_PATH
        if self._sensed.is_active:
            self._obstacle.see(self._time)
            if not self._obstacle.gives_up:
                self.status, self.message = NavigationStatus.BLOCKED, f"blocked: {self.error}"
        return False

    def _replan(self, pose: Pose2D, twist: Twist2D) -> bool:
        self.replans += 1
        return self._attempt(pose, twist)

    def _attempt(self, pose: Pose2D, twist: Twist2D) -> bool:
        """Plan now, or leave the plan pending until the robot stands or a pause is over; False if there is no path."""
        if self._tries.must_wait(twist, self._time):
            return True
        try:
            followed = self._call_planner(pose, twist)
        except PlanningError as error:
            self.error = error
            if not timed_out(error):
                self._tries.settle()
                return False
            self.progress_checker.reset()
            self.status = NavigationStatus.PLANNING_TIMED_OUT if self._tries.all_spent else NavigationStatus.BLOCKED
            return True
        self.error = None
        self._take(followed)
        return True

    def _look_for_better(self, pose: Pose2D, twist: Twist2D) -> None:
        """Plan again, and follow the new path if it is cheaper by the margin."""
        self.replans += 1
        try:
            followed = self._call_planner(pose, twist)
        except PlanningError as error:
            self.error = error
            self._tries.settle()
            return
        self.error = None
        if self._is_cheaper(followed, pose):
            self._take(followed)

    def _is_cheaper(self, other: FollowedPath, pose: Pose2D) -> bool:
        """Whether a new path from here is cheaper by the margin than what is left of the old one."""
        if self._followed is None:
            return True
        left = self._followed.cost_from(self.costmap, pose)
        return other.check.cost_from(self.costmap) < (1.0 - self.settings.replan_margin) * left

    # Recovering -----------------------------------------------------------------------------------------------------

    def _watch_for_block(self, command: Twist2D, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """Pass the controller's command on; if it makes no progress before the goal, replan or back up."""
        left_m = 0.0 if self._followed is None else self._followed.left_m
        if not self._recovery.is_blocked(command, twist, left_m):
            if command != _STAND:
                self.status = NavigationStatus.DRIVING
            return command
        if self._obstacle.is_blocked:
            return self._wait_for_obstacle(pose, twist)
        if not self._recovery.try_again(left_m) and not self._is_patient():
            self.status = NavigationStatus.STUCK if self.error is None else NavigationStatus.NO_PATH
            return _STAND
        self.status = NavigationStatus.BLOCKED
        self.progress_checker.reset()
        if self._recovery.backs_up_first or not self._replan(pose, twist):
            self._recovery.start_backing_up()
        return _STAND

    def _is_patient(self) -> bool:
        """Whether to start over with the tries of recovery: what holds the robot may be sensed, and may move away."""
        if not self._sensed.is_active or self._obstacle.gives_up:
            return False
        self._recovery.reset()
        return True

    def _wait_for_obstacle(self, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """Stand in front of what was sensed on the path, back up now and then, and give up after a while."""
        if self._obstacle.gives_up:
            if self._quick is not None and self._replan(pose, twist):
                self._obstacle.clear()
                return _STAND
            self.status = NavigationStatus.STUCK if self.error is None else NavigationStatus.NO_PATH
            return _STAND
        self.status = NavigationStatus.BLOCKED
        self.progress_checker.reset()
        if self.error is not None and self._obstacle.backs_up(self._time):
            self._recovery.start_backing_up()
        return _STAND

    def _back_up(self, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """Drive straight back while that is clear, then replan."""
        command = self._recovery.back_up()
        clear = can_stop(self.costmap, self.robot.limits, pose, twist, command, self.dt, padded=self._padded)
        if clear and self._recovery.is_backing_up:
            return command
        self._recovery.stop_backing_up()
        self._replan(pose, twist)
        return _STAND
