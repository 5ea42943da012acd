"""Findings for a map that does not lie on its world."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from trundle.geometry import Pose2D
from trundle.maps.check.areas import Cells
from trundle.maps.check.finding import PLACEMENT_KINDS, Finding, Kind
from trundle.maps.check.lattice import UPRIGHT
from trundle.maps.check.matching import Match
from trundle.maps.check.turning import Turn
from trundle.maps.grid import OccupancyGrid

LEAST_OFFSET = 0.375
"""The least offset that counts [cells]."""

_PIVOT_CELLS = 3.0  # how far the point about which a map is turned may move


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """A possible error of a map's place.

    Attributes:
        grid: The map, its origin turned as `angle` says.
        angle: Angle by which it must be turned [rad], beside quarter turns.
        stated: The map's origin as the file has it.
        match: Where the turned map belongs.
        others: Other places where it belongs as well.
        turns: Such places at other angles.
        before: Its agreement before it was turned, 0 to 1.
    """

    grid: OccupancyGrid
    angle: float
    stated: Pose2D
    match: Match
    others: tuple[Match, ...]
    turns: tuple[Turn, ...]
    before: float

    @property
    def placements(self) -> int:
        """Number of placements in which the map fits."""
        return 1 + len(self.others) + len(self.turns)


def apply_match(grid: OccupancyGrid, cells: Cells, match: Match) -> OccupancyGrid:
    """Put cells of a map where they belong."""
    dx, dy = match.offset
    corner = grid.origin @ Pose2D(dx * grid.resolution, dy * grid.resolution)
    return replace(grid, data=match.orientation.apply(cells), origin=_tidy(corner))


def describe_findings(found: Explanation, *, certain: bool) -> tuple[Finding, ...]:
    """Return all errors of a map's place."""
    items = [*_describe_image(found), *(_describe_turn(found) if found.angle else _describe_offset(found))]
    note = ""
    if not certain:
        note = (
            f"; nothing is corrected automatically: the world looks the same in {found.placements} ways; find out "
            "which one is meant"
        )
    stated = replace(found.grid, origin=found.stated)
    rows, cols = stated.shape
    x, y = stated.cell_to_world((rows - 1) / 2.0, (cols - 1) / 2.0)
    where = (float(x), float(y))
    return tuple(Finding(kind, "error", message, where, f"{fix}{note}") for kind, message, fix in items)


def explain_placements(candidates: tuple[Match, ...], turns: tuple[Turn, ...] = ()) -> str:
    """Return the placements in which a map fits its world."""
    names = [f"{_name(match)} (agreement {match.agreement:.0%})" for match in candidates]
    names += [f"turned by {math.degrees(turn.angle):+.1f}°" + _name_image(turn) for turn in turns]
    return f"the world looks the same in {len(names)} ways: {'; '.join(names[:4])}"


def list_hidden(chosen: Match, others: tuple[Match, ...], turns: tuple[Turn, ...] = ()) -> tuple[Kind, ...]:
    """Return the kinds of mistakes that cannot be seen because the map fits in several places."""
    kinds: set[Kind] = {"rotated"} if turns else set()
    for turn in turns:
        kinds.update(turn.orientation.kinds)
    for match in others:
        if match.orientation == chosen.orientation and match is not chosen:
            kinds.add("shifted")
        kinds.update(match.orientation.kinds)
    return tuple(kind for kind in PLACEMENT_KINDS if kind in kinds)


def _describe_image(found: Explanation) -> list[tuple[Kind, str, str]]:
    """Return the error of an image that is flipped, or turned by quarters."""
    grid, match = found.grid, found.match
    place = _write_origin(apply_match(grid, grid.data, match).origin)
    items: list[tuple[Kind, str, str]] = []
    for kind in match.orientation.kinds:
        if kind == "rotated" and found.angle:
            continue  # The angle is reported as a whole.
        fix = f"bring the image right and write {place}"
        if kind == "rotated" and not match.orientation.flipped:
            turned = _turned_origin(grid, match)
            fix += (
                f"; or leave it and write {_write_origin(turned)}, a yaw of "
                f"{math.degrees(turned.yaw - grid.origin.yaw):g}°, which Nav2 ignores"
            )
        items.append((kind, f"the image is {match.orientation.describe()} (agreement {match.agreement:.0%})", fix))
    return items


