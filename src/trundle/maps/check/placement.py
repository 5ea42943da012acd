"""Whether a map lies where its world is: flipped, rotated, shifted, or half a cell off."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trundle.errors import MapError
from trundle.maps.check.areas import Cells
from trundle.maps.check.finding import PLACEMENT_KINDS, Finding, Kind
from trundle.maps.check.lattice import Lattice, WorldCells
from trundle.maps.check.matching import Match, Matching, as_good, find_matches
from trundle.maps.check.orientation import UPRIGHT
from trundle.maps.check.turning import Turning, find_turn
from trundle.maps.check.wording import LEAST_OFFSET, Explanation, describe_findings, explain_ways, list_hidden
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OCCUPIED, UNKNOWN, OccupancyGrid

LEAST_AGREEMENT = 0.5
"""Below this the map is taken for one of another place."""

_NOISY = 0.9  # a map that agrees less than this is noisy, or thicker than its world
_NOISE_CELLS = 1.5  # by so much, that may move the place where it agrees best
_NOISE_LOSS = 1.35  # where what disagrees grows by no more than this
_LEAST_CERTAIN = 0.5  # cells: a smaller offset is one only if the map agrees better for it


@dataclass(frozen=True, slots=True, eq=False)
class WorldSight:
    """Where a map's cells are in its world, to ask the world of them.

    Attributes:
        grid: The map, its origin turned as it must be.
        world: The world.
        match: Where the grid belongs.
    """

    grid: OccupancyGrid
    world: SolidWorld
    match: Match

    def cells(self, z_range: tuple[float, float]) -> Cells:
        """What the world says of the map's cells at some heights [m]."""
        seen = Lattice(self.grid, self.world, z_range).rasterise(self.match.phase)
        return crop_match(seen, self.match, self.grid.shape)


def crop_match(cells: WorldCells, match: Match, shape: tuple[int, int]) -> Cells:
    """The world's cells where a map of a shape belongs, as the map's image lies."""
    rows, cols = shape
    turned = (rows, cols) if match.orientation.turns % 2 == 0 else (cols, rows)
    return match.orientation.undo(cells.crop(match.row, match.col, turned))


@dataclass(frozen=True, slots=True, eq=False)
class PlacementCheck:
    """What came of comparing a map with its world.

    Attributes:
        findings: What is wrong with its place.
        unverified: What could not be told.
        ambiguous: What the world's symmetry hides.
        remarks: Why.
        truth: What the world says of the map's cells, or None.
        sight: How to ask it of other heights, or None.
        match: Where `grid` belongs, or None where nothing is to be moved, or it is not certain where to.
        grid: The map, its origin turned as it must be.
    """

    findings: tuple[Finding, ...] = ()
    unverified: tuple[Kind, ...] = ()
    ambiguous: tuple[Kind, ...] = ()
    remarks: tuple[str, ...] = ()
    truth: Cells | None = None
    sight: WorldSight | None = None
    match: Match | None = None
    grid: OccupancyGrid | None = None


def check_placement(grid: OccupancyGrid, world: SolidWorld | None, z_range: tuple[float, float]) -> PlacementCheck:
    """Compare a map with its world.

    Args:
        grid: The map.
        world: The world; None leaves all kinds unverified.
        z_range: The heights that the map shows [m].
    """
    if world is None:
        return _unverified("give the world to compare the map with it")
    if not (grid.data == OCCUPIED).any() or not ((grid.data != OCCUPIED) & (grid.data != UNKNOWN)).any():
        return _unverified("the map has no occupied or no free cell: there is nothing to compare")
    try:
        lattice = Lattice(grid, world, z_range)
        matching, cells = find_matches(lattice)
        turning = find_turn(lattice, cells, matching.best)
        if turning is not None:
            turned = replace(grid, origin=turning.origin)
            again, turned_cells = find_matches(Lattice(turned, world, z_range))
            if again.best.agreement >= max(LEAST_AGREEMENT, matching.best.agreement):
                return _place(turned, world, again, turned_cells, turning, grid, matching.stated.agreement)
    except MapError as error:
        return _unverified(f"the world cannot be compared: {error}")
    best = matching.best
    if best.agreement < LEAST_AGREEMENT:
        return _mismatch(grid, world, z_range, best)
    if best.orientation == UPRIGHT and (max(map(abs, best.offset)) < LEAST_OFFSET or _is_noise(matching)):
        return _well_placed(
            matching, lattice.rasterise().crop(0, 0, grid.shape), WorldSight(grid, world, matching.stated)
        )
    return _place(grid, world, matching, cells, None, grid, matching.stated.agreement)


