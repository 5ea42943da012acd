"""Nearness of a map's cells to a world's walls: the score that the searches for a map's place maximize."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from trundle._core import inflate
from trundle.geometry import FloatArray
from trundle.maps.cells import OCCUPIED
from trundle.maps.check.areas import Cells
from trundle.maps.check.lattice import Lattice, Orientation
from trundle.maps.check.matching import Match, pad, pyramid

_COARSE_SIDE = 256  # blocks of cells along the side of the images that are correlated
_BLUR_CELLS = 1.5  # standard deviation around walls: noise of a scan or of a rotated lattice

LAST_STEP = 0.05
"""Last step of a climb to the best place [cells]."""

Matrix = FloatArray


class Scored(Protocol):
    """A place that has been scored."""

    @property
    def score(self) -> float:
        """How well the map agrees with the world there."""
        ...


ScoredT = TypeVar("ScoredT", bound=Scored)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Cells of the map: their places [cells] about the middle of the occupied ones, shape (N, 2); their weights."""

    places: FloatArray
    weights: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Nearness of walls on blocks of so many cells, with a rim of one block of 0."""

    field: npt.NDArray[np.float32]
    block: int


def choose_points(lattice: Lattice, middle: FloatArray, most: int, random: np.random.Generator) -> Points:
    """Return some of a map's occupied and of its free cells; the weights of each kind add up to 1 and −1."""
    places: list[FloatArray] = []
    weights: list[FloatArray] = []
    for (rows, cols), sign in ((lattice.occupied, 1.0), (lattice.free, -1.0)):
        chosen: slice | npt.NDArray[np.int64] = slice(None)
        if len(rows) > most:
            chosen = random.choice(len(rows), most, replace=False)
        xy = np.column_stack([cols[chosen], rows[chosen]]) + 0.5 - middle
        places.append(xy)
        weights.append(np.full(len(xy), sign / len(xy)))
    return Points(np.concatenate(places), np.concatenate(weights))


def make_levels(cells: Cells, reach: float) -> list[Level]:
    """Return the nearness of a world's walls, from single cells to blocks as coarse as a search begins with.

    Args:
        cells: The world's.
        reach: How far the map's cells are from its middle at most [cells].
    """
    longest = 2.0 * reach + max(cells.shape)
    levels = max(0, math.ceil(math.log2(max(1.0, longest / _COARSE_SIDE))))
    field = pad(_blur(cells), 2**levels)
    return [Level(np.pad(values, 1), 2**n) for n, values in enumerate(pyramid(field, levels))]


def look_up(level: Level, places: FloatArray) -> npt.NDArray[np.float32]:
    """Return the field at places [cells] from the world's corner; 0 outside."""
    at = np.floor(places / level.block).astype(np.int64) + 1
    rows, cols = level.field.shape
    np.clip(at[:, 0], 0, cols - 1, out=at[:, 0])
    np.clip(at[:, 1], 0, rows - 1, out=at[:, 1])
    return level.field.ravel()[at[:, 1] * cols + at[:, 0]]


def rotation(angle: float) -> Matrix:
    """Return a turn counter-clockwise, shape (2, 2)."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


def orient(orientation: Orientation) -> Matrix:
    """Return the matrix by which an orientation moves points, shape (2, 2)."""
    flip = np.diag([1.0, -1.0]) if orientation.flipped else np.eye(2)
    return np.rint(rotation(orientation.turns * math.pi / 2.0)) @ flip


def start_of(match: Match, shape: tuple[int, int], middle: FloatArray) -> tuple[float, float]:
    """Return how far (x, y) [cells] a match moves the middle of a map's occupied cells, for a search to start from.

    Args:
        match: Where the map fits, flipped or turned by quarters about its image's middle.
        shape: (rows, cols) of the map.
        middle: Middle (x, y) of its occupied cells [cells].
    """
    half = np.array(shape[::-1]) / 2.0
    turned_half = half if match.orientation.turns % 2 == 0 else half[::-1]
    x, y = match.offset + turned_half + orient(match.orientation) @ (middle - half) - middle
    return float(x), float(y)


def _blur(cells: Cells) -> npt.NDArray[np.float32]:
    """Return the nearness of an occupied cell: 1 on it, falling with the distance as a normal distribution does."""
    squared = np.arange(math.ceil((3.0 * _BLUR_CELLS) ** 2) + 1)
    table = np.rint(252.0 * np.exp(-squared / (2.0 * _BLUR_CELLS**2))).astype(np.uint8)
    table[0] = 254
    near = inflate(np.where(cells == OCCUPIED, np.int8(OCCUPIED), np.int8(0)), table)
    return np.minimum(near, 252).astype(np.float32) / np.float32(252.0)


def climb(best: ScoredT, step: float, last: float, around: Callable[[ScoredT, float], Sequence[ScoredT]]) -> ScoredT:
    """Climb from a place to the best one near it: of those `around` it at a step [cells], which is halved at a peak."""
    while step >= last:
        next_one = max(around(best, step), key=lambda one: one.score)
        if next_one.score > best.score + 1e-9:
            best = next_one
        else:
            step /= 2.0
    return best
