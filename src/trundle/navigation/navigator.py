"""`Navigator`: the whole autonomy behind one call, for anybody's loop."""

from __future__ import annotations

import inspect
import math
import os
import time as clock
from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Any

from trundle.control import Controller, GoalChecker, ProgressChecker, create_controller
from trundle.control.collision import can_stop
from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import Planner, create_planner
from trundle.robots import Robot

_STAND = Twist2D(0.0, 0.0)
_STANDING_MPS = 0.01
_BLOCKED_AFTER_S = 0.5
_BACK_UP_M = 0.3
_BACK_UP_MPS = 0.15
_MAX_RECOVERIES = 6


class NavigationStatus(StrEnum):
    """What a navigator is doing."""

    IDLE = "idle"
    """It has no goal."""
    DRIVING = "driving"
    """It is on the way."""
    BLOCKED = "blocked"
    """Every way on would touch something; it is planning anew or backing up."""
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    STUCK = "stuck"
    """The robot has not got on for too long; it has given up this goal."""
    NO_PATH = "no_path"
    """There is no way to the goal; `Navigator.error` says why."""


class Navigator:
    """Plans a path, follows it, plans again where it is blocked, and says how it stands.

    It knows no simulator: call `update` with the robot's pose once per control period and send the twist to the robot.

    Args:
        grid: The map: a grid, a costmap made for this robot, or the path of a ROS map YAML.
        robot: A robot, a catalogue name or the path of a YAML file.
        planner: A planner or the name of one.
        controller: A controller or the name of one.
        planner_options: For a planner by name.
        controller_options: For a controller by name.
        goal_checker: When the goal is reached; Nav2's tolerances by default.
        progress_checker: When the robot is stuck; Nav2's by default.
        inflation_radius: Of the costmap [m]; none means the costmap's default for the robot.
        cost_scaling_factor: Of the costmap [1/m]; none means the costmap's default.
        control_frequency: How often `update` is called [Hz].

    Attributes:
        robot: The robot.
        grid: The map, or None where a costmap was given.
        costmap: What it plans and drives on.
        path: The path that it follows, or None.
        status: How it stands.
        error: Why there is no path, where there is none.
        planning_time_s: Time spent on planning since the goal was set [s].
        replans: How often it planned again since the goal was set, beyond the first plan.

    Raises:
        UnknownNameError: If a name is not known.
        MapError: If the map cannot be read.
        InputError: If an option is out of range.
    """

    def __init__(
        self,
        grid: OccupancyGrid | Costmap | str | os.PathLike[str],
        robot: Robot | str | os.PathLike[str],
        *,
        planner: str | Planner = "least_cost",
        controller: str | Controller = "regulated_pure_pursuit",
        planner_options: Mapping[str, Any] | None = None,
        controller_options: Mapping[str, Any] | None = None,
        goal_checker: GoalChecker | None = None,
        progress_checker: ProgressChecker | None = None,
        inflation_radius: float | None = None,
        cost_scaling_factor: float | None = None,
        control_frequency: float = 20.0,
    ) -> None:
        if not (math.isfinite(control_frequency) and control_frequency > 0.0):
            raise InputError(f"control_frequency must be a positive number of hertz, got {control_frequency}")
        self.robot = Robot.load(robot)
        if isinstance(grid, Costmap):
            self.grid, self.costmap = None, grid
        else:
            self.grid = _load_grid(grid)
            self.costmap = _make_costmap(self.grid, self.robot, inflation_radius, cost_scaling_factor)
        self.planner_name = planner if isinstance(planner, str) else type(planner).__name__
        self.controller_name = controller if isinstance(controller, str) else type(controller).__name__
        self.planner = create_planner(planner, **(planner_options or {}))
        self._plans_free_yaw = "goal_yaw_free" in inspect.signature(self.planner.plan).parameters
        self.controller = create_controller(controller, self.robot, **(controller_options or {}))
        self.goal_checker = goal_checker or GoalChecker()
        self.progress_checker = progress_checker or ProgressChecker()
        self.dt = 1.0 / control_frequency
        self.reset()

    # Goals ----------------------------------------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget the goal and everything about it."""
        self._goal: Pose2D | None = None
        self._any_yaw = False
        self._forget_progress()
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
        if isinstance(goal, int | float):
            if y is None:
                raise InputError("set_goal needs x and y, and may take a yaw")
            numbers: Sequence[float] = (goal, y) if yaw is None else (goal, y, yaw)
        else:
            numbers = goal.as_tuple() if isinstance(goal, Pose2D) else tuple(goal)
        self._goal = Pose2D.of(numbers)
        self._any_yaw = len(numbers) == 2
        self._forget_progress()
        self.status = NavigationStatus.DRIVING

    @property
    def goal(self) -> Pose2D | None:
        """Where it is going; the yaw is 0 where any yaw will do."""
        return self._goal

    def _forget_progress(self) -> None:
        self.path: Path | None = None
        self.error: PlanningError | None = None
        self.planning_time_s = 0.0
        self.replans = 0
        self.progress_checker.reset()
        self._time = 0.0
        self._command = _STAND
        self._blocked_s = 0.0
        self._back_up_left = 0.0
        self._recoveries = 0

    # Driving --------------------------------------------------------------------------------------------------------

    def plan(self, start: Pose2D | Sequence[float]) -> Path:
        """Plan from `start` to the goal and follow that path from now on.

        Raises:
            InputError: If there is no goal.
            PlanningError: If there is no path.
        """
        if self._goal is None:
            raise InputError("there is no goal to plan to; call set_goal first")
        began = clock.perf_counter()
        try:
            path = self._call_planner(Pose2D.of(start), self._goal)
        finally:
            self.planning_time_s += clock.perf_counter() - began
        self.path = path
        self.controller.set_path(path)
        return path

    def _call_planner(self, start: Pose2D, goal: Pose2D) -> Path:
        options = {"goal_yaw_free": True} if self._any_yaw and self._plans_free_yaw else {}
        return self.planner.plan(self.costmap, start, goal, **options)

    def update(
        self, pose: Pose2D | Sequence[float], twist: Twist2D | None = None, *, time: float | None = None
    ) -> Twist2D:
        """Say how to drive for the next control period.

        Args:
            pose: Where the robot is now, map frame: a pose or (x, y, yaw).
            twist: How it moves now, base_link; none means as it was last told to.
            time: Now [s], any origin; none means one control period after the last call.

        Returns:
            The twist to send. It is (0, 0) when there is nothing to do; `status` says why.
        """
        here = Pose2D.of(pose)
        moving = self._command if twist is None else twist
        self._time = self._time + self.dt if time is None else time
        self._command = self._decide(here, moving)
        return self._command

    def _decide(self, pose: Pose2D, twist: Twist2D) -> Twist2D:
        if self._goal is None or self.status in _FINAL:
            return _STAND
        if self.goal_checker.is_reached(pose, twist, self._goal, any_yaw=self._any_yaw):
            self.status = NavigationStatus.ARRIVED
            return _STAND
        if self.path is None:
            try:
                self.plan(pose)
            except PlanningError as error:
                self.error = error
                self.status = NavigationStatus.NO_PATH
                return _STAND
        if not self.progress_checker.is_moving_on(pose, self._time):
            self.status = NavigationStatus.STUCK
            return _STAND
        if self._back_up_left > 0.0:
            return self._back_up(pose, twist)
        command = self.controller.compute_velocity(pose, twist, self.costmap, self.dt)
        return self._watch_for_block(command, pose, twist)

    # Recovering -----------------------------------------------------------------------------------------------------

    def _watch_for_block(self, command: Twist2D, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """Pass the controller's command on; where it keeps standing short of the goal, plan anew, then back up."""
        standing = abs(twist.v) < _STANDING_MPS and abs(twist.w) < _STANDING_MPS
        if command != _STAND or not standing:
            self._blocked_s = 0.0
            self.status = NavigationStatus.DRIVING
            return command
        self._blocked_s += self.dt
        if self._blocked_s < _BLOCKED_AFTER_S:
            return command
        self.status = NavigationStatus.BLOCKED
        self._blocked_s = 0.0
        self._recoveries += 1
        if self._recoveries > _MAX_RECOVERIES:
            self.status = NavigationStatus.STUCK
            return _STAND
        if self._recoveries % 2 == 0 or not self._replan(pose):
            self._back_up_left = _BACK_UP_M
        return _STAND

    def _replan(self, pose: Pose2D) -> bool:
        self.replans += 1
        try:
            self.plan(pose)
        except PlanningError:
            return False
        return True

    def _back_up(self, pose: Pose2D, twist: Twist2D) -> Twist2D:
        """Drive straight back while that is clear, then plan anew."""
        command = Twist2D(-_BACK_UP_MPS, 0.0)
        self._back_up_left -= abs(command.v) * self.dt
        clear = can_stop(self.costmap, self.robot.limits, pose, twist, command, self.dt)
        if clear and self._back_up_left > 0.0:
            return command
        self._back_up_left = 0.0
        self._replan(pose)
        return _STAND


_FINAL = frozenset({NavigationStatus.ARRIVED, NavigationStatus.STUCK, NavigationStatus.NO_PATH})


def _load_grid(grid: OccupancyGrid | str | os.PathLike[str]) -> OccupancyGrid:
    return grid if isinstance(grid, OccupancyGrid) else OccupancyGrid.load(grid)


def _make_costmap(
    grid: OccupancyGrid, robot: Robot, inflation_radius: float | None, cost_scaling_factor: float | None
) -> Costmap:
    options = {"inflation_radius": inflation_radius, "cost_scaling_factor": cost_scaling_factor}
    given = {name: value for name, value in options.items() if value is not None}
    return Costmap.from_grid(grid, robot.outline, **given)
