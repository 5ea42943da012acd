"""What comes before a run: the agent gets its goals, the run its time limit, and observers what they are to know."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

from trundle.errors import BlockedPoseError, OutsideMapError, PlanningError, ScenarioError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.mission.legs import plan_legs
from trundle.mission.observers import RunInfo
from trundle.navigation import Agent, Navigator
from trundle.navigation.agent import CONTROL_PERIOD_S
from trundle.navigation.speed_limiter import fastest_s
from trundle.navigation.waypoint import tasks_of
from trundle.observation import Estimate
from trundle.path import Path
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import RobotState
from trundle.worlds import World

TIME_PER_GOAL_S = 60.0
SLOWNESS = 4.0


def prepare(
    agent: Agent, start: Pose2D, goals: Sequence[Goal], *, through: bool | None
) -> tuple[list[Path], PlanningError | None]:
    """Give the agent its first goal, or all of them at once; a navigator plans to each. See `plan_legs`.

    Raises:
        ScenarioError: If it is to drive through goals or to run tasks, and takes only one goal at a time.
    """
    if not goals:
        return [], None
    if isinstance(agent, Navigator):
        return plan_legs(agent, start, goals, through=through)
    if through is not None:
        set_goals = getattr(agent, "set_goals", None)
        if not callable(set_goals):
            raise ScenarioError(
                f"{type(agent).__name__} takes one goal at a time: to drive through goals, and to run tasks, takes an "
                "agent with set_goals(goals, through=…) and goals_reached, such as a Navigator"
            )
        set_goals(goals, through=through)
        return [], None
    try:
        agent.set_goal(goals[0])
    except (BlockedPoseError, OutsideMapError):
        raise
    except PlanningError as error:
        return [], error
    return [], None


def allowed_time(agent: Agent, robot: Robot, start: Pose2D, goals: Sequence[Goal], paths: Sequence[Path]) -> float:
    """Simulated time [s] that a run may take by default; see `Session`."""
    if not goals:
        return math.inf
    if isinstance(agent, Navigator):
        least = sum(fastest_s(path, robot, agent.speed_mask) for path in paths)
    else:
        stops = (start.as_tuple(), *goals)
        straight = sum(math.dist(here[:2], there[:2]) for here, there in itertools.pairwise(stops))
        least = straight / robot.limits.linear_speed
    tasks_s = sum(task.time_allowance for goal in goals for task in tasks_of(goal))
    return TIME_PER_GOAL_S * len(goals) + SLOWNESS * least + tasks_s


def standing_at(start: Pose2D) -> tuple[RobotState, Estimate]:
    """State and estimate of a robot that stands at its start, for a run whose simulator has not said it."""
    still = WheelSpeeds(0.0, 0.0)
    origin = Pose2D(0.0, 0.0)
    return RobotState(0.0, start, Twist2D(), still, still, origin), Estimate(0.0, start, None, origin)


def describe_early(
    agent: Agent,
    robot: Robot,
    name: str,
    start: Pose2D,
    goals: tuple[Goal, ...],
    *,
    time_limit_s: float | None,
    seed: int,
    world: World | None,
) -> RunInfo:
    """What observers get of a run that ends before its first step: no plug-in is asked for it."""
    own = agent if isinstance(agent, Navigator) else None
    limit = math.inf if time_limit_s is None else time_limit_s
    info = describe_run(own, robot, name, start, goals, (), time_limit_s=limit, seed=seed, world=world)
    return info if own is not None else replace(info, controller=type(agent).__name__)


def describe_run(
    agent: Agent | None,
    robot: Robot,
    name: str,
    start: Pose2D,
    goals: tuple[Goal, ...],
    paths: Sequence[Path],
    *,
    time_limit_s: float,
    seed: int,
    world: World | None,
) -> RunInfo:
    """What observers get before the first step; nothing is read of an agent that is None."""
    return RunInfo(
        name=name,
        robot=robot,
        costmap=getattr(agent, "costmap", None),
        start=start,
        goals=goals,
        path_length_m=sum(path.length for path in paths),
        time_limit_s=time_limit_s,
        dt=getattr(agent, "dt", CONTROL_PERIOD_S),
        planner=getattr(agent, "planner_name", "none"),
        controller="none" if agent is None else getattr(agent, "controller_name", type(agent).__name__),
        seed=seed,
        speed_mask=getattr(agent, "speed_mask", None),
        world=world,
        grid=getattr(agent, "grid", None),
    )