def _describe_turn(found: Explanation) -> list[tuple[Kind, str, str]]:
    """Return the error of a map that is turned by an angle other than a quarter turn."""
    grid, match = found.grid, found.match
    angle = math.remainder(found.angle + match.orientation.yaw, 2.0 * math.pi)
    if match.orientation.flipped:
        new = apply_match(grid, grid.data, match).origin
        fix = f"bring the image right and write {_write_origin(new)}"
    else:
        new = _turned_origin(grid, match)
        fix = f"write {_write_origin(new)}"
    if new.yaw != 0.0:
        fix += "; Nav2 ignores that yaw: then make the map axis-aligned, as --fix does"
    about, (dx, dy) = _find_pivot(found, new)
    message = (
        f"the map is turned against the world: it must be turned {math.degrees(abs(angle)):.2f}° "
        f"{'counter-clockwise' if angle > 0.0 else 'clockwise'} about {about} (agreement {match.agreement:.0%}, as it "
        f"is {found.before:.0%})"
    )
    items: list[tuple[Kind, str, str]] = [("rotated", message, fix)]
    if max(abs(dx), abs(dy)) > _PIVOT_CELLS:
        edge = grid.resolution
        items.append(
            (
                "shifted",
                f"turned about its middle, the map must be moved by ({dx:+.1f}, {dy:+.1f}) cells, "
                f"({dx * edge:+.4g}, {dy * edge:+.4g}) m, as well",
                fix,
            )
        )
    return items


def _find_pivot(found: Explanation, new: Pose2D) -> tuple[str, tuple[float, float]]:
    """Find the point about which a map is turned, and how far (x, y) [cells] it must be moved as well, map frame."""
    grid, match = found.grid, found.match
    rows, cols = (side * grid.resolution for side in grid.shape)
    (old,) = found.stated.transform_points([[cols / 2.0, rows / 2.0]])
    placed = apply_match(grid, grid.data, match)
    height, width = (side * grid.resolution for side in placed.shape)
    (middle,) = placed.origin.transform_points([[width / 2.0, height / 2.0]])
    moved = (middle - old) / grid.resolution
    if abs(moved).max() > _PIVOT_CELLS and not match.orientation.flipped:
        motion = new @ found.stated.inverse()
        for name, point in (
            ("its lower-left corner", (found.stated.x, found.stated.y)),
            ("the map frame's origin", (0.0, 0.0)),
        ):
            (there,) = motion.transform_points([point])
            if abs(there - point).max() <= _PIVOT_CELLS * grid.resolution:
                return name, (0.0, 0.0)
    return "its middle", (float(moved[0]), float(moved[1]))


def _describe_offset(found: Explanation) -> list[tuple[Kind, str, str]]:
    """Return the error of a map that is moved and not turned."""
    grid, match = found.grid, found.match
    dx, dy = match.offset
    fix = f"write {_write_origin(apply_match(grid, grid.data, match).origin)}"
    turn = Pose2D(0.0, 0.0, grid.origin.yaw)
    right, up = turn.transform_points([[dx * grid.resolution, dy * grid.resolution]])[0].round(9) + 0.0
    size = f"({dx:+g}, {dy:+g}) cells, ({right:+.4g}, {up:+.4g}) m"
    parts = [abs(number - round(number)) for number in (dx, dy)]
    below_one = max(abs(dx), abs(dy)) < 1.0
    if max(parts) >= LEAST_OFFSET and (below_one or match.orientation.turns % 2):
        message = (
            f"the origin is a part of a cell off: the map must be moved by {size}, as when the centre of the first "
            "cell is written and not its corner"
        )
        return [("half_cell", message, fix)]
    if max(abs(dx), abs(dy)) >= LEAST_OFFSET and match.orientation.turns % 2 == 0:
        return [("shifted", f"the map must be moved by {size} to lie on the world", fix)]
    return []


def _name(match: Match) -> str:
    dx, dy = match.offset
    turned = "as it is" if match.orientation == UPRIGHT else match.orientation.describe().partition(":")[2].strip()
    return f"{turned}, moved by ({dx:g}, {dy:g}) cells"


def _name_image(turn: Turn) -> str:
    return "" if turn.orientation == UPRIGHT else f", {turn.orientation.describe().partition(':')[2].strip()}"


def _turned_origin(grid: OccupancyGrid, match: Match) -> Pose2D:
    """Return the origin that puts the image, as it is, where it belongs."""
    rows, cols = (side * grid.resolution for side in grid.shape)
    corner = apply_match(grid, grid.data, match).origin
    across = {0: (0.0, 0.0), 1: (rows, 0.0), 2: (cols, rows), 3: (0.0, cols)}[match.orientation.turns]
    return _tidy(corner @ Pose2D(*across, match.orientation.yaw))


def _write_origin(pose: Pose2D) -> str:
    return f"origin: [{pose.x:.6g}, {pose.y:.6g}, {pose.yaw:.6g}]"


def _tidy(pose: Pose2D) -> Pose2D:
    return Pose2D(round(pose.x, 9), round(pose.y, 9), pose.yaw)
