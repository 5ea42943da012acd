"""trundle: from a map to a moving robot.

Every public name has one canonical module; the common ones can also be imported from here, and load on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names
from trundle.version import __version__

if TYPE_CHECKING:
    from trundle.costmap import Costmap, CostmapSettings
    from trundle.errors import InputError, PlanningError, TrundleError
    from trundle.evaluation import Evaluation, Suite, evaluate
    from trundle.geometry import Goal, Pose2D, Twist2D
    from trundle.mapping import Mapper, PoseGraph, draw_map
    from trundle.maps import HeightField, OccupancyGrid
    from trundle.mission import Episode, Exploration, Outcome, Scenario, Session, explore, run, sample_mission
    from trundle.navigation import Choice, Navigator, NavigatorSettings
    from trundle.observation import Estimate, Observation, Scan
    from trundle.path import Path
    from trundle.robots import Robot
    from trundle.serve import show
    from trundle.sim import RobotState, simulate
    from trundle.worlds import World

__getattr__ = lazy_names(
    __name__,
    {
        "Choice": "trundle.navigation",
        "Costmap": "trundle.costmap",
        "CostmapSettings": "trundle.costmap",
        "Episode": "trundle.mission",
        "Estimate": "trundle.observation",
        "Evaluation": "trundle.evaluation",
        "Exploration": "trundle.mission",
        "Goal": "trundle.geometry",
        "HeightField": "trundle.maps",
        "InputError": "trundle.errors",
        "Mapper": "trundle.mapping",
        "Navigator": "trundle.navigation",
        "NavigatorSettings": "trundle.navigation",
        "Observation": "trundle.observation",
        "OccupancyGrid": "trundle.maps",
        "Outcome": "trundle.mission",
        "Path": "trundle.path",
        "PlanningError": "trundle.errors",
        "Pose2D": "trundle.geometry",
        "PoseGraph": "trundle.mapping",
        "Robot": "trundle.robots",
        "RobotState": "trundle.sim",
        "Scan": "trundle.observation",
        "Scenario": "trundle.mission",
        "Session": "trundle.mission",
        "Suite": "trundle.evaluation",
        "TrundleError": "trundle.errors",
        "Twist2D": "trundle.geometry",
        "World": "trundle.worlds",
        "draw_map": "trundle.mapping",
        "evaluate": "trundle.evaluation",
        "explore": "trundle.mission",
        "run": "trundle.mission",
        "sample_mission": "trundle.mission",
        "show": "trundle.serve",
        "simulate": "trundle.sim",
    },
)

__all__ = [
    "Choice",
    "Costmap",
    "CostmapSettings",
    "Episode",
    "Estimate",
    "Evaluation",
    "Exploration",
    "Goal",
    "HeightField",
    "InputError",
    "Mapper",
    "Navigator",
    "NavigatorSettings",
    "Observation",
    "OccupancyGrid",
    "Outcome",
    "Path",
    "PlanningError",
    "Pose2D",
    "PoseGraph",
    "Robot",
    "RobotState",
    "Scan",
    "Scenario",
    "Session",
    "Suite",
    "TrundleError",
    "Twist2D",
    "World",
    "__version__",
    "draw_map",
    "evaluate",
    "explore",
    "run",
    "sample_mission",
    "show",
    "simulate",
]


def __dir__() -> list[str]:
    return sorted(__all__)
