"""Cells of a grid as a picture, with north up."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PIL import Image

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import PAGE, Rgb
from trundle.pictures.figure import MAX_DRAWING
from trundle.pictures.plan import Plan

_LARGEST_CELL = 64  # [px]
_WANTED = 640  # [px]: small grids are enlarged to about this
_ROWS_AT_ONCE = 32
"""Rows of squares that are merged at once, so that a large grid needs little memory beside its own."""

Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Tint:
    """A colour over some of the cells.

    Attributes:
        cells: Which ones, bool, of the grid's shape.
        color: The colour.
        strength: 0..1; 1 hides what is below.
    """

    cells: npt.NDArray[np.bool_]
    color: Rgb
    strength: float


def draw_cells(
    cells: Bytes,
    palette: Bytes,
    order: Sequence[int],
    resolution: float,
    origin: Pose2D,
    tints: Sequence[Tint] = (),
) -> tuple[Image.Image, float]:
    """Draw a grid in the map frame: x to the right, y up, turned as its origin is.

    Small grids are enlarged by whole pixels a cell. In large ones a square of cells becomes one pixel, of the value
    among them that comes last in `order`, so that no wall is lost.

    Args:
        cells: Shape (rows, cols), row 0 at the origin.
        palette: Colours of the values, shape (256, 3).
        order: All 256 values, those that may be hidden first.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0).
        tints: Drawn over the cells, in this order.

    Returns:
        The picture, at most `MAX_DRAWING` pixels wide and high, and its pixels per metre.
    """
    corners = _corners(cells.shape, origin.yaw)
    low, high = corners.min(axis=0), corners.max(axis=0)
    longest = float((high - low).max())
    merged = max(1, math.ceil(longest / MAX_DRAWING - 1e-9))
    enlarged = min(_LARGEST_CELL, max(1, round(_WANTED * merged / longest)))
    colors = _color(cells, palette, order, merged)
    for tint in tints:
        hidden = merge_cells(np.arange(256, dtype=np.uint8), tint.cells.view(np.uint8), merged) > 0
        mixed = colors[hidden] * (1.0 - tint.strength) + np.array(tint.color) * tint.strength
        colors[hidden] = mixed.round().astype(np.uint8)
    scale = enlarged / merged  # pixels a cell of the grid
    width, height = (max(1, min(MAX_DRAWING, round(float(side) * scale))) for side in high - low)
    x = low[0] + (np.arange(width) + 0.5) / scale
    y = high[1] - (np.arange(height) + 0.5) / scale
    picture, _ = _look_up(colors, x / merged, y / merged, origin.yaw)
    return Image.fromarray(picture), scale / resolution


def lay_cells(
    plan: Plan, cells: Bytes, palette: Bytes, order: Sequence[int], resolution: float, origin: Pose2D
) -> None:
    """Draw a grid into a plan, as far as the plan shows it; the arguments are those of `draw_cells`."""
    merged = max(1, math.floor(1.0 / (plan.inner_scale * resolution)))
    colors = _color(cells, palette, order, merged)
    x, y = plan.inner_points()
    edge = resolution * merged
    pixels, covered = _look_up(colors, (x - origin.x) / edge, (y - origin.y) / edge, origin.yaw)
    plan.paste(pixels, covered)


def _color(cells: Bytes, palette: Bytes, order: Sequence[int], merged: int) -> Bytes:
    """Return colours of squares of `merged` cells a side, shape (rows, cols, 3)."""
    return palette[keep_last(cells, order, merged)]


def _corners(shape: tuple[int, ...], yaw: float) -> FloatArray:
    """Return corners of a grid about its origin, turned by its yaw, in cells, shape (4, 2)."""
    rows, cols = shape
    corners = np.array([[0.0, 0.0], [cols, 0.0], [cols, rows], [0.0, rows]])
    return corners @ _rotation(yaw).T


def _rotation(yaw: float) -> FloatArray:
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([[cos, -sin], [sin, cos]])


def _look_up(colors: Bytes, x: FloatArray, y: FloatArray, yaw: float) -> tuple[Bytes, npt.NDArray[np.bool_]]:
    """Return colours of the cells under a lattice of points, the page's beside the grid; and where there are cells.

    Returns:
        Shapes (len(y), len(x), 3) and (len(y), len(x)).
    """
    rows, cols = colors.shape[:2]
    if yaw == 0.0:
        row, col = np.floor(y).astype(int), np.floor(x).astype(int)
        inside = ((row >= 0) & (row < rows))[:, None] & ((col >= 0) & (col < cols))
        picture = np.ascontiguousarray(colors[row.clip(0, rows - 1)][:, col.clip(0, cols - 1)])
        return picture, inside
    across, up = np.meshgrid(x, y)
    local = np.stack([across, up], axis=-1) @ _rotation(yaw)
    col, row = np.floor(local[..., 0]).astype(int), np.floor(local[..., 1]).astype(int)
    inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    picture = np.full((*inside.shape, 3), PAGE, dtype=np.uint8)
    picture[inside] = colors[row[inside], col[inside]]
    return picture, inside


def keep_last(cells: Bytes, order: Sequence[int], factor: int) -> Bytes:
    """Return of every square of `factor` cells a side the value that comes last in `order`, which has all 256."""
    if factor == 1:
        return cells
    values = np.array(order, dtype=np.uint8)
    return values[merge_cells(np.argsort(values).astype(np.uint8), cells, factor)]


def merge_cells(ranks: Bytes, cells: Bytes, factor: int) -> Bytes:
    """Return the largest rank in every square of `factor` cells a side, of which the last ones may be smaller."""
    if factor == 1:
        return ranks[cells]
    rows, cols = cells.shape
    merged = np.empty((math.ceil(rows / factor), math.ceil(cols / factor)), dtype=np.uint8)
    starts = np.arange(0, cols, factor)
    for first in range(0, len(merged), _ROWS_AT_ONCE):
        part = ranks[cells[first * factor : (first + _ROWS_AT_ONCE) * factor]]
        down = np.maximum.reduceat(part, np.arange(0, len(part), factor), axis=0)
        merged[first : first + _ROWS_AT_ONCE] = np.maximum.reduceat(down, starts, axis=1)
    return merged
