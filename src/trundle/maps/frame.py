"""Where a grid's cells lie in the map frame."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.values import as_array

CellArray: TypeAlias = npt.NDArray[np.int64]


_FARTHEST = 2.0**62
"""Cells farther away than this are not distinguished."""


class GridFrame(ABC):
    """The geometry of a grid.

    Attributes:
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame; its yaw rotates the whole grid.
    """

    __slots__ = ()
    resolution: float
    origin: Pose2D

    def _size_text(self) -> str:
        """Return the number of cells, resolution and extent, for display."""
        rows, cols = self.shape
        wide, high = (round(count * self.resolution, 4) for count in (cols, rows))
        return f"{cols} x {rows} cells of {self.resolution:g} m, {wide:g} x {high:g} m"

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""

    def world_to_cell(self, x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[CellArray, CellArray]:
        """Return cells (row, col) that hold points x, y [m] in the map frame, of any one shape; they may lie outside.

        NaN, and points too far away for an integer index, lie outside.
        """
        dx, dy = _points(x) - self.origin.x, _points(y) - self.origin.y
        _check_shapes(dx, dy)
        cos, sin = math.cos(self.origin.yaw), math.sin(self.origin.yaw)
        with np.errstate(over="ignore"):
            col, row = (
                np.floor((cos * dx + sin * dy) / self.resolution),
                np.floor((cos * dy - sin * dx) / self.resolution),
            )
        return _whole(row), _whole(col)

    def cell_to_world(self, row: npt.ArrayLike, col: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return centres x, y [m] in the map frame of cells (row, col), of any one shape."""
        along, across = (_points(col) + 0.5) * self.resolution, (_points(row) + 0.5) * self.resolution
        _check_shapes(along, across)
        cos, sin = math.cos(self.origin.yaw), math.sin(self.origin.yaw)
        return self.origin.x + cos * along - sin * across, self.origin.y + sin * along + cos * across

    def contains(self, row: npt.ArrayLike, col: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Return whether cells lie inside the grid."""
        rows, cols = _numbers(row), _numbers(col)
        _check_shapes(rows, cols)
        return (rows >= 0) & (rows < self.shape[0]) & (cols >= 0) & (cols < self.shape[1])


def _points(values: npt.ArrayLike) -> FloatArray:
    return as_array(values, np.float64, "coordinates", copy=False)


def _numbers(values: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return integers as they are, everything else as coordinates."""
    if isinstance(values, np.ndarray) and values.dtype.kind in "iu":
        return values
    return _points(values)


def _check_shapes(first: npt.NDArray[Any], second: npt.NDArray[Any]) -> None:
    """Raise `InputError` unless two arrays have one shape, or can be broadcast to one."""
    if first.shape == second.shape:
        return
    try:
        np.broadcast_shapes(first.shape, second.shape)
    except ValueError:
        raise InputError(
            f"coordinates must have the same shape, or be one number for all; got {first.shape} and {second.shape}"
        ) from None


def _whole(numbers: npt.ArrayLike) -> CellArray:
    return np.fmin(np.fmax(numbers, -_FARTHEST), _FARTHEST).astype(np.int64)
