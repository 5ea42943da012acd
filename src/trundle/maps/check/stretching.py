"""Scale of a map against its world along each axis: a search by correlation, then hill climbing."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.geometry import FloatArray
from trundle.maps.check.lattice import ORIENTATIONS, UPRIGHT, Lattice, Orientation, WorldCells
from trundle.maps.check.matching import Match, as_good, find_matches
from trundle.maps.check.nearness import (
    LAST_STEP,
    Level,
    Points,
    choose_points,
    climb,
    look_up,
    make_levels,
    orient,
    start_of,
)
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OccupancyGrid

_MOST = 0.12  # largest stretch of an axis; larger errors are the usual factors
_USUAL_FACTORS = (0.1, 0.2, 0.25, 0.4, 0.5, 2.0, 2.5, 4.0, 5.0, 10.0)
_SAMPLES = 5_000  # cells of each sign that a size is scored by
_KEPT = 4  # sizes that are refined from level to level
_LEAST_CELLS = 1.0  # at the map's ends: a robot does not notice a smaller stretch
_SQUARE_CELLS = 1.0  # there: the search cannot distinguish less from an equal scale of both axes


@dataclass(frozen=True, slots=True)
class Stretch:
    """A map whose cells are of another size.

    Attributes:
        width: Width of its cells that fits the world [m], along the image's rows.
        height: As `width`, along its columns.
        agreement: With cells of this size, in its best place.
    """

    width: float
    height: float
    agreement: float

    @property
    def is_square(self) -> bool:
        """Whether the cells are square, so that another resolution is enough."""
        return self.width == self.height


@dataclass(frozen=True, slots=True)
class _Size:
    """Factors along the image's axes, and a place: x, y [cells] of the middle of the occupied cells."""

    orientation: Orientation
    across: float
    up: float
    x: float = 0.0
    y: float = 0.0
    score: float = -math.inf

    def matrix(self) -> FloatArray:
        return orient(self.orientation) @ np.diag([self.across, self.up])


def find_stretch(
    lattice: Lattice, cells: WorldCells, match: Match, world: SolidWorld, z_range: tuple[float, float], *, nowhere: bool
) -> Stretch | None:
    """Find cells of another size with which a map fits its world clearly better.

    Args:
        lattice: The map's lattice.
        cells: The world on it, at the match's phase.
        match: Where the map agrees best as it is.
        world: The world.
        z_range: The heights that count [m].
        nowhere: Whether it agrees so badly there that any orientation and any size is possible.
    """
    search = _Search(lattice, cells)
    best = search.find(match, nowhere=nowhere)
    if best is None:
        return None
    made = _rescale(lattice.grid, best, search.extent)
    try:
        rescaled = Lattice(made.grid, world, z_range)
        matching, seen = find_matches(rescaled)
        # Once more on cells of about the right size: those of the map may have been far too coarse.
        again = _Search(rescaled, seen)
        finer = again.refine(matching.best)
        total = replace(
            finer,
            across=finer.across * made.width / lattice.grid.resolution,
            up=finer.up * made.height / lattice.grid.resolution,
        )
        refined = _rescale(lattice.grid, total, again.extent)
        final, _ = find_matches(Lattice(refined.grid, world, z_range))
    except MapError:
        return None
    if final.best.agreement >= matching.best.agreement:
        made, matching = refined, final
    agreement = matching.best.agreement
    if as_good(match.agreement, agreement) or agreement <= match.agreement:
        return None
    return Stretch(made.width, made.height, agreement)


@dataclass(frozen=True, slots=True, eq=False)
class _Rescaled:
    grid: OccupancyGrid
    width: float
    height: float


def _rescale(grid: OccupancyGrid, size: _Size, extent: FloatArray) -> _Rescaled:
    """Return the map with square cells of its new height, and the size of its old cells in the world."""
    width, height = size.across * grid.resolution, size.up * grid.resolution
    if abs(size.across / size.up - 1.0) * float(extent.max()) < _SQUARE_CELLS:
        width = height = _round(math.sqrt(width * height), float(extent.max()))
        return _Rescaled(replace(grid, resolution=width), width, height)
    width, height = _round(width, float(extent[0])), _round(height, float(extent[1]))
    cols = max(1, round(grid.shape[1] * width / height))
    taken = np.minimum(((np.arange(cols) + 0.5) * height / width).astype(np.int64), grid.shape[1] - 1)
    return _Rescaled(OccupancyGrid(grid.data[:, taken], height, grid.origin, grid.surface), width, height)


def _round(length: float, cells: float) -> float:
    """Return the length with as few digits as make no difference at a map's ends."""
    for digits in range(1, 5):
        rounded = float(f"{length:.{digits}g}")
        if abs(rounded / length - 1.0) * cells < _SQUARE_CELLS:
            return rounded
    return float(f"{length:.5g}")


