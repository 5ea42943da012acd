"""Where a plan may start and end: snapping to the nearest place where the footprint fits, and the errors if none is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import BlockedPoseError, OutsideMapError
from trundle.geometry import FloatArray, Pose2D
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.motions import CHECK_STEP_RAD
from trundle.planning.queries.blocked_end import blocked_end
from trundle.planning.queries.places import cells_near, footprint_fits

_STRAIGHT_REACH_M = 3.0
_STRAIGHT_STEP_M = 0.1
_ALL_YAWS = np.arange(0.0, 2.0 * np.pi, CHECK_STEP_RAD)


@dataclass(frozen=True, slots=True)
class End:
    """One end of a plan.

    Attributes:
        pose: Where the robot stands there.
        cell: Its (row, col); it costs less than 253.
        snapped_m: How far it was moved to free space [m].
    """

    pose: Pose2D
    cell: tuple[int, int]
    snapped_m: float = 0.0


def find_end(
    costmap: Costmap,
    pose: Pose2D,
    what: str,
    tolerance_m: float,
    *,
    any_yaw: bool = False,
    beside: End | None = None,
    patience: Patience | None = None,
) -> End:
    """Find where the robot can stand at, or within `tolerance_m` of, a pose.

    Args:
        costmap: Where it stands.
        pose: Where it should stand, map frame.
        what: "start" or "goal", for the message.
        tolerance_m: How far it may be moved [m].
        any_yaw: Leave the yaw open: the inscribed circle has to fit, or where the pose is moved the footprint with any.
        beside: Where the robot comes from: places that its inscribed circle can reach from there are preferred.
        patience: When to give up looking for a place.

    Raises:
        OutsideMapError: If the pose lies outside the map.
        BlockedPoseError: If the footprint does not fit within the tolerance.
        PlanningStoppedError: If patience ends.
    """
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if not costmap.contains(row, col):
        rows, cols = costmap.shape
        raise OutsideMapError(
            f"the {what} ({pose.x:.2f}, {pose.y:.2f}) lies outside the map of {cols * costmap.resolution:g} x "
            f"{rows * costmap.resolution:g} m with its corner at ({costmap.origin.x:g}, {costmap.origin.y:g})",
            pose=pose.as_tuple(),
            cell=(row, col),
        )
    # Where the inscribed circle is free, the centres of cells are at least as far apart: a footprint that fits is in a
    # cell of less than 253, but for one that touches within rounding.
    if costmap.data[row, col] < INSCRIBED and (any_yaw or not costmap.footprint_collides([pose.as_tuple()])[0]):
        return End(pose, (row, col))
    _check_size(costmap, pose, (row, col), what)
    yaws = _ALL_YAWS if any_yaw else np.array([pose.yaw])
    found = None if beside is None else _nearest_place(costmap, pose, tolerance_m, yaws, patience, beside=beside)
    if found is not None:
        return found
    found = _nearest_place(costmap, pose, tolerance_m, yaws, patience)
    if found is not None:
        return found
    raise blocked_end(costmap, pose, (row, col), what, tolerance_m, yaws)


def place_with_room(costmap: Costmap, pose: Pose2D, tolerance_m: float, start: End, patience: Patience) -> End | None:
    """The nearest place within `tolerance_m` of a pose that can be reached, and where the robot can turn all round.

    Raises:
        PlanningStoppedError: If patience ends.
    """
    return _nearest_place(costmap, pose, tolerance_m, _ALL_YAWS, patience, beside=start, whatever_yaw=True)


def place_to_turn(costmap: Costmap, end: End, direction: float) -> End:
    """The nearest place straight ahead of (1) or behind (−1) an end where the robot can turn all round.

    The robot can drive straight between the two. It is the end itself where it can turn there, and where there is no
    such place within 3 m.
    """
    pose = end.pose
    distances = np.arange(0.0, _STRAIGHT_REACH_M, _STRAIGHT_STEP_M)
    x = pose.x + direction * distances * np.cos(pose.yaw)
    y = pose.y + direction * distances * np.sin(pose.yaw)
    straight = np.column_stack([x, y, np.full(len(x), pose.yaw)])
    blocked = costmap.cost_at(x, y) >= INSCRIBED
    blocked |= costmap.footprint_sweeps(np.repeat(straight[:1], len(x), axis=0), straight) < np.inf
    reachable = int(np.argmax(blocked)) if blocked.any() else len(x)
    for k in range(reachable):
        if costmap.footprint_sweeps(straight[k], straight[k] + (0.0, 0.0, 2.0 * np.pi))[0] < np.inf:
            continue
        if k == 0:
            break
        row, col = costmap.world_to_cell(x[k], y[k])
        return End(Pose2D(float(x[k]), float(y[k]), pose.yaw), (int(row), int(col)), end.snapped_m)
    return end


def _check_size(costmap: Costmap, pose: Pose2D, cell: tuple[int, int], what: str) -> None:
    """Raise `BlockedPoseError` if not even the robot's inscribed circle has room between the map's edges."""
    rows, cols = costmap.shape
    map_height, map_width = rows * costmap.resolution, cols * costmap.resolution
    if 2.0 * costmap.inscribed_radius <= min(map_height, map_width):
        return
    length, width = costmap.planar.size
    raise BlockedPoseError(
        f"the robot fits nowhere on the map, nor at the {what} ({pose.x:.2f}, {pose.y:.2f}): its footprint of "
        f"{length:.2f} x {width:.2f} m is larger than the map of {map_width:g} x {map_height:g} m; check the units of "
        "the footprint and the map's resolution",
        pose=pose.as_tuple(),
        cell=cell,
    )


def _nearest_place(
    costmap: Costmap,
    pose: Pose2D,
    radius: float,
    yaws: FloatArray,
    patience: Patience | None,
    *,
    beside: End | None = None,
    whatever_yaw: bool = False,
) -> End | None:
    """The nearest place within a radius where the footprint fits with one of `yaws`, or with all of them.

    With `beside` only places count that the inscribed circle can reach from there.
    """
    rows, cols, distances = cells_near(costmap, pose, radius, INSCRIBED)
    x, y = costmap.cell_to_world(rows, cols)
    search: GridSearch | None = None
    chunk = max(1, 4096 // len(yaws))
    for first in range(0, len(rows), chunk):
        if patience is not None:
            patience.check()
        some = slice(first, first + chunk)
        fits = footprint_fits(costmap, x[some], y[some], yaws)
        for k in (first + np.flatnonzero(fits.all(axis=1) if whatever_yaw else fits.any(axis=1))).tolist():
            cell = (int(rows[k]), int(cols[k]))
            if beside is not None:
                search = search or GridSearch(costmap.data >= INSCRIBED, method="astar")
                if search.nearest_reachable(beside.cell, cell) != cell:
                    continue
            return End(Pose2D(x[k], y[k], pose.yaw), cell, float(distances[k]))
    return None
