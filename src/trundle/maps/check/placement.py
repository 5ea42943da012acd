"""Whether a map lies where its world is: flipped, rotated, shifted, or half a cell off."""

from __future__ import annotations

from dataclasses import dataclass, replace

from trundle.errors import MapError
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check.areas import Cells
from trundle.maps.check.finding import PLACEMENT_KINDS, Finding, Kind
from trundle.maps.check.lattice import UPRIGHT, Lattice, WorldCells
from trundle.maps.check.matching import Match, Matching, as_good, find_matches
from trundle.maps.check.placement_findings import (
    LEAST_OFFSET,
    Explanation,
    describe_findings,
    explain_placements,
    list_hidden,
)
from trundle.maps.check.stretching import Stretch, find_stretch
from trundle.maps.check.turning import Turning, find_turn
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OccupancyGrid

LEAST_AGREEMENT = 0.5
"""Below this agreement the map is considered one of another place."""

_LEAST_OCCUPIED = 8  # cells
_CLEAR = 0.97
"""A map that agrees at least this well is not tried with cells of another size."""

# A noisy map agrees best up to a cell and a half beside its place; no fault is told for that.
_NOISY = 0.9  # a map that agrees less than this is noisy, or thicker than its world
_NOISE_CELLS = 1.5  # how far that may move the place of best agreement
_NOISE_LOSS = 1.35  # if the disagreement grows by no more than this factor
_LEAST_CERTAIN = 0.5  # cells: a smaller offset is one only if the map agrees better for it


@dataclass(frozen=True, slots=True, eq=False)
class WorldSight:
    """Where a map's cells lie in its world, to look them up in it.

    Attributes:
        grid: The map, its origin turned as it must be.
        world: The world.
        match: Where the grid belongs.
    """

    grid: OccupancyGrid
    world: SolidWorld
    match: Match

    def cells(self, z_range: tuple[float, float]) -> Cells:
        """Return the map's cells in the world at some heights [m]."""
        seen = Lattice(self.grid, self.world, z_range).rasterise(self.match.phase)
        return crop_match(seen, self.match, self.grid.shape)


def crop_match(cells: WorldCells, match: Match, shape: tuple[int, int]) -> Cells:
    """Return the world's cells where a map of a shape belongs, as the map's image lies."""
    rows, cols = shape
    turned = (rows, cols) if match.orientation.turns % 2 == 0 else (cols, rows)
    return match.orientation.undo(cells.crop(match.row, match.col, turned))


@dataclass(frozen=True, slots=True, eq=False)
class PlacementCheck:
    """The result of comparing a map with its world.

    Attributes:
        findings: Errors of its place.
        unverified: Kinds that could not be determined.
        ambiguous: Kinds that the world's symmetry hides.
        remarks: The reasons for both.
        truth: The map's cells in the world, or None.
        sight: Gives them at other heights, or None.
        match: Where `grid` belongs, or None if it needs no move, or an uncertain one.
        grid: The map, its origin turned as it must be.
        is_negated: Whether the map agrees with its greys exchanged, and nowhere as it is.
    """

    findings: tuple[Finding, ...] = ()
    unverified: tuple[Kind, ...] = ()
    ambiguous: tuple[Kind, ...] = ()
    remarks: tuple[str, ...] = ()
    truth: Cells | None = None
    sight: WorldSight | None = None
    match: Match | None = None
    grid: OccupancyGrid | None = None
    is_negated: bool = False


def check_placement(
    grid: OccupancyGrid,
    world: SolidWorld | None,
    z_range: tuple[float, float],
    *,
    negated: OccupancyGrid | None = None,
) -> PlacementCheck:
    """Compare a map with its world.

    Args:
        grid: The map.
        world: The world. If None, all kinds stay unverified.
        z_range: The heights that the map shows [m].
        negated: The map read with its greys exchanged, to be tried where it agrees nowhere as it is.
    """
    if world is None:
        return _unverified("give the world to compare the map with it")
    if not _is_drawn(grid):
        return _incomparable("the map has no occupied or no free cell: there is nothing to compare")
    if (occupied := int((grid.data == OCCUPIED).sum())) < _LEAST_OCCUPIED:
        return _incomparable(f"the map has {occupied} occupied cells, too few to tell its place by")
    try:
        lattice = Lattice(grid, world, z_range)
        matching, cells = find_matches(lattice)
        turning = find_turn(lattice, cells, matching.best)
        best, turned = matching.best.agreement, None
        if turning is not None:
            turned = find_matches(Lattice(replace(grid, origin=turning.origin), world, z_range))
            if turned[0].best.agreement < max(LEAST_AGREEMENT, best):
                turned = None
            else:
                best = turned[0].best.agreement
        if best < LEAST_AGREEMENT and negated is not None and _looks_like_a_map(negated):
            exchanged, _ = find_matches(Lattice(negated, world, z_range))
            if exchanged.best.agreement >= max(LEAST_AGREEMENT, 2.0 * best):
                return _negated(best, exchanged.best.agreement)
        if best < _CLEAR:
            stretch = find_stretch(lattice, cells, matching.best, world, z_range, nowhere=best < LEAST_AGREEMENT)
            if stretch is not None and stretch.agreement >= LEAST_AGREEMENT and not as_good(best, stretch.agreement):
                return _stretched(grid, stretch, best)
    except MapError as error:
        return _incomparable(f"the world cannot be compared: {error}")
    if turning is not None and turned is not None:
        placed = replace(grid, origin=turning.origin)
        return _place(placed, world, *turned, turning, grid, matching.stated.agreement)
    if best < LEAST_AGREEMENT:
        return _mismatch(best)
    if matching.best.orientation == UPRIGHT and (
        max(map(abs, matching.best.offset)) < LEAST_OFFSET or _is_noise(matching)
    ):
        sight = WorldSight(grid, world, matching.stated)
        return _well_placed(matching, lattice.rasterise().crop(0, 0, grid.shape), sight)
    return _place(grid, world, matching, cells, None, grid, matching.stated.agreement)


