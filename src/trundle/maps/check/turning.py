"""Rotation of a map against its world: a coarse-to-fine correlation over all angles and places."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.maps.check.lattice import ORIENTATIONS, Lattice, Orientation, WorldCells
from trundle.maps.check.matching import Match, as_good
from trundle.maps.check.nearness import (
    LAST_STEP,
    Level,
    Matrix,
    Points,
    choose_points,
    climb,
    look_up,
    make_levels,
    orient,
    rotation,
    start_of,
)

WELL_MATCHED = 0.75
"""A map that agrees at least this well with its world as it is stated is not tried at other angles."""

_SEARCH_SAMPLES = 4_000  # cells of each sign that the many places of the search are scored by
_FINAL_SAMPLES = 16_000  # that the few places left are scored by
_KEPT = (32, 16, 8, 4)  # places that are refined from level to level
_APART = 3.0  # cells of a level: nearer places are one
_PEAK_CELLS = 1.5  # distance from the best score within which scores fall as a parabola
_WIDEST_FINAL = math.radians(3.0)  # largest turn of the last search

_LEAST_TURN_CELLS = 1.0  # at the map's far cells: a robot does not notice a smaller turn
_SNAP_CELLS = 0.25  # there: the search cannot distinguish less from a whole quarter turn


@dataclass(frozen=True, slots=True)
class Turn:
    """A place of a map in its world, at any angle.

    Attributes:
        orientation: Applied to the image first.
        angle: Turn after that, counter-clockwise about the middle of its occupied cells [rad].
        x: How far that middle is then moved to the right, in cells.
        y: As `x`, up.
        score: Mean nearness of a wall at the map's occupied cells, less that at its free cells.
    """

    orientation: Orientation
    angle: float
    x: float
    y: float
    score: float

    def matrix(self) -> Matrix:
        """Return the matrix that moves points about the middle, shape (2, 2)."""
        return rotation(self.angle) @ orient(self.orientation)


@dataclass(frozen=True, slots=True)
class Turning:
    """The result of the search.

    Attributes:
        origin: The map's origin, turned and moved as it must be.
        angle: How far that is [rad]; a map that needs a quarter more, or that is mirrored, is matched after that.
        rivals: Other places, at other angles, where the map fits as well.
    """

    origin: Pose2D
    angle: float
    rivals: tuple[Turn, ...]


def find_turn(lattice: Lattice, world: WorldCells, match: Match) -> Turning | None:
    """Find the angle at which a map fits its world clearly better than as its file states.

    Args:
        lattice: The map's lattice.
        world: The world on it, moved by a part of a cell or not.
        match: Where the map fits best unturned, or turned by quarters.

    Returns:
        The place, and others as good at other angles; None where the map is not turned.
    """
    search = _Search(lattice, world)
    base = search.start(match)
    settled = search.settle(base, turn=False)
    found = [search.settle(settled, turn=True)]
    if match.agreement < WELL_MATCHED:
        found += [search.settle(one, turn=True) for one in search.look_everywhere()]
    found.sort(key=lambda one: -one.score)
    best = found[0]
    if as_good(settled.score, best.score) or abs(best.angle) * search.radius < _LEAST_TURN_CELLS:
        return None
    good = [one for one in found if as_good(one.score, best.score)]
    chosen = min(good, key=lambda one: (one.orientation.flipped, one.orientation.turns, abs(one.angle)))
    # What differs by quarters or a mirror alone is found again when the turned map is matched.
    others = tuple(one for one in good if abs(one.angle - chosen.angle) * search.radius > _APART)
    return search.conclude(search.polish(chosen), others)


class _Search:
    """Searches places of a map in its world, scored at any angle.

    Args:
        lattice: The map's lattice.
        world: The world on it.
    """

    def __init__(self, lattice: Lattice, world: WorldCells) -> None:
        self._origin, self._resolution = lattice.grid.origin, lattice.grid.resolution
        self._shape = lattice.grid.shape
        rows, cols = lattice.occupied
        self._middle = np.array([cols.mean(), rows.mean()]) + 0.5
        self._corner = np.array([world.col + world.phase[1], world.row + world.phase[0]])
        random = np.random.default_rng(0)
        self._many = choose_points(lattice, self._middle, _FINAL_SAMPLES, random)
        self._few = choose_points(lattice, self._middle, _SEARCH_SAMPLES, random)
        distances = np.linalg.norm(self._many.places, axis=1)
        self.radius = math.sqrt(2.0 * float((distances[self._many.weights > 0.0] ** 2).mean()))
        """Radius of a disc as wide as the map's occupied cells [cells]."""
        self._reach = float(distances.max()) + 1.0
        self._levels = make_levels(world.cells, self._reach)

    def start(self, match: Match) -> Turn:
        """Return a match as a place without a turn."""
        return Turn(match.orientation, 0.0, *start_of(match, self._shape, self._middle), -math.inf)

    def conclude(self, place: Turn, rivals: tuple[Turn, ...]) -> Turning:
        """Return the map's origin at a place, its angle a whole quarter where that is as likely."""
        old = self._origin.yaw + place.angle
        quarter = round(old / (math.pi / 2.0)) * math.pi / 2.0
        yaw = quarter if abs(old - quarter) * self.radius < _SNAP_CELLS else old
        angle = yaw - self._origin.yaw
        right, up = self._middle - rotation(angle) @ self._middle
        x, y = (right + place.x) * self._resolution, (up + place.y) * self._resolution
        moved = self._origin @ Pose2D(float(x), float(y), angle)
        return Turning(Pose2D(moved.x, moved.y, math.remainder(yaw, 2.0 * math.pi)), angle, rivals)

    def settle(self, place: Turn, *, turn: bool) -> Turn:
        """Return the best place near one, with or without turning."""
        points, level = self._many, self._levels[0]

        def around(best: Turn, step: float) -> list[Turn]:
            turns = (-step / self.radius, step / self.radius) if turn else ()
            tried = [
                replace(best, angle=best.angle + by)
                for by in turns
                if abs(best.angle + by - place.angle) < _WIDEST_FINAL
            ]
            tried += [replace(best, x=best.x + by) for by in (-step, step)]
            tried += [replace(best, y=best.y + by) for by in (-step, step)]
            return [replace(one, score=self._score(points, level, one)) for one in tried]

        return climb(replace(place, score=self._score(points, level, place)), 1.0, LAST_STEP, around)

    def polish(self, place: Turn) -> Turn:
        """Return the top of a parabola through the scores around a place, in each direction."""
        steps = np.linspace(-_PEAK_CELLS, _PEAK_CELLS, 13)
        for axis in ("angle", "x", "y") * 2:
            unit = 1.0 / self.radius if axis == "angle" else 1.0
            around = [replace(place, **{axis: getattr(place, axis) + step * unit}) for step in steps.tolist()]
            scores = [self._score(self._many, self._levels[0], one) for one in around]
            curve, slope, _ = np.polyfit(steps, scores, 2)
            if curve < 0.0:
                top = float(np.clip(-slope / (2.0 * curve), -_PEAK_CELLS, _PEAK_CELLS))
                place = replace(place, **{axis: getattr(place, axis) + top * unit})
        return place

    def _score(self, points: Points, level: Level, place: Turn) -> float:
        return float((points.weights * look_up(level, self._move(points, place))).sum())

    def _move(self, points: Points, place: Turn) -> FloatArray:
        """Return points [cells] from the world's corner when the map is put in a place."""
        return points.places @ place.matrix().T + (self._middle - self._corner + np.array([place.x, place.y]))

    def look_everywhere(self) -> list[Turn]:
        """Return the best few places at any angle."""
        places = self._correlate()
        step = self._angle_step() / 2.0
        for depth, level in enumerate(self._levels[-2::-1], start=1):
            places = [self._climb(level, place, step) for place in places]
            places.sort(key=lambda one: -one.score)
            places = self._distinct(places, float(level.block))[: _KEPT[min(depth, len(_KEPT) - 1)]]
            step /= 2.0
        return places[: _KEPT[-1]]

    def _climb(self, level: Level, place: Turn, step: float) -> Turn:
        """Climb to the best of the places that are a block and a step of the angle away."""
        best = replace(place, score=-math.inf)
        for part in (-1.0, -0.5, 0.0, 0.5, 1.0):
            turned = replace(place, angle=place.angle + part * step)
            moved = self._move(self._few, turned)
            for right, up in itertools.product((-1.0, 0.0, 1.0), repeat=2):
                by = np.array([right, up]) * level.block
                score = float((self._few.weights * look_up(level, moved + by)).sum())
                if score > best.score:
                    best = replace(turned, x=place.x + float(by[0]), y=place.y + float(by[1]), score=score)
        return best

    def _distinct(self, places: list[Turn], block: float) -> list[Turn]:
        """Drop what lies near a better place; the places are sorted."""
        kept: list[Turn] = []
        for place in places:
            near = any(
                math.hypot(place.x - other.x, place.y - other.y) <= _APART * block
                and np.linalg.norm(place.matrix() - other.matrix()) * self._reach <= 2.0 * _APART * block
                for other in kept
            )
            if not near:
                kept.append(place)
                if len(kept) == _KEPT[0]:
                    break
        return kept

    def _angle_step(self) -> float:
        return self._levels[-1].block / self._reach

    def _correlate(self) -> list[Turn]:
        """Return places on the coarsest level: the best for each angle and orientation, of these the best few."""
        level = self._levels[-1]
        walls = level.field
        reach = math.ceil(self._reach / level.block) + 1
        side = -(-(2 * reach + max(walls.shape)) // 32) * 32
        turned_worlds = [(one, one.undo(walls)) for one in ORIENTATIONS]
        spectra = [np.fft.rfft2(cells, (side, side)) for _, cells in turned_worlds]
        count = math.ceil(math.pi / 4.0 / self._angle_step())
        found: list[Turn] = []
        for index in range(-count, count):
            angle = index * (math.pi / 4.0 / count)
            moved = self._many.places @ rotation(angle).T / level.block + reach
            at = np.floor(moved).astype(np.int64)
            image = np.bincount(at[:, 1] * side + at[:, 0], weights=self._many.weights, minlength=side * side)
            signal = np.conj(np.fft.rfft2(image.reshape(side, side)))
            for (orientation, cells), spectrum in zip(turned_worlds, spectra, strict=True):
                scores = np.fft.irfft2(signal * spectrum, (side, side))
                row, col = divmod(int(np.argmax(scores)), side)
                score = float(scores[row, col])
                shift = np.array(
                    [col - side if col >= cells.shape[1] else col, row - side if row >= cells.shape[0] else row]
                )
                found.append(self._place(orientation, angle, shift + reach, cells.shape, score))
        found.sort(key=lambda one: -one.score)
        return self._distinct(found, float(level.block))

    def _place(
        self, orientation: Orientation, angle: float, middle: FloatArray, shape: tuple[int, ...], score: float
    ) -> Turn:
        """Return the place whose middle, on the world turned back, is at a block of the coarsest level."""
        level = self._levels[-1]
        back = np.array([shape[1], shape[0]]) / 2.0
        forth = np.array([level.field.shape[1], level.field.shape[0]]) / 2.0
        blocks = orient(orientation) @ (middle - back) + forth - 1.0
        x, y = blocks * level.block + self._corner - self._middle
        # A turn followed by a mirror equals the mirror followed by the opposite turn.
        return Turn(orientation, -angle if orientation.flipped else angle, float(x), float(y), score)
