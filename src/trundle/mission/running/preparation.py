"""What comes before a run: the agent gets its goals, the run its time limit, and observers what they are to know."""

from __future__ import annotations

import contextlib
import itertools
import math
import numbers
from collections.abc import Sequence
from typing import cast

import numpy as np

from trundle.control.latency import Latency
from trundle.errors import BlockedPoseError, OutsideMapError, PlanningError, ScenarioError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.localization.localizer import Localizer, LocalizerAdapter
from trundle.mission.observers import RunInfo
from trundle.navigation import Agent, AgentInfo
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.command_check import fastest_s
from trundle.navigation.goal_queue import tasks_of
from trundle.observation import Estimate
from trundle.path import Path
from trundle.registry import name_of
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import RobotState, Simulator
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

TIME_PER_GOAL_S = 60.0
SLOWNESS = 4.0
"""The default time limit: so long for every goal [s], and so many times what the paths take at top speed."""
DETOUR = 4.0
"""So many times as long as the straight line a path counts that is planned only when the robot has seen something."""


def read_goals(goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None) -> tuple[Goal, ...]:
    """Read one goal, or a list of them.

    Raises:
        InputError: If these are no poses, or there is none.
    """
    if isinstance(goal, Pose2D):
        return (Goal.of(goal),)
    if not isinstance(goal, Sequence | np.ndarray) or isinstance(goal, str):
        raise ScenarioError(f"a goal is a pose, (x, y) or (x, y, yaw), or a list of these; got {goal!r}")
    if len(goal) == 0:
        raise ScenarioError("a run needs at least one goal")
    if all(isinstance(part, numbers.Real) for part in goal):
        return (Goal.of(cast("Sequence[float]", goal)),)
    return tuple(Goal.of(cast("Pose2D | Sequence[float]", part)) for part in goal)


def prepare(
    agent: Agent, start: Pose2D, goals: Sequence[Goal], *, through: bool | None, knows_start: bool = True
) -> tuple[list[Path], PlanningError | None]:
    """Give the agent its first goal, or all of them at once, and plan to each where it plans. See `plan_legs`.

    An agent whose localizer is not told the true start does not keep the plan from there: it makes its own.

    Raises:
        ScenarioError: If it is to drive through goals or to run tasks, and takes only one goal at a time.
    """
    if not goals:
        return [], None
    if agent.plans:
        found = plan_legs(agent, start, goals, through=through)
        if not knows_start and through is None:
            agent.set_goal(goals[0])
        elif not knows_start:
            agent.set_goals(goals, through=bool(through))
        return found
    if through is not None:
        agent.set_goals(goals, through=through)
        return [], None
    try:
        agent.set_goal(goals[0])
    except (BlockedPoseError, OutsideMapError):
        raise
    except PlanningError as error:
        return [], error
    return [], None


def plan_legs(
    agent: Agent, start: Pose2D, goals: Sequence[Goal], *, through: bool | None = None
) -> tuple[list[Path], PlanningError | None]:
    """Plan to every goal from the one before, so that a blocked goal is reported before anything moves.

    Args:
        agent: What plans.
        start: Pose from which the first leg is planned.
        goals: To where, in order.
        through: Whether the agent gets all goals at once, and drives through them (True) or stops at each (False);
            None means that it gets the first one.

    Returns:
        The plans, as far as there are any, and why there is no path to the first goal, if so; not where planning only
        took too long, as the agent tries again. The first goal, or all, and the plan stay in the agent.
    """
    plans: list[Path] = []
    unreachable: PlanningError | None = None
    here = start
    for index, goal in enumerate(goals):
        agent.set_goal(goal)
        try:
            path = agent.plan(here)
        except PlanningError as error:
            if _is_bad_input(error, goal, first=index == 0):
                raise
            if index == 0 and not agent.report().waits_to_plan:
                unreachable = error
            here = goal.pose
        else:
            if path is not None:
                plans.append(path)
                here = path.goal
    if len(goals) > 1 or through is not None:
        agent.set_goals(goals[:1] if through is None else goals, through=bool(through))
        if unreachable is None:
            with contextlib.suppress(PlanningError):  # the agent tries again
                agent.plan(start)
    return plans, unreachable