def _is_noise(matching: Matching) -> bool:
    """Whether an offset is so small that the noise of the map explains it: without it, the map is hardly worse."""
    best, stated = matching.best, matching.stated
    offset = max(map(abs, best.offset))
    if best.agreement < _NOISY and offset <= _NOISE_CELLS:
        return 1.0 - stated.agreement <= _NOISE_LOSS * (1.0 - best.agreement)
    return offset < _LEAST_CERTAIN and as_good(stated.agreement, best.agreement)


def _place(
    grid: OccupancyGrid,
    world: SolidWorld,
    matching: Matching,
    cells: WorldCells,
    turning: Turning | None,
    stated: OccupancyGrid,
    before: float,
) -> PlacementCheck:
    """A map that does not lie where its file puts it; `grid` is the turned one."""
    best = matching.best
    candidates = (best, *matching.rivals)
    upright = [match for match in candidates if match.orientation == UPRIGHT]
    chosen = upright[0] if upright else best
    others = tuple(match for match in candidates if match is not chosen)
    turns = turning.rivals if turning is not None else ()
    certain = not turns and (
        not others or (bool(upright) and all(_same_result(grid, chosen, other) for other in others))
    )
    ambiguous = list_hidden(chosen, others if upright or not others else candidates, turns)
    angle = turning.angle if turning is not None else 0.0
    found = Explanation(grid, angle, stated.origin, chosen, others, turns, before)
    findings = describe_findings(found, certain=certain)
    remarks = (explain_ways(candidates, turns),) if found.ways > 1 else ()
    if not certain:
        return PlacementCheck(findings, ambiguous=ambiguous, remarks=remarks)
    truth = crop_match(cells, chosen, grid.shape) if chosen is best else None
    sight = WorldSight(grid, world, chosen) if chosen is best else None
    return PlacementCheck(
        findings, ambiguous=ambiguous, remarks=remarks, truth=truth, sight=sight, match=chosen, grid=grid
    )


def _unverified(why: str) -> PlacementCheck:
    return PlacementCheck(unverified=PLACEMENT_KINDS, remarks=(f"{', '.join(PLACEMENT_KINDS)}: {why}",))


def _well_placed(matching: Matching, truth: Cells, sight: WorldSight) -> PlacementCheck:
    others = matching.rivals
    remarks = (explain_ways((matching.stated, *others)),) if others else ()
    return PlacementCheck(ambiguous=list_hidden(matching.stated, others), remarks=remarks, truth=truth, sight=sight)


def _same_result(grid: OccupancyGrid, one: Match, other: Match) -> bool:
    """Whether two explanations lead to the same map."""
    if one.phase != other.phase or (one.row, one.col) != (other.row, other.col):
        return False
    first, second = one.orientation.apply(grid.data), other.orientation.apply(grid.data)
    return first.shape == second.shape and float((first == second).mean()) >= 0.999


def _mismatch(grid: OccupancyGrid, world: SolidWorld, z_range: tuple[float, float], best: Match) -> PlacementCheck:
    """A map that agrees with its world nowhere: perhaps its cells are of another size."""
    rows, cols = np.nonzero(grid.data == OCCUPIED)
    extent = np.array([np.ptp(cols) + 1, np.ptp(rows) + 1]) * grid.resolution
    low, high = world.bounds
    ratios = (np.asarray(high)[:2] - np.asarray(low)[:2]) / extent
    scale = float(ratios.mean())
    if abs(ratios[0] - ratios[1]) <= 0.03 * scale and abs(scale - 1.0) > 0.05:
        resolution = float(f"{grid.resolution * scale:.2g}")
        try:
            matching, _ = find_matches(Lattice(replace(grid, resolution=resolution), world, z_range))
        except MapError:
            matching = None
        if matching is not None and matching.best.agreement > max(2.0 * best.agreement, LEAST_AGREEMENT):
            finding = Finding(
                "resolution",
                "error",
                f"the map fits the world with cells of {resolution:g} m and not of {grid.resolution:g} m (agreement "
                f"{matching.best.agreement:.0%} against {best.agreement:.0%})",
                None,
                f"write resolution: {resolution:g}, and check the map once more",
            )
            return replace(_unverified("the map's cells are of another size"), findings=(finding,))
    return _unverified(
        f"the map agrees with the world nowhere (at best {best.agreement:.0%}): is it a map of this world, at these "
        "heights?"
    )
