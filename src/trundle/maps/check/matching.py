"""Where a map belongs in its world: a coarse-to-fine correlation over all orientations and places."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check.lattice import ORIENTATIONS, UPRIGHT, Lattice, Orientation, Phase, WorldCells

# These trade the time of a check against places that are missed.
_COARSE_SIDE = 512  # blocks of cells along the longest side where the search begins
_PEAKS = 3  # places per orientation that are refined
_KEEP = 0.6  # least share of the best coarse score for refining a place
_FINE_SAMPLES = 15_000  # cells of each sign that are compared on a finer level
_REACH = 2  # cells in each direction that a finer level searches
_MOST_CANDIDATES = 12  # places that are compared cell by cell
_CENTRE_REACH = 2.0  # cells in each direction within which the middle is searched
_APART = 3  # cells: nearer places are one
_PERFECT = 0.999  # a better agreement leaves nothing to search for
_FALL_BEHIND = 0.25  # a place with less agreement than the best by this much is not refined between cells
_QUARTER_STEPS_BELOW = 4_000_000  # cells of the world; larger ones are searched in half cells, with half as many tries


@dataclass(frozen=True, slots=True)
class Match:
    """A place of a map in its world.

    Attributes:
        orientation: The flip and turns that are applied to the map first.
        row: Row to which its first row then belongs, on the map's lattice moved by the phase.
        col: As `row`, for columns.
        phase: How far the lattice is moved up and to the right [cells].
        agreement: Agreement with the world there, 0 to 1, see `Lattice.agreement`.
    """

    orientation: Orientation
    row: int
    col: int
    phase: Phase
    agreement: float

    @property
    def offset(self) -> tuple[float, float]:
        """How far (x, y) the map's lower-left corner must be moved, in cells."""
        return self.col + self.phase[1], self.row + self.phase[0]

    @property
    def is_near(self) -> bool:
        """Whether this is the place that the map's file states, give or take a cell."""
        return self.orientation == UPRIGHT and max(map(abs, self.offset)) <= 1.0


@dataclass(frozen=True, slots=True)
class Matching:
    """The result of the search.

    Attributes:
        stated: The map where its YAML file puts it.
        best: Where it agrees best.
        rivals: Other places where it agrees as well, `best` not among them.
    """

    stated: Match
    best: Match
    rivals: tuple[Match, ...]


def as_good(agreement: float, best: float) -> bool:
    """Return whether an agreement is no clear loss against the best."""
    # 15 % more disagreement is noise, and so are 0.4 % of the cells of a map that fits well.
    return 1.0 - agreement <= 1.15 * (1.0 - best) + 0.004


def find_matches(lattice: Lattice) -> tuple[Matching, WorldCells]:
    """Find where a map agrees best with its world, to a quarter of a cell or better.

    Returns:
        The places, and the world's cells on the lattice of the best one.
    """
    world = lattice.rasterise()
    stated = Match(UPRIGHT, 0, 0, world.phase, lattice.agreement(world, UPRIGHT, 0, 0))
    found = [
        Match(orientation, row, col, world.phase, lattice.agreement(world, orientation, row, col))
        for orientation, row, col in _search(lattice, world)
    ]
    candidates = _distinct([stated, *found])[:_MOST_CANDIDATES]
    worlds = {world.phase: world}
    if candidates[0].agreement < _PERFECT:
        candidates = [match for match in candidates if match.agreement >= candidates[0].agreement - _FALL_BEHIND]
        candidates = _refine(lattice, candidates, ((0.0, 0.5), (0.5, 0.0), (0.5, 0.5)), worlds)
    best = next((one for one in candidates if one.is_near and as_good(one.agreement, candidates[0].agreement)), None)
    best = best or candidates[0]
    rivals = tuple(one for one in candidates if one is not best and as_good(one.agreement, best.agreement))
    if best.agreement < _PERFECT:
        best = _centre(lattice, best, worlds)
    return Matching(stated, best, rivals), worlds[best.phase]


def _distinct(matches: list[Match]) -> list[Match]:
    """Sort by agreement, the best first, and drop matches within a few cells of a better one."""
    kept: list[Match] = []
    for match in sorted(matches, key=lambda match: -match.agreement):
        near = any(
            other.orientation == match.orientation
            and abs(other.row - match.row) <= _APART
            and abs(other.col - match.col) <= _APART
            for other in kept
        )
        if not near:
            kept.append(match)
    return kept