def _is_bad_input(error: PlanningError, goal: Goal, *, first: bool) -> bool:
    """Return whether the start or a goal is at fault. How the robot will stand at an earlier goal is not known yet."""
    if not isinstance(error, BlockedPoseError | OutsideMapError):
        return False
    return first or error.pose is None or error.pose[:2] == goal[:2]


def allowed_time(agent: Agent, robot: Robot, start: Pose2D, goals: Sequence[Goal], paths: Sequence[Path]) -> float:
    """Simulated time [s] that a run may take by default; see `Session`."""
    if not goals:
        return math.inf
    if agent.plans and paths:
        mask = agent.info().speed_mask
        least = sum(fastest_s(path, robot, mask) for path in paths)
    else:
        stops = (start.as_tuple(), *goals)
        straight = sum(math.dist(here[:2], there[:2]) for here, there in itertools.pairwise(stops))
        least = (DETOUR if agent.plans else 1.0) * straight / robot.limits.linear_speed
    tasks_s = sum(task.time_allowance for goal in goals for task in tasks_of(goal))
    return TIME_PER_GOAL_S * len(goals) + SLOWNESS * least + tasks_s


def standing_at(start: Pose2D) -> tuple[RobotState, Estimate]:
    """Return the state and estimate of a robot that stands at its start, for a run whose simulator has not said it."""
    still = WheelSpeeds(0.0, 0.0)
    origin = Pose2D(0.0, 0.0)
    return RobotState(0.0, start, Twist2D(), still, still, origin), Estimate(0.0, start, None, origin)


def describe_early(
    agent: object,
    robot: Robot,
    name: str,
    start: Pose2D,
    goals: tuple[Goal, ...],
    time_limit_s: float | None,
    seed: int,
    world: World | None,
) -> RunInfo:
    """Return what observers get of a run that ends before its first step, as far as its agent can say it."""
    info, dt = AgentInfo(type(agent).__name__), CONTROL_PERIOD_S
    if isinstance(agent, Agent):
        with contextlib.suppress(Exception):  # it is not known yet to be one that works
            info, dt = agent.info(), agent.dt
    limit = math.inf if time_limit_s is None else time_limit_s
    return describe_run(info, dt, robot, name, start, goals, (), limit, seed, world)


def describe_run(
    agent: AgentInfo,
    dt: float,
    robot: Robot,
    name: str,
    start: Pose2D,
    goals: tuple[Goal, ...],
    paths: Sequence[Path],
    time_limit_s: float,
    seed: int,
    world: World | None,
    localizer: Localizer | None = None,
) -> RunInfo:
    """Return what observers get before the first step."""
    locates = localizer.localizer if isinstance(localizer, LocalizerAdapter) else localizer
    return RunInfo(
        name=name,
        robot=robot,
        costmap=agent.costmap,
        start=start,
        goals=goals,
        path_length_m=sum(path.length for path in paths),
        time_limit_s=time_limit_s,
        dt=dt,
        planner=agent.planner,
        controller=agent.controller,
        seed=seed,
        speed_mask=agent.speed_mask,
        world=world,
        grid=agent.grid,
        localizer="none" if locates is None else name_of(locates),
    )


def delay_commands(sim: Simulator, latency: Latency, period_s: float) -> tuple[Simulator, Latency]:
    """The simulator with late commands, and the latency with the delay that they have there: a number of its steps."""
    if latency.command_delay_s <= 0.0:
        return sim, latency
    delayed = DelayedSimulator(sim, latency.command_delay_s)
    return delayed, latency.model_copy(update={"command_delay_s": delayed.delay_in(period_s)})
