"""`Agent`: what decides how a robot drives; `AgentInfo` and `AgentReport`, what it says of itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, NamedTuple, Protocol, cast

from trundle.control import GoalChecker, Rollouts
from trundle.control.controller import Intent
from trundle.control.latency import Latency
from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError, ScenarioError
from trundle.fault import wrong_result
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import SpeedMask
from trundle.navigation.behaviors import Behavior, BehaviorRun
from trundle.navigation.command_check import AssistedCommand
from trundle.navigation.state import NavigationStatus
from trundle.observation import Estimate, Observation, Track
from trundle.path import Path
from trundle.registry import name_of
from trundle.robots import Robot

CONTROL_PERIOD_S = 0.05
"""Length of the control periods of an agent that does not say it [s]: 20 Hz, Nav2's default."""


_NONE: Mapping[str, int] = MappingProxyType({})


@dataclass(frozen=True, slots=True, eq=False)
class AgentInfo:
    """What an agent is and drives with, which does not change during a run.

    Attributes:
        controller: Name of the controller, or of the agent, for reports.
        planner: Name of the planner, "none" without one.
        robot: The robot that it takes itself to drive; None means the simulator's.
        grid: Its map, which a localizer gets too; None without one.
        costmap: What it plans and drives on at the start; None without one.
        speed_mask: What limits its speed, or None.
        goal_checker: What says whether a pose is at the goal; None means that the run's default decides.
        plugins: The objects that may be of other packages, of which an exception may come.
    """

    controller: str
    planner: str = "none"
    robot: Robot | None = None
    grid: OccupancyGrid | None = None
    costmap: Costmap | None = None
    speed_mask: SpeedMask | None = None
    goal_checker: GoalChecker | None = None
    plugins: tuple[object, ...] = ()


class AgentReport(NamedTuple):
    """What an agent is doing after a control period; all but the status may be left out.

    It is a named tuple, as one is made in every control period: a frozen dataclass takes four times as long.

    Attributes:
        status: What it is doing.
        message: What blocks it, such as "blocked: obstacle ahead at (2.00, 3.50)"; empty where nothing does.
        error: Why it has no path, or None.
        path: The path that it follows, or None.
        distance_remaining: Length of what is left of that path [m]; None without one.
        costmap: What it drives on, or None.
        tracks: What its scans show to move, map frame.
        rollouts: The best samples of its controller; None where there are none, or they were not asked for.
        intent: What it means to command next, for the collision monitor; None where it does not say.
        goals_reached: How many of the goals that `set_goals` gave it are reached or passed.
        behaviors: The behaviors that it has run since the last reset, in order; the last one may still be running.
        replans: Number of plans since the goal was set, after the first.
        planning_time_s: Wall time spent on planning since the goal was set [s].
        standing_reasons: In how many control periods since then it made no progress, by reason.
        waits_to_plan: Whether it stands and waits until it may plan again.
        follows_given: Whether it follows a path that `follow` gave it.
    """

    status: NavigationStatus
    message: str = ""
    error: PlanningError | None = None
    path: Path | None = None
    distance_remaining: float | None = None
    costmap: Costmap | None = None
    tracks: tuple[Track, ...] = ()
    rollouts: Rollouts | None = None
    intent: Intent | None = None
    goals_reached: int = 0
    behaviors: tuple[BehaviorRun, ...] = ()
    replans: int = 0
    planning_time_s: float = 0.0
    standing_reasons: Mapping[str, int] = _NONE
    waits_to_plan: bool = False
    follows_given: bool = False


class SomeAgent(Protocol):
    """The least that an object needs to be used as an agent; `create_agent` makes an `Agent` of it."""

    @property
    def status(self) -> NavigationStatus:
        """What it is doing."""
        ...

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal, and all that was observed."""
        ...

    def set_goal(self, goal: Goal, /) -> None:
        """Set where to drive, map frame."""
        ...

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command for the next control period."""
        ...


def read_status(agent: SomeAgent) -> NavigationStatus:
    """Return what an agent is doing; its status may be the text of one, such as "driving".

    Raises:
        InputError: If it is none.
    """
    status = cast("object", agent.status)
    if isinstance(status, NavigationStatus):
        return status
    try:
        return NavigationStatus(cast("str", status))
    except ValueError:
        choices = ", ".join(NavigationStatus)
        raise wrong_result(
            f"agent {name_of(agent)!r} has the status {status!r}: a status is a NavigationStatus, one of {choices}",
            agent,
            "status",
            kind="agent",
        ) from None


