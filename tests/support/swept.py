"""What a footprint sweeps over on its way, by shapely."""

from __future__ import annotations

import math

import numpy as np
import shapely

from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.path import Path


def densely(path: Path, step: float = 0.01) -> FloatArray:
    """Poses along the straight lines and turns that a path stands for, so many metres and 0.01 rad apart at most."""
    pieces = [path.poses[:1]]
    for a, b in zip(path.poses[:-1], path.poses[1:], strict=True):
        change = np.array([b[0] - a[0], b[1] - a[1], math.remainder(b[2] - a[2], 2 * math.pi)])
        count = 1 + int(max(math.hypot(*change[:2]) / step, abs(change[2]) / 0.01))
        pieces.append(a + np.linspace(0, 1, count + 1)[1:, None] * change)
    return np.concatenate(pieces)


def penalised_length(path: Path, *, reverse: float, change: float, turn: float) -> float:
    """Length [m] of a path along its arcs, dearer backwards, with a price for each change and each radian in place."""
    steps = np.diff(path.poses, axis=0)
    turns = np.abs(np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi)
    chords = np.hypot(steps[:, 0], steps[:, 1])
    moving = chords > 1e-6
    arcs = chords / np.sinc(turns / 2 / np.pi)
    backward = path.backward & moving
    total = arcs[moving & ~backward].sum() + reverse * arcs[backward].sum() + turn * turns[~moving].sum()
    # A turn in place between two stretches parts them: no change is counted there.
    changes = (moving[:-1] & moving[1:] & (backward[:-1] != backward[1:])).sum()
    return float(total + change * changes)


def swept_area_blocked(costmap: Costmap, path: Path, outline: FloatArray | None = None) -> float:
    """Area [m²] of blocked cells that an outline sweeps over: hulls of neighbouring placements, by shapely."""
    poses = densely(path, math.inf)  # the hull of what only moves is what it sweeps
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    corners = costmap.footprint if outline is None else outline
    placed = np.stack(
        [
            poses[:, :1] + cos[:, None] * corners[:, 0] - sin[:, None] * corners[:, 1],
            poses[:, 1:2] + sin[:, None] * corners[:, 0] + cos[:, None] * corners[:, 1],
        ],
        axis=2,
    )
    both = np.concatenate([placed[:-1], placed[1:]], axis=1)
    swept = shapely.union_all(shapely.convex_hull(shapely.multipoints(both)))
    rows, cols = np.nonzero(costmap.data >= 254)
    edges = [
        costmap.origin.transform_points(costmap.resolution * np.column_stack([cols + dx, rows + dy]))
        for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    shapely.prepare(swept)
    cells = shapely.polygons(np.stack(edges, axis=1))
    met = cells[shapely.intersects(swept, cells)]
    return float(shapely.area(shapely.intersection(met, swept)).sum())
