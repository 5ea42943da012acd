"""The protocol of planners, and the planners by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.files.choice import Choice, split_choice
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning.cancellation import Cancellation
from trundle.planning.planner_adapter import KEYWORDS, PlannerAdapter
from trundle.registry import Contract, PluginFunction, Registry, is_foreign, offered_arguments
from trundle.robots import Robot

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
    contract=Contract(
        {"plan": "costmap, start, goal"},
        function=("costmap", "start", "goal"),
        keywords=KEYWORDS,
        former={
            "goal_yaw_free": "its goal is a trundle.geometry.Goal now, and goal.yaw_free says whether any yaw will do; "
            "write plan(costmap, start, goal, *, deadline_s=None, cancel=None)"
        },
    ),
)


@runtime_checkable
class Planner(Protocol):
    """Finds a path. It keeps no state that changes a result: the same query gives the same path.

    A planner of another package whose `plan` takes fewer of the keywords, or returns poses or points, works as well:
    see `PlannerLike`. It gets a `Goal`, which it can read like a pose: `goal.x`, `goal.y`, `goal.yaw` (0 where any will
    do), `goal.as_tuple()` and `goal.distance_to`; `goal.pose` is a `Pose2D`.
    """

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Goal,
        *,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`, in the map frame.

        Args:
            costmap: What to stay clear of.
            start: Where the robot stands.
            goal: Where it is to stand, with a yaw or with any (`Goal.yaw_free`). Planners of `create_planner` also take
                (x, y) for any yaw, (x, y, yaw) or a pose, whose yaw is wanted then.
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


class SomePlanner(Protocol):
    """The least that an object needs to be used as a planner; `create_planner` makes a `Planner` of it."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Goal, /) -> Path | npt.ArrayLike:
        """Return a path, or poses (x, y, yaw) of shape (N, 3), or points (x, y) of shape (N, 2)."""
        ...


PlannerLike: TypeAlias = str | Choice | SomePlanner | Callable[..., object]
"""Whatever plans: a name, `"module:name"`, an object with `plan`, a class of such objects, or a function
(costmap, start, goal). Of the keywords of `Planner.plan` each is handed on where it is taken. What is returned is a
path, or poses of shape (N, 3), or points of shape (N, 2), which get yaws along the line and turns in place at the ends.
A class is made with those of `robot`, `map` and the options that its parameters name."""


def planner_names() -> list[str]:
    """Names that `create_planner` takes, sorted."""
    return PLANNERS.names()


def create_planner(
    planner: PlannerLike, robot: Robot | None = None, grid: OccupancyGrid | None = None, **options: Any
) -> Planner:
    """Make a planner of whatever plans.

    One of another package is wrapped, so that it can be called like any other and always returns a `Path`.

    Args:
        planner: A name, a class, a function or an object; see `PlannerLike`.
        robot: What a class gets as `robot`, where it is known.
        grid: What a class gets as `map`, where there is one.
        options: Of the planner; more than those of a `Choice`.

    Raises:
        UnknownNameError: If there is no planner of that name.
        InputError: If it does not take these options, needs an argument that nothing gives, takes a keyword of earlier
            versions, or is no planner.
    """
    _, given, chosen = split_choice(planner)
    made = PLANNERS.resolve(given, offered_arguments(robot, grid), {**chosen, **options})
    return PlannerAdapter(made) if isinstance(made, PluginFunction) or is_foreign(made) else made
