"""The protocol of planners, the planners by name, and the adapter that gives others the whole protocol."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.fault import wrong_result
from trundle.files.choice import Choice, split_choice
from trundle.geometry import Goal, Pose2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience
from trundle.planning.queries.query import read_ends
from trundle.registry import (
    Contract,
    PluginFunction,
    Registry,
    is_foreign,
    keywords_taken,
    name_of,
    offered_arguments,
)
from trundle.robots import Robot

_KEYWORDS = ("deadline_s", "cancel")

_SAME_PLACE_M = 1e-3
"""A path of another planner that ends so near to the goal ends there, and gets a turn in place to the goal's yaw."""
_SAME_YAW_RAD = 1e-9

PLANNERS: Registry[Planner] = Registry(
    "planner",
    "trundle.planners",
    {
        "auto": "trundle.planning.auto:AutoPlanner",
        "least_cost": "trundle.planning.grid_planners.least_cost:LeastCostPlanner",
        "astar": "trundle.planning.grid_planners.binary_planner:AStarPlanner",
        "hybrid_astar": "trundle.planning.hybrid_astar:HybridAStarPlanner",
        "any_angle": "trundle.planning.grid_planners.binary_planner:AnyAnglePlanner",
        "manhattan_astar": "trundle.planning.grid_planners.manhattan_astar:ManhattanAstarPlanner",
    },
    contract=Contract(
        {"plan": "costmap, start, goal"},
        function=("costmap", "start", "goal"),
        keywords=_KEYWORDS,
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
            deadline_s: Give up after this time [s]. If None, plan as long as it takes. A search bounded by other means,
                such as its expansions, gives the same path whatever the machine is doing; this one is a safety net.
            cancel: Give up once this is cancelled. A planner that counts the nodes that it expands says how many to
                `cancel.count`, if there is one, also where it finds no path: a navigator limits their sum. The plans of
                others count by the cells of the map.

        Raises:
            PlanningError: If there is no path, never an empty path; `OutsideMapError`, `BlockedPoseError` and
                `NoPathError` say which kind, and `PlanningStoppedError` that it gave up.
        """
        ...

    def make_quick(self) -> Planner | None:
        """Make a planner like this one that gives up sooner, or return None, as the default does.

        A `Navigator` asks once, when it is made. It then plans by that planner round what its scans saw while the robot
        moves, as there may be no path, and finding that out can take the planner itself seconds.
        """
        return None


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
    """Return names that `create_planner` takes, sorted."""
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
        options: Options of the planner, besides those of a `Choice`.

    Raises:
        UnknownNameError: If there is no planner of that name.
        InputError: If it does not take these options, needs an argument that nothing gives, takes a keyword of earlier
            versions, or is no planner.
    """
    _, given, chosen = split_choice(planner)
    made = PLANNERS.resolve(given, offered_arguments(robot, grid), {**chosen, **options})
    return PlannerAdapter(made) if isinstance(made, PluginFunction) or is_foreign(made) else made


class PlannerAdapter(Planner):
    """Hands a planner the keywords that its `plan` takes, and makes a `Path` of what it returns.

    The planner gets a `Pose2D` and a `Goal`, in whatever form they are given. Without `deadline_s` or `cancel` it
    cannot be stopped once it has begun. Poses (N, 3) or points (N, 2) that it returns become a path that also turns in
    place at the start and at the goal, where they lie there; at a goal with any yaw it does not turn.

    Args:
        planner: What plans: an object with `plan`, or a function.

    Attributes:
        planner: The object, or the function, that plans.
    """

    def __init__(self, planner: Any) -> None:
        self.planner: Any = planner.function if isinstance(planner, PluginFunction) else planner
        self._plan: Callable[..., Any] = planner if isinstance(planner, PluginFunction) else planner.plan
        self._taken = planner.taken if isinstance(planner, PluginFunction) else keywords_taken(planner.plan, _KEYWORDS)

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Goal,
        *,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`; see `Planner`.

        Raises:
            InputError: If the start or the goal is no pose, or the planner returns neither a path nor poses nor points.
        """
        start, goal = read_ends(start, goal)
        may_take_s = None if "deadline_s" in self._taken else deadline_s
        Patience(may_take_s, None if "cancel" in self._taken else cancel, "no path found yet").check()
        given: dict[str, Any] = {"deadline_s": deadline_s, "cancel": cancel}
        answer = self._plan(costmap, start, goal, **{name: given[name] for name in _KEYWORDS if name in self._taken})
        if isinstance(answer, Path):
            return answer
        return _path_of(answer, self.planner, start, goal)

    def make_quick(self) -> Planner | None:
        """Make what the planner makes as its quick one, where it has such a method; see `Planner`.

        Raises:
            InputError: If that is no planner.
        """
        make: Callable[[], PlannerLike | None] | None = getattr(self.planner, "make_quick", None)
        quick = None if make is None else make()
        return None if quick is None else create_planner(quick)


def _path_of(answer: object, planner: object, start: Pose2D, goal: Goal) -> Path:
    """Make a path of poses or points.

    Raises:
        InputError: If it is neither.
    """
    name = name_of(planner)
    try:
        poses = np.array(answer, dtype=np.float64)
    except (TypeError, ValueError):
        poses = np.zeros((0, 0))
    columns = poses.shape[-1] if poses.ndim == 2 else 0
    if columns not in (2, 3) or not len(poses) or not np.isfinite(poses).all():
        what = f"an array of shape {np.shape(poses)}" if isinstance(answer, np.ndarray) else repr(answer)[:80]
        raise wrong_result(
            f"planner {name!r} returned {what}: a planner returns a Path, or finite poses (x, y, yaw) of shape (N, 3) "
            "or points (x, y) of shape (N, 2), N ≥ 1; where there is no path it raises a PlanningError, such as "
            "NoPathError",
            planner,
            "plan",
            kind="planner",
        )
    if columns == 2:
        poses = _with_yaws(poses, start.yaw)
    ends = [start.as_tuple()] if _turns(poses[0], start) else []
    after = [goal.as_tuple()] if not goal.yaw_free and _turns(poses[-1], goal.pose) else []
    return Path(np.array([*ends, *poses.tolist(), *after]), planner=name)


def _with_yaws(points: np.ndarray, yaw: float) -> np.ndarray:
    """Return points as poses that look along the line: each corner is one pose for each of its sides."""
    poses: list[tuple[float, float, float]] = []
    for (x0, y0), (x1, y1) in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
        if (x1, y1) != (x0, y0):
            yaw = float(np.arctan2(y1 - y0, x1 - x0))
        if not poses or poses[-1] != (x0, y0, yaw):
            poses.append((x0, y0, yaw))
        poses.append((x1, y1, yaw))
    return np.array(poses or [(*points[0].tolist(), yaw)])


def _turns(pose: np.ndarray, end: Pose2D) -> bool:
    """Return whether a pose is at an end of the path, with another yaw."""
    x, y, yaw = pose.tolist()
    return end.distance_to(Pose2D(x, y)) <= _SAME_PLACE_M and abs(wrap_angle(yaw - end.yaw)) > _SAME_YAW_RAD