class _Search:
    """Searches sizes of a map's cells, scored by how near its walls come to the world's.

    Args:
        lattice: The map's lattice.
        cells: The world on it.
    """

    def __init__(self, lattice: Lattice, cells: WorldCells) -> None:
        rows, cols = lattice.occupied
        self._shape = lattice.grid.shape
        self._middle = np.array([cols.mean(), rows.mean()]) + 0.5
        self._corner = np.array([cells.col + cells.phase[1], cells.row + cells.phase[0]])
        self._world_size = np.array(cells.cells.shape[::-1], dtype=np.float64) - 4.0  # less the lattice's rim
        self._points = choose_points(lattice, self._middle, _SAMPLES, np.random.default_rng(0))
        occupied = self._points.places[self._points.weights > 0.0]
        self.extent: FloatArray = np.maximum(np.abs(occupied).max(axis=0), 1.0)
        """How far the occupied cells reach from their middle along each axis [cells]."""
        self._size = np.array([np.ptp(cols) + 1.0, np.ptp(rows) + 1.0])
        self._levels = make_levels(cells.cells, float(np.linalg.norm(self.extent)) * (1.0 + _MOST))
        self._spectra: dict[int, npt.NDArray[np.complex128]] = {}

    def find(self, match: Match, *, nowhere: bool) -> _Size | None:
        """Return the best size, if it is clearly better than that of the match."""
        base = self._settle_on(self._levels[0], self._start(match), LAST_STEP, scale=False)
        orientations = ORIENTATIONS if nowhere else tuple(dict.fromkeys((match.orientation, UPRIGHT)))
        coarse = [self._correlate(size) for one in orientations for size in self._list_sizes(one, nowhere=nowhere)]
        coarse.sort(key=lambda one: -one.score)
        found = [self._climb(size) for size in coarse[:_KEPT]]
        best = max([*found, self._climb(base)], key=lambda one: one.score)
        changed = np.abs(np.array([best.across, best.up]) - 1.0) * self.extent
        if as_good(base.score, best.score) or changed.max() < _LEAST_CELLS:
            return None
        return best

    def refine(self, match: Match) -> _Size:
        """Return the best size near that of a match."""
        return self._settle_on(self._levels[0], self._start(match), LAST_STEP, scale=True)

    def _list_sizes(self, orientation: Orientation, *, nowhere: bool) -> list[_Size]:
        """Return sizes to try: of one axis, of both, and those that make the map as large as the world."""
        step = self._levels[-1].block / float(self.extent.max())
        count = max(1, math.ceil(_MOST / step))
        sizes: list[_Size] = []
        for index in range(-count, count + 1):
            factor = 1.0 + index * _MOST / count
            sizes += [_Size(orientation, factor, 1.0), _Size(orientation, 1.0, factor)]
            sizes.append(_Size(orientation, factor, factor))
        world = self._world_size if orientation.turns % 2 == 0 else self._world_size[::-1]
        across, up = (world / self._size).tolist()
        sizes += [_Size(orientation, across, up), _Size(orientation, math.sqrt(across * up), math.sqrt(across * up))]
        if nowhere:
            sizes += [_Size(orientation, factor, factor) for factor in _USUAL_FACTORS]
        return sizes

    def _start(self, match: Match) -> _Size:
        """Return a match as a place for cells of the size that they have now."""
        return _Size(match.orientation, 1.0, 1.0, *start_of(match, self._shape, self._middle))

    def _correlate(self, size: _Size) -> _Size:
        """Return the best place of a size on the coarsest level."""
        level = self._levels[-1]
        moved = self._points.places @ size.matrix().T / level.block
        reach = math.ceil(float(np.abs(moved).max())) + 1
        # In steps, so that few transforms of the world serve all sizes.
        side = -(-(2 * reach + max(level.field.shape)) // 128) * 128
        if side not in self._spectra:
            self._spectra[side] = np.fft.rfft2(level.field, (side, side))
        at = np.floor(moved + reach).astype(np.int64)
        image = np.bincount(at[:, 1] * side + at[:, 0], weights=self._points.weights, minlength=side * side)
        signal = np.conj(np.fft.rfft2(image.reshape(side, side)))
        scores = np.fft.irfft2(signal * self._spectra[side], (side, side))
        row, col = divmod(int(np.argmax(scores)), side)
        rows, cols = level.field.shape
        shift = np.array([col - side if col >= cols else col, row - side if row >= rows else row])
        x, y = (shift + reach - 1.0) * level.block - self._middle + self._corner
        return replace(size, x=float(x), y=float(y), score=float(scores[row, col]))

    def _climb(self, size: _Size) -> _Size:
        """Return the best size and place near one, from the coarsest level to single cells."""
        for level in self._levels[::-1]:
            last = LAST_STEP if level.block == 1 else level.block / 4.0
            size = self._settle_on(level, size, last, scale=True)
        return size

    def _settle_on(self, level: Level, size: _Size, last: float, *, scale: bool) -> _Size:
        def around(best: _Size, step: float) -> list[_Size]:
            tried = [replace(best, x=best.x + by) for by in (-step, step)]
            tried += [replace(best, y=best.y + by) for by in (-step, step)]
            if scale:
                for sign in (-1.0, 1.0):
                    across, up = (sign * step / self.extent).tolist()
                    both = sign * step / float(self.extent.max())
                    tried.append(replace(best, across=best.across + across))
                    tried.append(replace(best, up=best.up + up))
                    tried.append(replace(best, across=best.across + both, up=best.up + both))
            return [replace(one, score=self._score(self._points, level, one)) for one in tried]

        first = replace(size, score=self._score(self._points, level, size))
        return climb(first, float(level.block), last, around)

    def _score(self, points: Points, level: Level, size: _Size) -> float:
        moved = points.places @ size.matrix().T + (self._middle - self._corner + np.array([size.x, size.y]))
        return float((points.weights * look_up(level, moved)).sum())
