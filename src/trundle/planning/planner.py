"""The seam that every planner stands behind, and the planners by name."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.registry import Registry

PLANNERS: Registry[Planner] = Registry(
    "planner",
    "trundle.planners",
    {
        "auto": "trundle.planning.auto:AutoPlanner",
        "least_cost": "trundle.planning.least_cost:LeastCostPlanner",
        "astar": "trundle.planning.astar:AStarPlanner",
        "jps": "trundle.planning.jps:JpsPlanner",
        "jps_plus": "trundle.planning.jps:JpsPlusPlanner",
        "hybrid_astar": "trundle.planning.hybrid_astar:HybridAStarPlanner",
        "any_angle": "trundle.planning.any_angle:AnyAnglePlanner",
        "theta_star": "trundle.planning.any_angle:ThetaStarPlanner",
        "blog": "trundle.planning.blog:BlogPlanner",
    },
)


@runtime_checkable
class Planner(Protocol):
    """Finds a way. It keeps no state that changes an answer: the same question gives the same path.

    `plan` may also take the keyword `goal_yaw_free=True`, by which a `Navigator` says that any yaw will do at the goal.
    """

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> Path:
        """Plan from `start` to `goal`, poses in the map frame.

        Raises:
            PlanningError: If there is no path, never an empty path; `OutsideMapError`, `BlockedPoseError` and
                `NoPathError` say which kind.
        """
        ...


def planner_names() -> list[str]:
    """Names that `create_planner` takes, sorted."""
    return PLANNERS.names()


def create_planner(planner: str | Planner, **options: Any) -> Planner:
    """Make a planner from its name and options, or take one as it is.

    Raises:
        UnknownNameError: If there is no planner of that name.
        InputError: If it does not take these options, or is no planner.
    """
    return PLANNERS.take(planner, "plan", **options)
