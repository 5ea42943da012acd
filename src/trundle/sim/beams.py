"""Level lidar beams in a world: computed with NumPy as the reference, and fast with the compiled kernels."""

from __future__ import annotations

import numpy as np

from trundle._core import cast_grid_rays, cast_outline_rays
from trundle.geometry import FloatArray, Pose2D
from trundle.sim.footprint import CellField
from trundle.sim.sections import Disc, outline_segments, slab_section
from trundle.solids import Cylinder, OccupancyCells, Sphere
from trundle.worlds import World


class WorldOutline:
    """A world cut at one height: segments, circles and blocked cells.

    Args:
        world: The world to cut.
        height: Height of the cut above the floor [m].
    """

    def __init__(self, world: World, height: float) -> None:
        segments: list[FloatArray] = [np.empty((0, 4))]
        discs: list[tuple[float, float, float]] = []
        self._fields: list[CellField] = []
        for solid in world.solids:
            shape = solid.shape
            if isinstance(shape, OccupancyCells):
                base = solid.pose.position[2]
                if base <= height <= base + shape.height:
                    self._fields.append(CellField.of(solid, shape))
            elif isinstance(shape, Sphere) or (isinstance(shape, Cylinder) and solid.pose.is_upright()):
                section = slab_section(solid, height, height)
                if isinstance(section, Disc):
                    discs.append((section.x, section.y, section.radius))
            else:
                segments.append(outline_segments(solid, height))
        self._segments = np.vstack(segments)
        self._discs = np.array(discs).reshape(-1, 3)

    @property
    def segments(self) -> FloatArray:
        """Straight edges (x0, y0, x1, y1) [m], shape (S, 4)."""
        return self._segments

    @property
    def discs(self) -> FloatArray:
        """Circles (x, y, radius) [m], shape (D, 3)."""
        return self._discs

    def cast_quickly(self, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
        """Same as `cast`, with the compiled kernels; `angles` are evenly spaced and ascending."""
        count = len(angles)
        step = float(angles[-1] - angles[0]) / (count - 1) if count > 1 else 1.0
        distances = cast_outline_rays(self._segments, self._discs, x, y, float(angles[0]), step, count, reach)
        for field in self._fields:
            inverse, scale = field.frame.inverse(), field.resolution
            local = inverse @ Pose2D(x, y)
            cells = field.blocked.view(np.uint8)
            hits = cast_grid_rays(cells, local.x / scale, local.y / scale, angles + inverse.yaw, reach / scale)
            np.minimum(distances, hits * scale, out=distances)
        return distances

    def cast(self, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
        """Distances [m] from (x, y) along `angles` [rad] to the nearest outline, infinity beyond `reach` [m].

        A beam that starts inside a solid meets its outline from within; one that starts in a blocked cell reads 0.
        """
        directions = np.c_[np.cos(angles), np.sin(angles)]
        distances = np.full(len(angles), np.inf)
        for hits in (self._cast_segments(x, y, directions, reach), self._cast_discs(x, y, directions, reach)):
            if hits.size:
                np.minimum(distances, hits.min(axis=1), out=distances)
        for field in self._fields:
            np.minimum(distances, cast_cells(field, x, y, angles, reach), out=distances)
        return np.where(distances <= reach, distances, np.inf)

    def _cast_segments(self, x: float, y: float, directions: FloatArray, reach: float) -> FloatArray:
        start, end = self._segments[:, :2] - (x, y), self._segments[:, 2:] - (x, y)
        along = end - start
        length = np.maximum(np.einsum("nd,nd->n", along, along), 1e-300)
        nearest = start + np.clip(-np.einsum("nd,nd->n", start, along) / length, 0.0, 1.0)[:, None] * along
        near = np.einsum("nd,nd->n", nearest, nearest) <= reach * reach
        start, along = start[near], along[near]
        across = directions[:, 0, None] * along[:, 1] - directions[:, 1, None] * along[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / across
            fraction = (start[:, 0] * directions[:, 1, None] - start[:, 1] * directions[:, 0, None]) / across
        # A beam through a corner must not slip between the two edges that meet there.
        hit = (across != 0.0) & (distance >= 0.0) & (fraction >= -1e-12) & (fraction <= 1.0 + 1e-12)
        return np.where(hit, distance, np.inf)

    def _cast_discs(self, x: float, y: float, directions: FloatArray, reach: float) -> FloatArray:
        offset = self._discs[:, :2] - (x, y)
        near = np.hypot(offset[:, 0], offset[:, 1]) - self._discs[:, 2] <= reach
        offset, radius = offset[near], self._discs[near, 2]
        along = directions @ offset.T
        inside = radius**2 - (offset**2).sum(axis=1)
        root = along**2 + inside
        half = np.sqrt(np.maximum(root, 0.0))
        distance = np.where(inside > 0.0, along + half, along - half)
        return np.where((root >= 0.0) & (distance >= 0.0), distance, np.inf)


def cast_cells(field: CellField, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
    """Distances [m] along beams to the first blocked cell, infinity beyond `reach`; all beams step cell by cell.

    Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987).
    """
    inverse = field.frame.inverse()
    local = inverse @ Pose2D(x, y)
    scale = field.resolution
    turned = angles + inverse.yaw
    direction = np.stack([np.cos(turned), np.sin(turned)])
    origin = np.array([[local.x / scale], [local.y / scale]])
    cell = np.repeat(np.floor(origin), len(angles), axis=1).astype(np.int64)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        spacing = np.where(direction != 0.0, 1.0 / np.abs(direction), np.inf)
        following = np.where(direction != 0.0, (cell + (direction > 0.0) - origin) / direction, np.inf)
    step = np.where(direction > 0.0, 1, -1)
    rows, cols = field.blocked.shape
    travelled = np.zeros(len(angles))
    distances = np.full(len(angles), np.inf)
    beams = np.arange(len(angles))
    while len(beams):
        col, row = cell[:, beams]
        inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
        hit = np.zeros(len(beams), dtype=bool)
        hit[inside] = field.blocked[row[inside], col[inside]]
        distances[beams[hit]] = travelled[beams[hit]] * scale
        beams = beams[~hit & (travelled[beams] * scale <= reach)]
        axis = (following[0, beams] >= following[1, beams]).astype(np.int64)
        travelled[beams] = following[axis, beams]
        cell[axis, beams] += step[axis, beams]
        following[axis, beams] += spacing[axis, beams]
    return np.where(distances <= reach, distances, np.inf)
