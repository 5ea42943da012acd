"""The world on a map's lattice of cells, and how well the map agrees with it there, in each of eight orientations."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError, MapWarning
from trundle.geometry import FloatArray, Pose2D, Pose3D
from trundle.geometry.solids import Solid
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check.areas import Cells, Mask
from trundle.maps.check.finding import Kind
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OccupancyGrid

MOST_CELLS = 100_000_000  # of the world on the lattice, of a byte each; the search takes several times as much
_MOST_SAMPLES = 60_000  # cells of each kind that an agreement is measured by: its standard error is at most 0.2 %

Phase = tuple[float, float]
Samples = tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]

ScalarT = TypeVar("ScalarT", bound=np.generic)


@dataclass(frozen=True, slots=True)
class Orientation:
    """The correction of an image: flipped first (top and bottom exchanged) or not, then turned counter-clockwise.

    Attributes:
        flipped: Whether top and bottom are exchanged first.
        turns: Quarter turns, 0 to 3.
    """

    flipped: bool
    turns: int

    def apply(self, cells: np.ndarray[tuple[int, int], np.dtype[ScalarT]]) -> npt.NDArray[ScalarT]:
        """Apply the correction to cells, row 0 at the bottom."""
        return np.rot90(cells[::-1] if self.flipped else cells, -self.turns)

    def undo(self, cells: np.ndarray[tuple[int, int], np.dtype[ScalarT]]) -> npt.NDArray[ScalarT]:
        """Undo the correction."""
        turned = np.rot90(cells, self.turns)
        return turned[::-1] if self.flipped else turned

    def move(
        self, rows: npt.NDArray[np.int64], cols: npt.NDArray[np.int64], shape: tuple[int, int]
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Return where cells of a grid of a shape come to lie."""
        if self.flipped:
            rows = shape[0] - 1 - rows
        height, width = shape
        for _ in range(self.turns):
            rows, cols = cols, height - 1 - rows
            height, width = width, height
        return rows, cols

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """What is wrong with an image that needs this."""
        if self.flipped:
            return ("flipped",) if self.turns % 2 == 0 else ("flipped", "rotated")
        return ("rotated",) if self.turns else ()

    @property
    def yaw(self) -> float:
        """Yaw [rad] of the origin that does the same as the turns."""
        return math.remainder(self.turns * math.pi / 2.0, 2.0 * math.pi)

    def describe(self) -> str:
        """Describe what is wrong with an image that needs this correction."""
        if self.flipped:
            return {
                0: "flipped: top and bottom are exchanged",
                2: "flipped: left and right are exchanged",
                1: "flipped along a diagonal: mirrored and turned by 90°",
                3: "flipped along a diagonal: mirrored and turned by 270°",
            }[self.turns]
        return f"rotated: it must be turned by {90 * self.turns}° counter-clockwise"


UPRIGHT = Orientation(flipped=False, turns=0)
ORIENTATIONS = tuple(Orientation(flipped, turns) for flipped in (False, True) for turns in range(4))


@dataclass(frozen=True, slots=True, eq=False)
class WorldCells:
    """The world's map on the map's lattice, moved by a part of a cell.

    Attributes:
        cells: Occupied, free where it can be reached, else unknown.
        row: Row on the map's lattice of the first row here; the map's own first row is 0.
        col: As `row`, for columns.
        phase: How far the lattice is moved up and to the right, in cells, 0 to 1.
    """

    cells: Cells
    row: int
    col: int
    phase: Phase

    @property
    def blocked(self) -> Mask:
        """Which cells are occupied."""
        return self.cells == OCCUPIED

    def crop(self, row: int, col: int, shape: tuple[int, int]) -> Cells:
        """Return the cells from a row and column of the lattice on; unknown outside."""
        part = np.full(shape, UNKNOWN, dtype=np.int8)
        rows, cols = self.cells.shape
        first_row, first_col = row - self.row, col - self.col
        low_row, low_col = max(0, first_row), max(0, first_col)
        high_row, high_col = min(rows, first_row + shape[0]), min(cols, first_col + shape[1])
        if low_row < high_row and low_col < high_col:
            there = np.s_[low_row - first_row : high_row - first_row, low_col - first_col : high_col - first_col]
            part[there] = self.cells[low_row:high_row, low_col:high_col]
        return part


@dataclass(frozen=True, slots=True, eq=False)
class _TurnedWorld:
    solids: Sequence[Solid]
    bounds: tuple[FloatArray, FloatArray]
    seeds: Sequence[tuple[float, float]]