class Agent(ABC):
    """Decides how a robot drives: a `Navigator`, a script, a keyboard, or another package's autonomy.

    A `Session` calls `update` once per control period, and `report` after it. `reset`, `set_goal`, `update` and the
    attribute `status` are all that an agent must have. Everything else has a default here, for an agent that has no
    path, no map, no behaviors, and takes one goal at a time; an agent overrides what it can do more.

    Attributes:
        status: What it is doing. ARRIVED, FINISHED, STUCK, NO_PATH and PLANNING_TIMED_OUT end the drive to a goal.
        dt: Length of the next control period [s]; it may change with every `update`.
        plans: Whether it plans a path to each goal, by `plan` and `plan_between`, before it moves.
        needs_goal: Whether it drives to goals alone: its run has one from the start, or waits for one.
        takes_goals: Whether it drives to goals at all; a scenario gives none to one that does not.
    """

    status: NavigationStatus
    dt: float = CONTROL_PERIOD_S
    plans: bool = False
    needs_goal: bool = False
    takes_goals: bool = True

    # Driving: what an agent must have -------------------------------------------------------------------------------

    @abstractmethod
    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal, and all that was observed. The same seed and observations give the same commands."""

    @abstractmethod
    def set_goal(self, goal: Goal, /) -> None:
        """Set where to drive, map frame."""

    @abstractmethod
    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command for the next control period.

        A session that sets the next goal calls it again at the same time, without scans.

        Args:
            observation: What the robot knows of its surroundings and its motion.
            estimate: Where it believes to be.
        """

    # What it says of itself -----------------------------------------------------------------------------------------

    def info(self) -> AgentInfo:
        """Return what it is and drives with; a session asks before a run. By default only the name of its class."""
        return AgentInfo(type(self).__name__)

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Return what it is doing; a session asks after every `update`. By default only the status.

        Args:
            rollouts: Whether the best samples of its controller are wanted, which may take time.
        """
        return AgentReport(read_status(self))

    @property
    def path_left(self) -> Path | None:
        """What is left of the path that it follows; None without one."""
        return None

    # What it is told ------------------------------------------------------------------------------------------------

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late scans and commands arrive. By default it does not."""

    def set_map(self, grid: OccupancyGrid, *, corrected: bool) -> None:
        """Take the map that the localizer has made so far, before the next `update`. By default it does not count.

        Args:
            grid: The map; its extent may have changed.
            corrected: Whether what was mapped before has moved since the last call.
        """

    def set_sent_command(self, command: Twist2D) -> None:
        """Take what was sent to the robot instead of the last command, where a check of the run changed it."""

    def assist_teleop(self, command: Twist2D, observation: Observation, estimate: Estimate) -> AssistedCommand:
        """Return what of a command by hand may be sent; called instead of `update` while the robot is driven by hand.

        By default all of it: the agent knows nothing that the robot could touch.
        """
        return AssistedCommand(command)

    # Goals and paths ------------------------------------------------------------------------------------------------

    def set_goals(self, goals: Sequence[Goal], *, through: bool = False) -> None:
        """Set several goals, to be reached in order: it stops at each, or drives through them without stopping.

        It then counts them in `AgentReport.goals_reached`. By default it is refused.

        Raises:
            ScenarioError: If the agent takes one goal at a time.
        """
        raise ScenarioError(
            f"{self.info().controller} takes one goal at a time: to drive through goals, and to run tasks, takes an "
            "agent with set_goals(goals, through=…) and goals_reached, such as a Navigator"
        )

    def plan(self, start: Pose2D, /) -> Path | None:
        """Plan from `start` to the goal that was set, and follow that path; None by an agent that does not plan.

        Raises:
            PlanningError: If there is no path.
        """
        return None

    def plan_between(self, start: Pose2D, goal: Goal) -> Path | None:
        """Plan a path, and follow it not; None without one that is known, and by an agent that does not plan.

        Raises:
            PlanningError: If its map shows that there is no path.
        """
        return None

    def follow(self, path: Path) -> None:
        """Follow this path to its end, instead of planning one. By default it is refused.

        Raises:
            InputError: If the agent follows no given path, or not this one.
        """
        raise self._lacks("follows no given path")

    def cancel(self) -> None:
        """Stop: forget the goal, and interrupt what is running. By default it is refused.

        Raises:
            InputError: If the agent cannot.
        """
        raise self._lacks("cannot give up its goal")

    # Behaviors and costmap ------------------------------------------------------------------------------------------

    def run(self, behavior: Behavior) -> None:
        """Run a behavior from the next `update` on, then drive on. By default it is refused.

        Raises:
            InputError: If the agent runs no behaviors.
        """
        raise self._lacks("runs no behaviors")

    def cancel_behavior(self) -> None:
        """Stop the behavior that was asked for, if one runs, and drive on. By default it is refused.

        Raises:
            InputError: If the agent runs no behaviors.
        """
        raise self._lacks("runs no behaviors")

    def clear_obstacles(
        self, region: Literal["all", "around", "except"] = "all", size: float = 0.0, *, at: Pose2D | None = None
    ) -> None:
        """Forget what the scans saw, everywhere or by a square of this size [m]. By default it is refused.

        The middle of the square is the robot, or `at` (map frame) where that is given.

        Raises:
            InputError: If the agent has no costmap to clear.
        """
        raise self._lacks("has no costmap to clear")

    def _lacks(self, what: str) -> InputError:
        return InputError(f"the agent of this run, {self.info().controller}, {what}")
