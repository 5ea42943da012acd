"""The check that every planner must pass."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np

from trundle.costmap import LETHAL, Costmap
from trundle.errors import (
    BlockedPoseError,
    InputError,
    NoPathError,
    OutsideMapError,
    PlanningError,
    PlanningStoppedError,
)
from trundle.geometry import Goal, Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning import Cancellation, Planner, create_planner
from trundle.planning.planner import PlannerLike
from trundle.robots import Robot
from trundle.testing.conformance import ConformanceError, accept, expect

_FOOTPRINT = np.array([[0.15, 0.15], [-0.25, 0.15], [-0.25, -0.15], [0.15, -0.15]])
_RESOLUTION = 0.1
_NEAR = 1e-6
_LONG_S, _SHORT_S = 3600.0, 1e-9


def check_planner(planner: PlannerLike, *, robot: Robot | None = None) -> None:
    """Check that a planner meets the contract of `Planner`.

    On a small map of two rooms and a closed chamber, with goals with a yaw and with any: a path starts at the start and
    ends at the goal, is finite and never goes through occupied or unknown cells; the same query gives the same path,
    repeated and in a second planner; the costmap is not modified; a goal outside the map, in an obstacle, in unknown
    space or unreachable raises a typed error and never returns an empty path. Those keywords of the interface that
    `plan` takes do what they say: a deadline that is not reached changes nothing, and one that has passed gives a
    `PlanningStoppedError` or the same path; a query that is cancelled already raises it. A planner that counts by
    `cancel.count` counts one node or more in each plan. What its `make_quick` returns, if it has that, is None or a
    planner: its paths meet the same requirements, but it may give up where there is a path.

    Args:
        planner: A planner in any of the ways of `PlannerLike`, or a function that makes one.
        robot: What a class of planners gets as `robot`; Nova Carter by default.

    Raises:
        ConformanceError: At the first requirement that is not met; the message says which.
    """
    grid, driven = _two_rooms(), Robot.load("nova_carter") if robot is None else robot
    costmap = Costmap.from_grid(grid, _FOOTPRINT)
    before = costmap.data.copy()

    def make() -> Planner:
        return accept(lambda given: create_planner(cast("PlannerLike", given), driven, grid), planner)

    instance = make()
    for start, goal in (*_QUESTIONS, *((start, Goal(goal.x, goal.y)) for start, goal in _QUESTIONS)):
        path = _plan(instance, costmap, start, goal)
        _check_path(path, costmap, start, goal)
        _check_same(path, _plan(instance, costmap, start, goal), "the same query twice gives two different paths")
        _check_same(path, _plan(make(), costmap, start, goal), "two planners of the same kind give different paths")
        _check_keywords(instance, costmap, start, goal, path)
    _check_quick(instance, costmap)
    for start, goal, kinds, what in _REFUSALS:
        _check_refusal(instance, costmap, start, goal, kinds, what)
    start, goal = _QUESTIONS[0]
    _check_same(
        _plan(make(), costmap, start, goal),
        _plan(instance, costmap, start, goal),
        "after rejected queries it gives another path",
    )
    expect((costmap.data == before).all(), "planning must not change the costmap")


_QUESTIONS = (
    (Pose2D(1.0, 1.0, 0.0), Goal(8.0, 1.0, math.pi / 2)),
    (Pose2D(1.0, 1.0, 1.0), Goal(2.0, 4.5, -3.0)),
    (Pose2D(8.53, 4.47, 3.0), Goal(1.01, 1.52, 0.3)),
    (Pose2D(2.0, 2.0, 0.0), Goal(2.0, 2.0, 2.0)),
    (Pose2D(2.0, 2.0, 0.5), Goal(2.0, 2.0, 0.5)),
)
_START = Pose2D(1.0, 1.0, 0.0)
_REFUSALS: tuple[tuple[Pose2D, Goal, tuple[type[PlanningError], ...], str], ...] = (
    (_START, Goal(50.0, 1.0, 0.0), (OutsideMapError,), "a goal outside the map"),
    (Pose2D(1.0, -3.0), Goal.of(_START), (OutsideMapError,), "a start outside the map"),
    (_START, Goal(6.0, 4.0, 0.0), (BlockedPoseError,), "a goal deep in an obstacle"),
    (Pose2D(6.0, 4.0), Goal.of(_START), (BlockedPoseError,), "a start deep in an obstacle"),
    (_START, Goal(11.0, 3.0), (BlockedPoseError,), "a goal deep in unknown space"),
    (_START, Goal(13.5, 3.0), (NoPathError, BlockedPoseError), "a goal in a closed chamber"),
)


def _two_rooms() -> OccupancyGrid:
    """15 × 6 m: two rooms with a door of 1.2 m, a block in the right one, then unknown space, then a closed chamber."""
    data = np.zeros((60, 150), np.int8)
    data[[0, -1], :] = 100
    data[:, [0, 45, 99, 149]] = 100
    data[14:26, 45] = 0
    data[30:50, 50:70] = 100
    data[:, 100:120] = -1
    data[:, 120] = 100
    return OccupancyGrid(data, _RESOLUTION)


def _plan(planner: Planner, costmap: Costmap, start: Pose2D, goal: Goal, **keywords: Any) -> Path:
    try:
        return planner.plan(costmap, start, goal, **keywords)
    except PlanningError as error:
        raise ConformanceError(f"no path from {start} to {goal}, although there is one: {error}") from error
    except InputError as error:
        raise ConformanceError(str(error)) from error


def _check_keywords(planner: Planner, costmap: Costmap, start: Pose2D, goal: Goal, path: Path) -> None:
    """Check `deadline_s` and `cancel` with a query whose `path` is known."""
    count = Cancellation()
    patient = _plan(planner, costmap, start, goal, deadline_s=_LONG_S, cancel=count)
    _check_same(path, patient, "a deadline that is far off changes the path")
    expect(
        count.expansions is None or count.expansions > 0,
        f"a planner counts the nodes that it expands, one or more in each plan; it counted {count.expansions}",
    )
    try:
        hasty = planner.plan(costmap, start, goal, deadline_s=_SHORT_S)
    except PlanningStoppedError as error:
        expect(
            error.status == "timeout",
            f"after the deadline the error's status must be 'timeout', not {error.status!r}",
        )
    else:
        _check_same(path, hasty, "a deadline that has passed changes the path")
    cancel = Cancellation()
    cancel.cancel()
    try:
        planner.plan(costmap, start, goal, cancel=cancel)
    except PlanningStoppedError as error:
        expect(error.status == "cancelled", f"a cancelled query must have the status 'cancelled', not {error.status!r}")
    else:
        raise ConformanceError("an already cancelled query must raise PlanningStoppedError, but it returned a path")


def _check_quick(planner: Planner, costmap: Costmap) -> None:
    """Check `make_quick`: its planner finds a path that conforms, or gives up."""
    quick = accept(lambda _: planner.make_quick(), planner)
    if quick is None:
        return
    start, goal = _QUESTIONS[0]
    try:
        path = quick.plan(costmap, start, goal)
    except PlanningStoppedError:
        return
    except PlanningError as error:
        raise ConformanceError(
            "the planner of make_quick may give up by a PlanningStoppedError, but must not say that there is no path "
            f"where there is one: {error}"
        ) from error
    _check_path(path, costmap, start, goal)


def _check_path(path: Path, costmap: Costmap, start: Pose2D, goal: Goal) -> None:
    where = f"path from {start} to {goal}"
    expect(len(path) >= 1, f"{where}: it is empty")
    expect(bool(np.isfinite(path.poses).all()), f"{where}: its poses are not finite")
    for what, pose, wanted in (("start", path.start, start), ("end", path.goal, goal)):
        expect(pose.distance_to(wanted) <= _NEAR, f"{where}: it must {what} at {wanted}, not at {pose}")
        turn = abs(math.remainder(pose.yaw - wanted.yaw, 2.0 * math.pi))
        is_turned = turn <= _NEAR or (wanted is goal and goal.yaw_free)
        expect(is_turned, f"{where}: it must {what} with a yaw of {wanted.yaw:.4f}, not {pose.yaw:.4f}")
    expect(path.length >= start.distance_to(goal) - _NEAR, f"{where}: it is shorter than the straight line")
    costs = costmap.cost_at(*_densified(path))
    expect(bool((costs < LETHAL).all()), f"{where}: it goes through occupied or unknown cells")


def _densified(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return points x, y [m] along the straight lines between poses, a fifth of a cell apart."""
    pieces = [
        np.linspace(a[:2], b[:2], 2 + int(math.dist(a[:2], b[:2]) / (_RESOLUTION / 5.0)))
        for a, b in zip(path.poses[:-1], path.poses[1:], strict=True)
    ]
    points = np.concatenate([path.poses[:1, :2], *pieces])
    return points[:, 0], points[:, 1]


def _check_same(path: Path, other: Path, message: str) -> None:
    expect(np.array_equal(path.poses, other.poses), message)


def _check_refusal(
    planner: Planner,
    costmap: Costmap,
    start: Pose2D,
    goal: Goal,
    kinds: tuple[type[PlanningError], ...],
    what: str,
) -> None:
    names = " or ".join(kind.__name__ for kind in kinds)
    try:
        planner.plan(costmap, start, goal)
    except kinds as error:
        expect(len(str(error)) > 0, f"{what}: the {names} has no message")
    except Exception as error:
        raise ConformanceError(f"{what} must raise {names}, not {type(error).__name__}: {error}") from error
    else:
        raise ConformanceError(f"{what} must raise {names}, but it returned a path")
