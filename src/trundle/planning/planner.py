"""The protocol of planners, and the planners by name."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation
from trundle.planning.older_planner import adapt_planner
from trundle.registry import Registry

PLANNERS: Registry[Planner] = Registry(
    "planner",
    "trundle.planners",
    {
        "auto": "trundle.planning.auto:AutoPlanner",
        "least_cost": "trundle.planning.grid_planners.least_cost:LeastCostPlanner",
        "astar": "trundle.planning.grid_planners.astar:AStarPlanner",
        "hybrid_astar": "trundle.planning.hybrid_astar:HybridAStarPlanner",
        "any_angle": "trundle.planning.grid_planners.any_angle:AnyAnglePlanner",
        "manhattan_astar": "trundle.planning.grid_planners.manhattan_astar:ManhattanAstarPlanner",
    },
    removed={
        "blog": "was renamed; use manhattan_astar",
        "jps": "was removed; use astar with method='jps'",
        "jps_plus": "was removed; use astar with method='jps'",
        "theta_star": "was removed; use any_angle, whose paths are shorter and found faster",
    },
)


@runtime_checkable
class Planner(Protocol):
    """Finds a path. It keeps no state that changes a result: the same query gives the same path.

    A planner of another package whose `plan` takes fewer of the keywords works as well: `create_planner` wraps it, and
    leaves those out; one that takes `**kwargs` gets all of them.
    """

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Pose2D,
        *,
        goal_yaw_free: bool = False,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`, poses in the map frame.

        Args:
            costmap: What to stay clear of.
            start: Where the robot stands.
            goal: Where it is to stand.
            goal_yaw_free: Any yaw will do at the goal.
            deadline_s: Give up after this time [s]; none means as long as it takes. A search bounded by other means,
                such as its expansions, gives the same path whatever the machine is doing; this one is a safety net.
            cancel: Give up once this is cancelled. A planner that counts the nodes that it expands says how many to
                `cancel.count`, if there is one, also where it finds no path: a navigator limits their sum. The plans of
                others count by the cells of the map.

        Raises:
            PlanningError: If there is no path, never an empty path; `OutsideMapError`, `BlockedPoseError` and
                `NoPathError` say which kind, and `PlanningStoppedError` that it gave up.
        """
        ...


def planner_names() -> list[str]:
    """Names that `create_planner` takes, sorted."""
    return PLANNERS.names()


def create_planner(planner: str | Planner, **options: Any) -> Planner:
    """Make a planner from its name and options, or take one as it is.

    One whose `plan` does not take all keywords of `Planner` is wrapped, so that it can be called like any other.

    Raises:
        UnknownNameError: If there is no planner of that name.
        InputError: If it does not take these options, or is no planner.
    """
    return adapt_planner(PLANNERS.take(planner, "plan", **options))
