"""`PathCheck`: whether a path is still free on a map that changes, in microseconds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError
from trundle.geometry import FloatArray, arc_lengths, wrap_angles
from trundle.path import Path
from trundle.planning.motions import CHECK_STEP_M, CHECK_STEP_RAD, sample_between
from trundle.values import check_count

_HALF_STEP_M = 0.5 * CHECK_STEP_M


_MOST_POSES = 20_000_000
"""More poses than this are a mistake: 500 km of path."""


@dataclass(frozen=True, slots=True)
class PathHit:
    """Where a path is first blocked.

    Attributes:
        pose: (x, y, yaw) [m, m, rad], map frame: the first of the check's poses that the footprint does not reach
            without touching something.
        along: Distance driven on the path up to there [m].
        index: Index of that pose among `PathCheck.poses`.
    """

    pose: tuple[float, float, float]
    along: float
    index: int


class PathCheck:
    """A path, sampled once, to be checked with the oriented footprint on one costmap after the other.

    Between two poses of the path position and yaw change evenly, and all that the footprint sweeps over is checked, as
    planners check their motions. Legs that are clear by their costs are left out: the poses of the check are 0.025 m
    and 2° apart at most, and where the cell of each costs less than one at the circumscribed radius (and half a step)
    nothing is in reach, as costs fall with the distance. This assumes costs of an inflation, as
    `Costmap.from_grid` and `update` make them.

    Args:
        path: The path.

    Raises:
        InputError: If that is no path, or is longer than 500 km; and by the methods, if they get no costmap, or `begin`
            is no index of a pose.
    """

    def __init__(self, path: Path) -> None:
        if not isinstance(path, Path):
            raise InputError(f"a path is needed to check, got {type(path).__name__}")
        first, last = path.poses[:-1], path.poses[1:].copy()
        last[:, 2] = first[:, 2] + wrap_angles(last[:, 2] - first[:, 2])
        if len(first) == 0:
            first = last = path.poses
        change = np.abs(last - first)
        count = float(np.hypot(change[:, 0], change[:, 1]).sum()) / CHECK_STEP_M + change[:, 2].sum() / CHECK_STEP_RAD
        if count > _MOST_POSES:
            raise InputError(f"a path of {path.length:g} m is too long to be checked: it takes {count:.2g} poses")
        self._first, self._last = first, last
        self.poses, self._leg, counts = sample_between(first, last, CHECK_STEP_M, CHECK_STEP_RAD)
        self._leg_end: npt.NDArray[np.intp] = np.cumsum(counts) - 1
        self.along: FloatArray = arc_lengths(self.poses)
        self.poses.flags.writeable = False
        self.along.flags.writeable = False
        self._frame: tuple[object, ...] = ()
        self._cells: npt.NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        self._at_edge: npt.NDArray[np.bool_] = np.zeros(0, dtype=np.bool_)

    def first_hit(self, costmap: Costmap, begin: int = 0) -> PathHit | None:
        """Return where the footprint first touches something from pose `begin` on; None if the path is free."""
        begin = check_count("begin", begin, 0, len(self.poses))
        cells = self._find_cells(costmap)[begin:]
        costs = costmap.data.take(cells)
        # A pose answers for half a step on both sides.
        near = np.flatnonzero((costs >= least_cost_near(costmap, _HALF_STEP_M)) | self._at_edge[begin:])
        if len(near) == 0:
            return None
        is_near = np.zeros(len(self._first), dtype=np.bool_)
        is_near[self._leg[begin + near]] = True
        legs = np.flatnonzero(is_near)
        first = self._first[legs]
        if legs[0] == self._leg[begin]:
            first[0] = self.poses[begin]
        shares = costmap.footprint_sweeps(first, self._last[legs])
        blocked = np.flatnonzero(shares < math.inf)
        if len(blocked) == 0:
            return None
        leg, share = int(legs[blocked[0]]), float(shares[blocked[0]])
        index = self._pose_after(costmap, begin, leg, share)
        x, y, yaw = self.poses[index].tolist()
        return PathHit((x, y, yaw), float(self.along[index]), index)

    def _pose_after(self, costmap: Costmap, begin: int, leg: int, share: float) -> int:
        """Return the index of the first pose at or after a collision, from the free share of a leg."""
        last = int(self._leg_end[leg])
        first = max(begin, int(self._leg_end[leg - 1]) + 1 if leg > 0 else 0)
        # The share may be a little too small, by 0.01 mm: a hundredth of a step is more.
        before = min(last, first + int(share * (last - first) + 0.01))
        return before if costmap.footprint_collides(self.poses[before])[0] else min(last, before + 1)

    def cost_from(self, costmap: Costmap, begin: int = 0) -> float:
        """Integrate 1 + 0.016 · cost along the path from pose `begin` on [m], the weights of Nav2's NavFn.

        Infinite where base_link enters a cell of 253 or more: the same for paths of all planners, to compare them.
        """
        begin = check_count("begin", begin, 0, len(self.poses))
        cells = self._find_cells(costmap)[begin:]
        costs = costmap.data.take(cells)
        steps = np.diff(self.along[begin:])
        if len(costs) and costs.max() >= INSCRIBED:
            return math.inf
        weights = 1.0 + 0.016 * costs.astype(np.float64)  # 0.8 / 50: COST_FACTOR over COST_NEUTRAL of NavFn
        return float((0.5 * (weights[1:] + weights[:-1]) * steps).sum())

    def _find_cells(self, costmap: Costmap) -> npt.NDArray[np.intp]:
        """Return flat indices of the poses' cells, outside the map of its edge; kept for costmaps of one frame."""
        if not isinstance(costmap, Costmap):
            raise InputError(f"a path is checked on a Costmap, got {type(costmap).__name__}")
        frame = (costmap.shape, costmap.resolution, costmap.origin, costmap.circumscribed_radius)
        if frame != self._frame:
            rows, cols = costmap.shape
            row, col = costmap.world_to_cell(self.poses[:, 0], self.poses[:, 1])
            edge = math.ceil((costmap.circumscribed_radius + _HALF_STEP_M) / costmap.resolution) + 1
            self._at_edge = (row < edge) | (row >= rows - edge) | (col < edge) | (col >= cols - edge)
            self._cells = np.clip(row, 0, rows - 1) * cols + np.clip(col, 0, cols - 1)
            self._frame = frame
        return self._cells


def least_cost_near(costmap: Costmap, padding: float = 0.0) -> int:
    """Return the least cost of a cell from which the footprint may reach what is blocked; 0 where that cannot be said.

    `padding` [m] widens the footprint.
    """
    # Distances go from centre to centre: half a cell's diagonal to the pose, and half of one to the blocked edge.
    reach = costmap.circumscribed_radius + padding + math.sqrt(2.0) * costmap.resolution + 1e-6
    if reach > costmap.inflation_radius:
        return 0
    return int((INSCRIBED - 1) * math.exp(-costmap.cost_scaling_factor * (reach - costmap.inscribed_radius)))
