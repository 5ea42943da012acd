"""`PlannerAdapter`: gives a planner of another package, or a function, the whole protocol of `Planner`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.fault import wrong_result
from trundle.geometry import Goal, Pose2D, wrap_angle
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience
from trundle.planning.queries.question import read_ends
from trundle.registry import PluginFunction, keywords_taken, name_of

KEYWORDS = ("deadline_s", "cancel")
_SAME_PLACE_M = 1e-3
_SAME_YAW_RAD = 1e-9


class PlannerAdapter:
    """Hands a planner the keywords that its `plan` takes, and makes a `Path` of what it returns.

    The planner gets a `Pose2D` and a `Goal`, in whatever form they are given. Without `deadline_s` or `cancel` it
    cannot be stopped once it has begun. Poses (N, 3) or points (N, 2) that it returns become a path that also turns in
    place at the start and at the goal, where they lie there; at a goal with any yaw it does not turn.

    Args:
        planner: What plans: an object with `plan`, or a function.

    Attributes:
        planner: The same; of a function, the function itself.
    """

    def __init__(self, planner: Any) -> None:
        self.planner: Any = planner.function if isinstance(planner, PluginFunction) else planner
        self._plan: Callable[..., Any] = planner if isinstance(planner, PluginFunction) else planner.plan
        self._taken = planner.taken if isinstance(planner, PluginFunction) else keywords_taken(planner.plan, KEYWORDS)

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
            InputError: If the start or the goal is none, or the planner returns neither a path nor poses nor points.
        """
        start, goal = read_ends(start, goal)
        may_take_s = None if "deadline_s" in self._taken else deadline_s
        Patience(may_take_s, None if "cancel" in self._taken else cancel, "no path found yet").check()
        given: dict[str, Any] = {"deadline_s": deadline_s, "cancel": cancel}
        answer = self._plan(costmap, start, goal, **{name: given[name] for name in KEYWORDS if name in self._taken})
        if isinstance(answer, Path):
            return answer
        return _path_of(answer, self.planner, start, goal)


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
    """Points as poses that look along the line: each corner is one pose for each of its sides."""
    poses: list[tuple[float, float, float]] = []
    for (x0, y0), (x1, y1) in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
        if (x1, y1) != (x0, y0):
            yaw = float(np.arctan2(y1 - y0, x1 - x0))
        if not poses or poses[-1] != (x0, y0, yaw):
            poses.append((x0, y0, yaw))
        poses.append((x1, y1, yaw))
    return np.array(poses or [(*points[0].tolist(), yaw)])


def _turns(pose: np.ndarray, end: Pose2D) -> bool:
    """Whether a pose is at an end of the path, with another yaw."""
    x, y, yaw = pose.tolist()
    return end.distance_to(Pose2D(x, y)) <= _SAME_PLACE_M and abs(wrap_angle(yaw - end.yaw)) > _SAME_YAW_RAD
