"""Where a plan may start and end: the nearest place where the footprint fits, and the errors if there is none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, LETHAL, NO_INFORMATION, Costmap
from trundle.errors import BlockedPoseError, OutsideMapError
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.frame import CellArray
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.motions import CHECK_STEP_RAD

_STRAIGHT_REACH_M = 3.0
"""How far straight ahead or behind to look for room to turn, in steps of 0.1 m; farther takes more checks."""
_STRAIGHT_STEP_M = 0.1

REACH_CELLS = 256
"""How far around a blocked end to search for the nearest place where the robot fits, for the message of its error."""

MOST_POSES = 24_576
"""How many poses to try for that: about 10 ms, whatever the size of the map. All of a map of 4096² cells took 16 s."""

_CHUNK_POSES = 4096
"""Poses that are tested at once: enough to spread the cost of a call, and few where the nearest places are free."""
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
    """Find the nearest place within `tolerance_m` of a pose that can be reached and has room to turn all round.

    Raises:
        PlanningStoppedError: If patience ends.
    """
    return _nearest_place(costmap, pose, tolerance_m, _ALL_YAWS, patience, beside=start, whatever_yaw=True)


def place_to_turn(costmap: Costmap, end: End, direction: float) -> End:
    """Find the nearest place straight ahead of (1) or behind (−1) an end where the robot can turn all round.

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
    """Find the nearest place within a radius where the footprint fits with one of `yaws`, or with all of them.

    With `beside` only places count that the inscribed circle can reach from there.
    """
    rows, cols, distances = cells_near(costmap, pose, radius, INSCRIBED)
    x, y = costmap.cell_to_world(rows, cols)
    search: GridSearch | None = None
    chunk = max(1, _CHUNK_POSES // len(yaws))
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


def blocked_end(
    costmap: Costmap, pose: Pose2D, cell: tuple[int, int], what: str, tolerance_m: float, yaws: FloatArray
) -> BlockedPoseError:
    """Make the error for an end where the footprint does not fit, with the nearest place where it does.

    The number of cells and poses that are tried is limited, whatever the size of the map.

    Args:
        costmap: Where it does not fit.
        pose: Where it should.
        cell: The (row, col) of that.
        what: "start" or "goal".
        tolerance_m: How far it might have been moved [m].
        yaws: With which it may stand elsewhere [rad].
    """
    place, looked_m = find_nearest(costmap, pose, yaws)
    message = f"the {what} ({pose.x:.2f}, {pose.y:.2f}, {np.degrees(pose.yaw):.0f}°) is {_where(costmap, cell)}: "
    message += "the robot does not fit"
    if place is None:
        which = "with this yaw" if len(yaws) == 1 else "with any yaw"
        message += f", and {which} it fits nowhere within {looked_m:.2f} m of there"
    else:
        x, y, distance = place
        message += (
            f"; the nearest place where it does is {distance:.2f} m away at ({x:.2f}, {y:.2f}), and the {what} may be "
            f"moved by {tolerance_m:g} m at most"
        )
    nearest = None if place is None else place[2]
    return BlockedPoseError(message, pose=pose.as_tuple(), cell=cell, nearest_free_m=nearest)


def find_nearest(costmap: Costmap, pose: Pose2D, yaws: FloatArray) -> tuple[tuple[float, float, float] | None, float]:
    """Find the nearest centre of a cell (x, y) where the footprint fits with one of `yaws`, and its distance [m].

    Returns:
        That, and up to which distance [m] there is no other.
    """
    farthest = REACH_CELLS * costmap.resolution
    radius, beyond, left = farthest / 16.0, -1.0, MOST_POSES
    chunk = max(1, _CHUNK_POSES // len(yaws))
    while True:
        rows, cols, distances = cells_near(costmap, pose, radius, INSCRIBED, beyond=beyond)
        x, y = costmap.cell_to_world(rows, cols)
        for first in range(0, len(x), chunk):
            some = slice(first, first + min(chunk, left // len(yaws)))
            fits = np.flatnonzero(footprint_fits(costmap, x[some], y[some], yaws).any(axis=1))
            if len(fits) > 0:
                k = first + int(fits[0])
                return (float(x[k]), float(y[k]), float(distances[k])), float(distances[k])
            left -= len(x[some]) * len(yaws)
            if left < len(yaws):
                return None, float(distances[some][-1])
        if radius >= farthest:
            return None, farthest
        radius, beyond = min(farthest, 2.0 * radius), radius


def _where(costmap: Costmap, cell: tuple[int, int]) -> str:
    if costmap.keepout is not None and costmap.keepout[cell] == LETHAL:
        return "where the keep-out mask keeps the robot out"
    places = {NO_INFORMATION: "in unknown space, which blocks on this costmap", LETHAL: "in an obstacle"}
    return places.get(int(costmap.data[cell]), "too close to an obstacle or to unknown space")


def cells_near(
    costmap: Costmap, pose: Pose2D, radius: float, below: int, *, beyond: float = -1.0
) -> tuple[CellArray, CellArray, FloatArray]:
    """Return rows, cols and distances [m] of cells that cost less than `below`, nearest first.

    Args:
        costmap: Which cells.
        pose: Distances are from here to their centres.
        radius: How far they may be [m].
        below: What they cost less than.
        beyond: How far they must be at least, and a little farther [m].
    """
    reach = int(radius / costmap.resolution) + 1
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    bottom, left = max(0, row - reach), max(0, col - reach)
    window = costmap.data[bottom : row + reach + 1, left : col + reach + 1]
    rows, cols = np.nonzero(window < below)
    rows, cols = (rows + bottom).astype(np.int64), (cols + left).astype(np.int64)
    x, y = costmap.cell_to_world(rows, cols)
    distances = np.hypot(x - pose.x, y - pose.y)
    order = np.argsort(distances, kind="stable")
    order = order[(distances[order] <= radius) & (distances[order] > beyond)]
    return rows[order], cols[order], distances[order]


def footprint_fits(costmap: Costmap, x: FloatArray, y: FloatArray, yaws: FloatArray) -> npt.NDArray[np.bool_]:
    """Return whether the footprint fits at points x, y [m], shape (N,), with each of M yaws [rad], shape (N, M)."""
    poses = np.column_stack([np.repeat(x, len(yaws)), np.repeat(y, len(yaws)), np.tile(yaws, len(x))])
    return ~costmap.footprint_collides(poses).reshape(len(x), len(yaws))
