"""Whether a map lies where its world is: flipped, rotated, shifted, or half a cell off."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps.check.areas import Cells
from trundle.maps.check.finding import PLACEMENT_KINDS, Finding, Kind
from trundle.maps.check.lattice import Lattice
from trundle.maps.check.matching import Match, Matching, find_matches
from trundle.maps.check.orientation import UPRIGHT
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OCCUPIED, UNKNOWN, OccupancyGrid

LEAST_AGREEMENT = 0.5
"""Below this the map is taken for one of another place."""

_LEAST_OFFSET = 0.375  # cells: a smaller one is none


@dataclass(frozen=True, slots=True, eq=False)
class PlacementCheck:
    """What came of comparing a map with its world.

    Attributes:
        findings: What is wrong with its place.
        unverified: What could not be told.
        ambiguous: What the world's symmetry hides.
        remarks: Why.
        truth: What the world says of the map's cells, or None.
        corrected: The map where it belongs, or None where nothing is to be moved, or it is not certain where to.
        corrected_kinds: What that puts right.
    """

    findings: tuple[Finding, ...] = ()
    unverified: tuple[Kind, ...] = ()
    ambiguous: tuple[Kind, ...] = ()
    remarks: tuple[str, ...] = ()
    truth: Cells | None = None
    match: Match | None = None


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
        matching, cells = find_matches(Lattice(grid, world, z_range))
    except MapError as error:
        return _unverified(f"the world cannot be compared: {error}")
    best = matching.best
    if best.agreement < LEAST_AGREEMENT:
        return _mismatch(grid, world, z_range, best)
    if best.orientation == UPRIGHT and max(map(abs, best.offset)) < _LEAST_OFFSET:
        return _well_placed(grid, matching, Lattice(grid, world, z_range).rasterise().crop(0, 0, grid.shape))
    candidates = (best, *matching.rivals)
    upright = [match for match in candidates if match.orientation == UPRIGHT]
    chosen = upright[0] if upright else best
    others = tuple(match for match in candidates if match is not chosen)
    certain = not others or (bool(upright) and all(_same_result(grid, chosen, other) for other in others))
    ambiguous = _hidden_kinds(chosen, others if upright or not others else candidates)
    findings = _describe(grid, chosen, others, certain=certain)
    remarks = (_explain(candidates),) if others else ()
    if not certain:
        return PlacementCheck(findings, ambiguous=ambiguous, remarks=remarks)
    rows, cols = grid.shape
    shape = (rows, cols) if chosen.orientation.turns % 2 == 0 else (cols, rows)
    truth = chosen.orientation.undo(cells.crop(chosen.row, chosen.col, shape)) if chosen is best else None
    return PlacementCheck(findings, ambiguous=ambiguous, remarks=remarks, truth=truth, match=chosen)


def apply_match(grid: OccupancyGrid, cells: Cells, match: Match) -> OccupancyGrid:
    """Put cells of a map where they belong."""
    dx, dy = match.offset
    corner = grid.origin @ Pose2D(dx * grid.resolution, dy * grid.resolution)
    return OccupancyGrid(match.orientation.apply(cells), grid.resolution, _tidy(corner))


def _tidy(pose: Pose2D) -> Pose2D:
    return Pose2D(round(pose.x, 9), round(pose.y, 9), pose.yaw)


def _unverified(why: str) -> PlacementCheck:
    return PlacementCheck(unverified=PLACEMENT_KINDS, remarks=(f"{', '.join(PLACEMENT_KINDS)}: {why}",))


def _well_placed(grid: OccupancyGrid, matching: Matching, truth: Cells) -> PlacementCheck:
    others = matching.rivals
    remarks = (_explain((matching.stated, *others)),) if others else ()
    return PlacementCheck(ambiguous=_hidden_kinds(matching.stated, others), remarks=remarks, truth=truth)


def _hidden_kinds(chosen: Match, others: tuple[Match, ...]) -> tuple[Kind, ...]:
    kinds: set[Kind] = set()
    for match in others:
        if match.orientation == chosen.orientation and match is not chosen:
            kinds.add("shifted")
        kinds.update(match.orientation.kinds)
    return tuple(kind for kind in PLACEMENT_KINDS if kind in kinds)


def _explain(candidates: tuple[Match, ...]) -> str:
    places = "; ".join(f"{_name(match)} (agreement {match.agreement:.0%})" for match in candidates[:4])
    return f"the world looks the same in {len(candidates)} ways: {places}"


def _name(match: Match) -> str:
    dx, dy = match.offset
    turned = "as it is" if match.orientation == UPRIGHT else match.orientation.describe().partition(":")[2].strip()
    return f"{turned}, moved by ({dx:g}, {dy:g}) cells"


def _same_result(grid: OccupancyGrid, one: Match, other: Match) -> bool:
    """Whether two explanations lead to the same map."""
    if one.phase != other.phase or (one.row, one.col) != (other.row, other.col):
        return False
    first, second = one.orientation.apply(grid.data), other.orientation.apply(grid.data)
    return first.shape == second.shape and float((first == second).mean()) >= 0.999


def _describe(grid: OccupancyGrid, match: Match, others: tuple[Match, ...], *, certain: bool) -> tuple[Finding, ...]:
    dx, dy = match.offset
    origin = apply_match(grid, grid.data, match).origin
    rows, cols = grid.shape
    x, y = grid.cell_to_world((rows - 1) / 2.0, (cols - 1) / 2.0)
    where = (float(x), float(y))
    place = f"[{origin.x:.6g}, {origin.y:.6g}, {origin.yaw:.6g}]"
    found: list[tuple[Kind, str, str]] = []
    for kind in match.orientation.kinds:
        fix = f"bring the image right and write origin: {place}"
        if kind == "rotated" and not match.orientation.flipped:
            turned = _turned_origin(grid, match)
            fix += (
                f"; or leave it and write origin: [{turned.x:.6g}, {turned.y:.6g}, {turned.yaw:.6g}], a yaw of "
                f"{math.degrees(turned.yaw - grid.origin.yaw):g}°, which Nav2 ignores"
            )
        message = f"the image is {match.orientation.describe()} (agreement {match.agreement:.0%})"
        found.append((kind, message, fix))
    turn = Pose2D(0.0, 0.0, grid.origin.yaw)
    right, up = turn.transform_points([[dx * grid.resolution, dy * grid.resolution]])[0].round(9) + 0.0
    size = f"({dx:+g}, {dy:+g}) cells, ({right:+.4g}, {up:+.4g}) m"
    parts = [abs(number - round(number)) for number in (dx, dy)]
    below_one = max(abs(dx), abs(dy)) < 1.0
    if max(parts) >= _LEAST_OFFSET and (below_one or match.orientation.turns % 2):
        found.append(
            (
                "half_cell",
                f"the origin is a part of a cell off: the map must be moved by {size}, as when the centre of the first "
                "cell is written and not its corner",
                f"write origin: {place}",
            )
        )
    elif max(abs(dx), abs(dy)) >= _LEAST_OFFSET and match.orientation.turns % 2 == 0:
        found.append(("shifted", f"the map must be moved by {size} to lie on the world", f"write origin: {place}"))
    if not certain:
        ways = 1 + len(others)
        note = f"nothing is put right by itself: the world looks the same in {ways} ways; find out which one is meant"
        return tuple(Finding(kind, "error", message, where, f"{fix}; {note}") for kind, message, fix in found)
    return tuple(Finding(kind, "error", message, where, fix) for kind, message, fix in found)


def _turned_origin(grid: OccupancyGrid, match: Match) -> Pose2D:
    """The origin that puts the image, as it is, where it belongs."""
    rows, cols = (side * grid.resolution for side in grid.shape)
    corner = apply_match(grid, grid.data, match).origin
    across = {0: (0.0, 0.0), 1: (rows, 0.0), 2: (cols, rows), 3: (0.0, cols)}[match.orientation.turns]
    return _tidy(corner @ Pose2D(*across, match.orientation.yaw))


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
