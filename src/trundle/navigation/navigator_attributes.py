"""`NavigatorAttributes`: what a `Navigator` drives with, which may be replaced, and what it says of its drive."""

from __future__ import annotations

from collections.abc import Mapping

from trundle.control import Controller, GoalChecker, ProgressChecker, Rollouts, create_controller
from trundle.control.controller import ControllerLike, Intent
from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import SpeedMask
from trundle.navigation.agent import Agent
from trundle.navigation.behaviors import BehaviorRun
from trundle.navigation.command_check import CommandCheck
from trundle.navigation.goal_queue import GoalQueue
from trundle.navigation.navigator_settings import NavigatorSettings
from trundle.navigation.recovery import BehaviorRunner
from trundle.navigation.replanner import Replanner
from trundle.navigation.route_planner import RoutePlanner
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import DriveState, NavigationStatus
from trundle.observation import Track
from trundle.path import Path
from trundle.planning import PathCheck, Planner, Smoother, create_planner, create_smoother
from trundle.planning.planner import PlannerLike
from trundle.planning.smoother import SmootherLike
from trundle.robots import Robot
from trundle.values import check_kind


class NavigatorAttributes(Agent):
    """The attributes of a `Navigator`, which makes the parts and documents the attributes; nothing here drives."""

    settings: NavigatorSettings
    robot: Robot
    grid: OccupancyGrid | None
    speed_mask: SpeedMask | None
    planner_name: str
    controller_name: str
    progress_checker: ProgressChecker
    tracks: tuple[Track, ...]
    _state: DriveState = DriveState()
    _sensed: SensedMap
    _routes: RoutePlanner
    _replanner: Replanner
    _check: CommandCheck
    _runner: BehaviorRunner
    _goal_queue: GoalQueue
    _controller: Controller

    def __repr__(self) -> str:
        goal = "no goal" if self.target is None else repr(self.target)
        names = f"{self.robot.name}, {self.planner_name}, {self.controller_name}"
        return f"{type(self).__name__}({names}, {goal}, {self.status.value})"

    # What may be replaced -------------------------------------------------------------------------------------------

    @property
    def planner(self) -> Planner:
        """What plans; whatever plans may take its place, at any time."""
        return self._replanner.planner

    @planner.setter
    def planner(self, planner: PlannerLike) -> None:
        self._replanner.use(create_planner(planner, self.robot, self.grid))

    @property
    def controller(self) -> Controller:
        """What follows the path; whatever follows one may take its place before a drive."""
        return self._controller

    @controller.setter
    def controller(self, controller: ControllerLike) -> None:
        self._controller = create_controller(controller, self.robot, self.grid)

    @property
    def smoother(self) -> Smoother | None:
        """What smooths every planned path, or None; may be replaced."""
        return self._routes.smoother

    @smoother.setter
    def smoother(self, smoother: SmootherLike | None) -> None:
        self._routes.smoother = None if smoother is None else create_smoother(smoother)

    @property
    def goal_checker(self) -> GoalChecker:
        """What says whether the goal is reached; may be replaced."""
        return self._routes.goal_checker

    @goal_checker.setter
    def goal_checker(self, checker: GoalChecker) -> None:
        self._routes.goal_checker = checker

    @property
    def static_costmap(self) -> Costmap | None:
        """The costmap of the map, without what the scans saw; None without a map."""
        return self._sensed.static

    @static_costmap.setter
    def static_costmap(self, costmap: Costmap) -> None:
        check_kind(costmap, Costmap, "a static costmap", "CostmapSettings().make_costmap(grid, robot) makes one")
        self._sensed.replace_static(costmap)

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
    def has_map(self) -> bool:
        """Whether it drives on a map, and not only on what its scans see."""
        return self._sensed.static is not None

    # The drive ------------------------------------------------------------------------------------------------------

    @property
    def status(self) -> NavigationStatus:  # type: ignore[override]
        """What it is doing."""
        return self._state.status

    @property
    def message(self) -> str:
        """What blocks the robot, such as "blocked: obstacle ahead at (2.00, 3.50)"; empty where nothing does."""
        return self._state.message

    @property
    def error(self) -> PlanningError | None:
        """The last planning error, or None."""
        return self._state.error

    @property
    def replans(self) -> int:
        """Number of plans since the goal was set, after the first."""
        return self._state.replans

    @property
    def planning_time_s(self) -> float:
        """Time spent on planning since the goal was set [s]."""
        return self._state.planning_time_s

    @property
    def planning_expansions(self) -> int:
        """Nodes that were expanded in planning since the goal was set; see `Planner.plan`."""
        return self._state.planning_expansions

    @property
    def standing_reasons(self) -> Mapping[str, int]:
        """In how many control periods since the goal was set the controller made no progress, by its reason."""
        return self._state.standing_reasons

    @property
    def behavior_runs(self) -> tuple[BehaviorRun, ...]:
        """The behaviors that ran since the last `reset`, in order: steps of recovery and what it was asked for."""
        return self._runner.runs

    @property
    def waits_to_plan(self) -> bool:
        """Whether the robot waits for a plan: the last one missed its deadline, or took many expansions."""
        return self._replanner.tries.pending

    @property
    def speed_limit(self) -> float:
        """What the speed mask allows now [m/s], infinite where it limits nothing."""
        return self._check.speed_limit

    @property
    def intent(self) -> Intent | None:
        """What the controller means to command next, for a collision monitor; None where it does not say."""
        return self._controller.intent

    @property
    def rollouts(self) -> Rollouts | None:
        """The best samples of the controller in the last control period, or None; see `MppiController.rollouts`."""
        return self._controller.rollouts()

    # Goals and path -------------------------------------------------------------------------------------------------

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All goals that were set, in order; empty without a goal."""
        return self._goal_queue.goals

    @property
    def goals_reached(self) -> int:
        """How many of them were reached or passed."""
        return self._goal_queue.goals_reached

    @property
    def target(self) -> Goal | None:
        """The goal that it drives to, or None; as a goal, it says whether any yaw will do."""
        return self._state.target

    @property
    def ahead(self) -> tuple[Goal, ...]:
        """The goals from that one up to the next stop."""
        return self._state.ahead

    @property
    def goal(self) -> Pose2D | None:
        """The goal pose; its yaw is 0 where any yaw will do."""
        return None if self.target is None else self.target.pose

    @property
    def path(self) -> Path | None:
        """The path that it follows, or None."""
        return None if self._replanner.followed is None else self._replanner.followed.path

    @property
    def path_check(self) -> PathCheck | None:
        """The check of that path, with its poses close together; None without one."""
        return None if self._replanner.followed is None else self._replanner.followed.check

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
    def follows_given(self) -> bool:
        """Whether it follows a path that `follow` gave it."""
        return self._replanner.is_given
