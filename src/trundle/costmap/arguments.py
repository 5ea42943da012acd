"""What callers give a costmap, checked and as arrays; and windows of cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Footprint
from trundle.maps.grid import OccupancyGrid
from trundle.robots import Robot
from trundle.values import check_kind

if TYPE_CHECKING:
    from trundle.maps.masks import KeepoutMask


def keepout_costs(keepout: KeepoutMask, grid: OccupancyGrid) -> npt.NDArray[np.uint8]:
    """Return the costs of a keep-out mask on the cells of a grid."""
    from trundle.maps.masks import KeepoutMask

    check_kind(keepout, KeepoutMask, "keepout", "KeepoutMask.load(path) reads one")
    return keepout.costs_on(grid)


def as_footprint(footprint: Robot | Footprint | npt.ArrayLike) -> Footprint:
    """Return the footprint of a robot, or of corners in base_link [m], shape (N, 2); see `Footprint` for the errors."""
    return footprint.planar if isinstance(footprint, Robot) else Footprint.of(footprint)


def as_corners(outline: npt.ArrayLike) -> FloatArray:
    """Check the corners of an outline [m], shape (M, 2)."""
    corners = _as_numbers(outline, "an outline", "(M, 2): x, y")
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3 or not (np.abs(corners) < 1e100).all():
        raise InputError(f"an outline needs at least 3 finite corners of shape (M, 2) [m], got shape {corners.shape}")
    return corners


def as_poses(poses: npt.ArrayLike) -> FloatArray:
    """Return poses x, y, yaw, shape (N, 3), from one pose or many."""
    array = _as_numbers(poses, "poses", "(N, 3): x, y, yaw")
    if array.ndim == 1:
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"poses need shape (N, 3): x, y, yaw; got {np.shape(poses)}")
    return array


def as_range(part: slice, what: str, count: int) -> tuple[int, int]:
    """Return the first row or column of a slice and the one after its last, checked to be some of `count`."""
    if not isinstance(part, slice) or part.step not in (None, 1):
        raise InputError(f"{what} must be a slice without a step, got {part!r}")
    first = 0 if part.start is None else part.start
    end = count if part.stop is None else part.stop
    if not (isinstance(first, int | np.integer) and isinstance(end, int | np.integer) and 0 <= first < end <= count):
        raise InputError(f"{what} must be a part of 0 to {count} that is not empty, got {part!r}")
    return int(first), int(end)


def widen(window: tuple[int, int, int, int], by: int, shape: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return a window (row, row end, column, column end) with `by` more cells on each side that the grid has."""
    row, row_end, col, col_end = window
    return max(0, row - by), min(shape[0], row_end + by), max(0, col - by), min(shape[1], col_end + by)


def slices_of(window: tuple[int, int, int, int]) -> tuple[slice, slice]:
    """Return rows and columns of a window."""
    return slice(window[0], window[1]), slice(window[2], window[3])


def _as_numbers(values: npt.ArrayLike, what: str, shape: str) -> FloatArray:
    try:
        return np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} must be an array of numbers of shape {shape}; {error}") from None
