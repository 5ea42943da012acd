"""Why the robot cannot stand at one end of a plan, and where near to it it can."""

from __future__ import annotations

import numpy as np

from trundle.costmap import INSCRIBED, LETHAL, NO_INFORMATION, Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import FloatArray, Pose2D
from trundle.planning.queries.places import cells_near, footprint_fits

REACH_CELLS = 256
"""How far to search for the nearest place where the robot fits."""

MOST_POSES = 24_576
"""How many poses to try for that, about 8 ms."""

_CHUNK_POSES = 4096


def blocked_end(
    costmap: Costmap, pose: Pose2D, cell: tuple[int, int], what: str, tolerance_m: float, yaws: FloatArray
) -> BlockedPoseError:
    """The error for an end where the footprint does not fit, with the nearest place where it does.

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
    """The nearest centre of a cell (x, y) where the footprint fits with one of `yaws`, and its distance [m], if found.

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