class Lattice:
    """A map's lattice, on which a world is rasterised and compared.

    Args:
        grid: The map; it has occupied and free cells.
        world: The world.
        z_range: The height band [m].

    Raises:
        MapError: If the world cannot be rasterised there.
    """

    def __init__(self, grid: OccupancyGrid, world: SolidWorld, z_range: tuple[float, float]) -> None:
        self.grid = grid
        self._z_range = z_range
        self._world = _express(world, grid.origin)
        low, high = (corner[:2] / grid.resolution for corner in self._world.bounds)
        if not self._world.solids:
            raise MapError("the world has no solids to compare the map with; give another world")
        # Two cells around the world, so that it can be moved by one.
        self._first = np.floor(low).astype(int) - 2
        self._shape = np.ceil(high).astype(int) + 2 - self._first
        if self._shape[0] * self._shape[1] > MOST_CELLS:
            raise MapError(
                f"the world has {self._shape[0]} x {self._shape[1]} of the map's cells of {grid.resolution:g} m, more "
                f"than {MOST_CELLS}: check the map's resolution and the world's unit"
            )
        random = np.random.default_rng(0)
        occupied, known = grid.data == OCCUPIED, grid.data != UNKNOWN
        self.occupied, self.occupied_count = _sample(occupied, random)
        self.free, self.free_count = _sample(known & ~occupied, random)

    def rasterise(self, phase: Phase = (0.0, 0.0)) -> WorldCells:
        """Return the world's map on the lattice, moved by a part of a cell up and to the right."""
        edge = self.grid.resolution
        corner = (self._first + np.array([phase[1], phase[0]])) * edge
        # From the middle of the last cell, so that rounding makes no other.
        last = corner + (self._shape - 0.5) * edge
        bounds = ((float(corner[0]), float(corner[1])), (float(last[0]), float(last[1])))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MapWarning)
            made = OccupancyGrid.from_world(self._world, resolution=edge, z_range=self._z_range, bounds=bounds)
        return WorldCells(made.data, int(self._first[1]), int(self._first[0]), phase)

    def agreement(self, world: WorldCells, orientation: Orientation, row: int, col: int) -> float:
        """Return the share of the cells occupied in map or world that are occupied in both; unknown cells are left out.

        Args:
            world: The world's cells.
            orientation: Applied to the map first.
            row: Where its first row then lies on the world's lattice.
            col: As `row`, for columns.
        """
        hits = self._count(world, self.occupied, orientation, row, col) * self.occupied_count
        conflicts = self._count(world, self.free, orientation, row, col) * self.free_count
        return hits / (self.occupied_count + conflicts)

    def _count(self, world: WorldCells, samples: Samples, orientation: Orientation, row: int, col: int) -> float:
        rows, cols = orientation.move(*samples, self.grid.shape)
        rows, cols = rows + (row - world.row), cols + (col - world.col)
        height, width = world.cells.shape
        inside = (rows >= 0) & (rows < height) & (cols >= 0) & (cols < width)
        found = world.cells[rows[inside], cols[inside]] == OCCUPIED
        return float(np.count_nonzero(found)) / max(1, len(rows))


def _sample(mask: Mask, random: np.random.Generator) -> tuple[Samples, int]:
    indices = np.flatnonzero(mask)
    count = len(indices)
    if count > _MOST_SAMPLES:
        indices = indices[np.sort(random.choice(count, _MOST_SAMPLES, replace=False))]
    rows, cols = np.divmod(indices, mask.shape[1])
    return (rows.astype(np.int64), cols.astype(np.int64)), count


def _express(world: SolidWorld, origin: Pose2D) -> SolidWorld:
    """Return a world in the frame of a map's lower-left corner."""
    inverse = origin.inverse()
    half = inverse.yaw / 2.0
    cos, sin = math.cos(half), math.sin(half)

    def express(pose: Pose3D) -> Pose3D:
        (x, y), *_ = inverse.transform_points([pose.position[:2]])
        w, i, j, k = pose.quaternion
        turned = (cos * w - sin * k, cos * i - sin * j, cos * j + sin * i, cos * k + sin * w)
        return Pose3D((float(x), float(y), pose.position[2]), turned)

    solids = tuple(dataclasses.replace(solid, pose=express(solid.pose)) for solid in world.solids)
    if not solids:
        return _TurnedWorld((), (np.zeros(3), np.zeros(3)), ())
    lows, highs = zip(*(solid.bounds() for solid in solids), strict=True)
    seeds = inverse.transform_points(np.asarray(world.seeds, dtype=np.float64).reshape(-1, 2))
    places = tuple((float(x), float(y)) for x, y in seeds)
    return _TurnedWorld(solids, (np.min(lows, axis=0), np.max(highs, axis=0)), places)
