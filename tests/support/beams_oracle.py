"""Lidar beams in NumPy: the oracle of the kernels."""

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.sim.beams import WorldOutline
from trundle.sim.footprint import CellField


def cast_slowly(outline: WorldOutline, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
    """Distances [m] as of `WorldOutline.cast`, for any angles."""
    directions = np.c_[np.cos(angles), np.sin(angles)]
    distances = np.full(len(angles), np.inf)
    for hits in (_cast_segments(outline, x, y, directions, reach), _cast_discs(outline, x, y, directions, reach)):
        if hits.size:
            np.minimum(distances, hits.min(axis=1), out=distances)
    for field in outline.fields:
        np.minimum(distances, cast_cells(field, x, y, angles, reach), out=distances)
    return np.where(distances <= reach, distances, np.inf)


def _cast_segments(outline: WorldOutline, x: float, y: float, directions: FloatArray, reach: float) -> FloatArray:
    start, end = outline.segments[:, :2] - (x, y), outline.segments[:, 2:] - (x, y)
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


def _cast_discs(outline: WorldOutline, x: float, y: float, directions: FloatArray, reach: float) -> FloatArray:
    offset = outline.discs[:, :2] - (x, y)
    near = np.hypot(offset[:, 0], offset[:, 1]) - outline.discs[:, 2] <= reach
    offset, radius = offset[near], outline.discs[near, 2]
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
