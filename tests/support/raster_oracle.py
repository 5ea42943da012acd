"""The oracle for the raster of single solids: each solid cut by an independent method, cells by shapely.

shapely tells which cells, made smaller by 1 µm, a solid's part in the band meets from above. Cells within 1 nm of that
decision are left out and counted (for tilted cylinders: those between a prism inside and one outside of the cylinder).
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import shapely

from trundle.geometry import Pose3D
from trundle.geometry.solids import Cylinder, Solid
from trundle.maps.rasterise import DEPTH, HeightBand, SolidRaster

RESOLUTION = 0.05
ORIGIN = (-1.013, -0.987)
SHAPE = (40, 44)
BAND = HeightBand(0.1, 0.62)
CLOSE = 1e-9


def raster(solids: list[Solid], *, centre: bool = False) -> np.ndarray:
    cells = np.full(SHAPE, -1, dtype=np.int8)
    SolidRaster(cells, RESOLUTION, ORIGIN, BAND, centre=centre).add(solids)
    assert set(np.unique(cells)) <= {-1, 100}
    return cells == 100


def cell_boxes(shrink: float) -> np.ndarray:
    rows, cols = np.indices(SHAPE)
    x, y = ORIGIN[0] + cols * RESOLUTION, ORIGIN[1] + rows * RESOLUTION
    return shapely.box(x + shrink, y + shrink, x + RESOLUTION - shrink, y + RESOLUTION - shrink)


def reached(shape: shapely.Geometry, shrink: float) -> np.ndarray:
    shapely.prepare(shape)
    return shapely.intersects(shape, cell_boxes(shrink))


def check(cells: np.ndarray, inside: shapely.Geometry, outside: shapely.Geometry | None = None) -> int:
    """Compare with a shape, or with one inside and one outside of the true one; return how many cells are left out."""
    surely = reached(inside, DEPTH + CLOSE)
    maybe = reached(inside if outside is None else outside, DEPTH - CLOSE)
    assert not (surely & ~cells).any(), f"missed {np.argwhere(surely & ~cells)}"
    assert not (cells & ~maybe).any(), f"extra {np.argwhere(cells & ~maybe)}"
    return int((maybe & ~surely).sum())


def cut_hull(points: np.ndarray, pairs: Iterable[tuple[int, int]] | np.ndarray) -> shapely.Geometry:
    """Seen from above, the part of a convex body in the band, from its corners and (at least) its edges."""
    low, high = BAND.low + DEPTH, BAND.high - DEPTH
    kept = [points[(points[:, 2] >= low) & (points[:, 2] <= high)][:, :2]]
    a, b = points[[i for i, _ in pairs]], points[[j for _, j in pairs]]
    for height in (low, high):
        crossing = (a[:, 2] - height) * (b[:, 2] - height) < 0
        share = ((height - a[:, 2]) / np.where(crossing, b[:, 2] - a[:, 2], 1.0))[:, None]
        kept.append((a + share * (b - a))[crossing, :2])
    return shapely.MultiPoint(np.concatenate(kept)).convex_hull


def random_pose(generator: np.random.Generator, *, upright: bool = False) -> Pose3D:
    x, y = generator.uniform(-1.0, 1.0, 2)
    z = generator.uniform(-0.3, 1.0)
    if upright:
        return Pose3D.planar(x, y, z, generator.uniform(-4.0, 4.0))
    return Pose3D((x, y, z), tuple(generator.normal(size=4)))


def prism(cylinder: Cylinder, pose: Pose3D, corners: int, scale: float) -> shapely.Geometry:
    """Seen from above, the part in the band of a prism of so many sides, its corners `scale` times as far out."""
    angles = np.arange(corners) * 2 * math.pi / corners
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(corners)], axis=1) * cylinder.radius * scale
    half = np.array([0.0, 0.0, cylinder.length / 2])
    points = pose.transform_points(np.concatenate([ring - half, ring + half]))
    following = np.roll(np.arange(corners), -1)
    ring_pairs = np.stack([np.arange(corners), following], axis=1)
    sides = np.stack([np.arange(corners), np.arange(corners) + corners], axis=1)
    return cut_hull(points, np.concatenate([ring_pairs, ring_pairs + corners, sides]))