def _is_drawn(grid: OccupancyGrid) -> bool:
    """Return whether a map has both occupied and free cells."""
    return bool((grid.data == OCCUPIED).any() and ((grid.data != OCCUPIED) & (grid.data != UNKNOWN)).any())


def _looks_like_a_map(grid: OccupancyGrid) -> bool:
    """Return whether less of a grid is occupied than free, as in a map that a robot can drive in."""
    occupied = int((grid.data == OCCUPIED).sum())
    return 0 < occupied < int((grid.data != UNKNOWN).sum()) - occupied


def _is_noise(matching: Matching) -> bool:
    """Return whether an offset may come from the noise of the map: without it, the map agrees hardly worse."""
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
    """Return the result for a map that does not lie where its file puts it; `grid` is the turned one."""
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
    remarks = (explain_placements(candidates, turns),) if found.placements > 1 else ()
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
    remarks = (explain_placements((matching.stated, *others)),) if others else ()
    return PlacementCheck(ambiguous=list_hidden(matching.stated, others), remarks=remarks, truth=truth, sight=sight)


def _same_result(grid: OccupancyGrid, one: Match, other: Match) -> bool:
    """Return whether two explanations lead to the same map."""
    if one.phase != other.phase or (one.row, one.col) != (other.row, other.col):
        return False
    first, second = one.orientation.apply(grid.data), other.orientation.apply(grid.data)
    return first.shape == second.shape and float((first == second).mean()) >= 0.999


def _incomparable(why: str) -> PlacementCheck:
    """Report that the world that was given could not be compared; it may still disagree with the map."""
    finding = Finding("mismatch", "warning", f"the map was not compared with the world: {why}", None, "see the reason")
    return replace(_unverified(why), findings=(finding,))


def _negated(before: float, after: float) -> PlacementCheck:
    finding = Finding(
        "negated",
        "error",
        f"the map agrees with the world with its greys exchanged, black for white (agreement {after:.0%} against "
        f"{before:.0%})",
        None,
        "exchange `negate`: 0 for 1, or 1 for 0",
    )
    return replace(_unverified("the map's greys are exchanged"), findings=(finding,), is_negated=True)


def _stretched(grid: OccupancyGrid, stretch: Stretch, before: float) -> PlacementCheck:
    """Return the result for a map that fits its world with cells of another size."""
    edge = grid.resolution
    agreement = f"(agreement {stretch.agreement:.0%} against {before:.0%})"
    if stretch.is_square:
        message = f"the map fits the world with cells of {stretch.width:g} m and not of {edge:g} m {agreement}"
        fix = f"write resolution: {stretch.width:g}, and check the map once more"
    else:
        rows, cols = grid.shape
        parts = [
            f"{abs(edge / length - 1.0):.1%} too {'long' if length < edge else 'short'} along its {name}"
            for name, length in (("width", stretch.width), ("height", stretch.height))
            if length != edge
        ]
        message = (
            f"the map is stretched against the world, {' and '.join(parts)}: cells of {stretch.width:g} x "
            f"{stretch.height:g} m fit, and not of {edge:g} m {agreement}"
        )
        width, height = round(cols * stretch.width / edge), round(rows * stretch.height / edge)
        fix = f"scale the image to {width} x {height} pixels, or make the map again; moving the origin does not help"
    finding = Finding("resolution", "error", message, None, fix)
    return replace(_unverified("the map's cells are of another size"), findings=(finding,))


def _mismatch(best: float) -> PlacementCheck:
    """Return the result for a map that agrees with its world nowhere, however it is turned, flipped, scaled or read."""
    why = f"the map agrees with the world nowhere (at best {best:.0%})"
    finding = Finding(
        "mismatch",
        "error",
        f"{why}: not flipped, turned, moved, scaled, stretched or with its greys exchanged",
        None,
        "give the world that the map shows, and the heights that it shows (--z-min, --z-max)",
    )
    return replace(_unverified(why), findings=(finding,))
