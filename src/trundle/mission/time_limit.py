"""`time_limit`: how long a run may take where nobody says it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from trundle.geometry import Goal, Pose2D
from trundle.navigation import Agent, Navigator
from trundle.navigation.speed_limiter import fastest_s
from trundle.path import Path
from trundle.robots import Robot

TIME_PER_GOAL_S = 60.0
SLOWNESS = 4.0


def time_limit(agent: Agent, robot: Robot, start: Pose2D, goals: Sequence[Goal], paths: Sequence[Path]) -> float:
    """60 s for every goal and four times what the paths take at the top speed [s]; infinite without a goal."""
    if not goals:
        return math.inf
    if isinstance(agent, Navigator):
        least = sum(fastest_s(path, robot, agent.speed_mask) for path in paths)
    else:
        stops = (start.as_tuple(), *goals)
        straight = sum(math.dist(here[:2], there[:2]) for here, there in itertools.pairwise(stops))
        least = straight / robot.limits.linear_speed
    return TIME_PER_GOAL_S * len(goals) + SLOWNESS * least