def _refine(
    lattice: Lattice, matches: list[Match], phases: tuple[Phase, ...], worlds: dict[Phase, WorldCells]
) -> list[Match]:
    """Try other phases around each match."""
    best = list(matches)
    for phase in phases:
        world = worlds[phase] = lattice.rasterise(phase)
        for index, match in enumerate(matches):
            at_row, at_col = match.row + match.phase[0] - phase[0], match.col + match.phase[1] - phase[1]
            rows, cols = ({math.floor(at), math.ceil(at)} for at in (at_row, at_col))
            for row, col in itertools.product(sorted(rows), sorted(cols)):
                agreement = lattice.agreement(world, match.orientation, row, col)
                if agreement > best[index].agreement + 1e-9:
                    best[index] = replace(match, row=row, col=col, phase=phase, agreement=agreement)
    return sorted(best, key=lambda match: -match.agreement)


def _centre(lattice: Lattice, match: Match, worlds: dict[Phase, WorldCells]) -> Match:
    """Move a match to the middle of the range of offsets in which the map agrees, along x, then along y.

    A wall between the lines of the lattice covers the same cells wherever it lies between them: the agreement has no
    plateau instead of a peak, and the middle of the plateau is the wanted offset.
    """
    step = 0.25 if worlds[0.0, 0.0].cells.size < _QUARTER_STEPS_BELOW else 0.5
    for axis in (0, 1):
        x, y = match.offset
        count = round(_CENTRE_REACH / step)
        moves = [index * step for index in range(-count, count + 1)]
        tried = [_at(lattice, match, (x + move, y) if axis == 0 else (x, y + move), worlds) for move in moves]
        highest = max(tried, key=lambda one: one.agreement)
        if highest.agreement >= _PERFECT:
            return highest
        level = (highest.agreement + min(one.agreement for one in tried)) / 2.0
        first = last = tried.index(highest)
        while first > 0 and tried[first - 1].agreement >= level:
            first -= 1
        while last < len(tried) - 1 and tried[last + 1].agreement >= level:
            last += 1
        move = (moves[first] + moves[last]) / 2.0
        match = _at(lattice, match, (x + move, y) if axis == 0 else (x, y + move), worlds)
    return match


def _at(lattice: Lattice, match: Match, offset: tuple[float, float], worlds: dict[Phase, WorldCells]) -> Match:
    """Return the match moved to another offset."""
    col, row = (math.floor(number) for number in offset)
    phase = (offset[1] - row, offset[0] - col)
    if phase not in worlds:
        worlds[phase] = lattice.rasterise(phase)
    agreement = lattice.agreement(worlds[phase], match.orientation, row, col)
    return Match(match.orientation, row, col, phase, agreement)


# The search by correlation ------------------------------------------------------------------------------------------


def _search(lattice: Lattice, world: WorldCells) -> list[tuple[Orientation, int, int]]:
    """Find the places (orientation, row, col) that are worth refining."""
    longest = max(a + b for a, b in itertools.product(lattice.grid.shape, world.cells.shape))
    levels = max(0, math.ceil(math.log2(max(1.0, longest / (2 * _COARSE_SIDE)))))
    block = 2**levels
    signals = list(pyramid(_signal(lattice, block), levels))
    walls = list(pyramid(pad(world.blocked.astype(np.float32), block), levels))
    peaks = _correlate(signals[-1], walls[-1])
    strongest = max(score for score, *_ in peaks)
    finer = [_sample(signal) for signal in signals[-2::-1]]
    padded = [np.pad(wall, _REACH) for wall in walls[-2::-1]]
    places: list[tuple[Orientation, int, int]] = []
    peaks.sort(key=lambda peak: -peak[0])
    for score, orientation, row, col in peaks[:_MOST_CANDIDATES]:
        if score < _KEEP * strongest:
            break
        for points, wall in zip(finer, padded, strict=True):
            row, col = _climb(points, wall, orientation, 2 * row, 2 * col)
        # From the padded image's corner to the image's own.
        corners = np.array([0, lattice.grid.shape[0] - 1]), np.array([0, lattice.grid.shape[1] - 1])
        rows, cols = orientation.move(*corners, signals[0].shape)
        places.append((orientation, row + world.row + int(rows.min()), col + world.col + int(cols.min())))
    return places


def _signal(lattice: Lattice, block: int) -> npt.NDArray[np.float32]:
    """Return the map as numbers whose sum is 0: occupied above, free below, unknown and beyond 0."""
    data = lattice.grid.data
    weight = max(1.0, lattice.free_count / lattice.occupied_count)
    signal = np.where(data == UNKNOWN, np.float32(0.0), np.float32(-1.0))
    signal[data == OCCUPIED] = weight
    return pad(signal, block)


def pad(values: npt.NDArray[np.float32], block: int) -> npt.NDArray[np.float32]:
    """Return the values, padded with zeros to whole blocks of a number of cells."""
    rows, cols = (-side % block for side in values.shape)
    return np.pad(values, ((0, rows), (0, cols)), constant_values=0.0)


def pyramid(values: npt.NDArray[np.float32], levels: int) -> Iterator[npt.NDArray[np.float32]]:
    """Return the values, then their means over blocks of 2, 4, … cells."""
    yield values
    for _ in range(levels):
        values = (values[::2, ::2] + values[1::2, ::2] + values[::2, 1::2] + values[1::2, 1::2]) / np.float32(4.0)
        yield values


def _correlate(
    signal: npt.NDArray[np.float32], walls: npt.NDArray[np.float32]
) -> list[tuple[float, Orientation, int, int]]:
    """Return the highest peaks (score, orientation, row, col) of the correlation in each orientation."""
    peaks: list[tuple[float, Orientation, int, int]] = []
    side = -(-(max(signal.shape) + max(walls.shape)) // 32) * 32
    spectrum = np.fft.rfft2(walls, (side, side))
    for orientation in ORIENTATIONS:
        turned = np.fft.rfft2(orientation.apply(signal), (side, side))
        scores: FloatArray = np.fft.irfft2(np.conj(turned) * spectrum, (side, side))
        for _ in range(_PEAKS):
            row, col = (int(index) for index in np.unravel_index(int(np.argmax(scores)), scores.shape))
            score = float(scores[row, col])
            # Past the walls' end, an index stands for a place before their beginning.
            at_row = row - side if row >= walls.shape[0] else row
            at_col = col - side if col >= walls.shape[1] else col
            peaks.append((score, orientation, at_row, at_col))
            rows, cols = (np.arange(index - _APART, index + _APART + 1) % side for index in (row, col))
            scores[np.ix_(rows, cols)] = -np.inf
    return peaks


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    """Cells of a signal, and their values, scaled where they stand for more."""

    rows: npt.NDArray[np.int64]
    cols: npt.NDArray[np.int64]
    values: FloatArray
    shape: tuple[int, int]


def _sample(signal: npt.NDArray[np.float32]) -> _Points:
    random = np.random.default_rng(0)
    chosen: list[npt.NDArray[np.intp]] = []
    values: list[FloatArray] = []
    for part in (signal > 0.0, signal < 0.0):
        indices = np.flatnonzero(part)
        count = max(1, len(indices))
        if count > _FINE_SAMPLES:
            indices = indices[np.sort(random.integers(0, count, _FINE_SAMPLES))]
        chosen.append(indices)
        values.append(signal.ravel()[indices].astype(np.float64) * (count / max(1, len(indices))))
    rows, cols = np.divmod(np.concatenate(chosen), signal.shape[1])
    return _Points(rows, cols, np.concatenate(values), (signal.shape[0], signal.shape[1]))


def _climb(
    points: _Points, walls: npt.NDArray[np.float32], orientation: Orientation, row: int, col: int
) -> tuple[int, int]:
    """Return the best place within `_REACH` cells of one; `walls` have a rim of so many cells."""
    rows, cols = orientation.move(points.rows, points.cols, points.shape)
    rows, cols = rows + (row + _REACH), cols + (col + _REACH)
    height, width = walls.shape
    inside = (rows >= _REACH) & (rows < height - _REACH) & (cols >= _REACH) & (cols < width - _REACH)
    places, values, flat = (rows * width + cols)[inside], points.values[inside], walls.ravel()
    best, place = -math.inf, (row, col)
    for down, right in itertools.product(range(-_REACH, _REACH + 1), repeat=2):
        # Not a product of vectors: a linear-algebra library would start threads for it.
        score = float((values * flat[places + (down * width + right)]).sum())
        if score > best:
            best, place = score, (row + down, col + right)
    return place
