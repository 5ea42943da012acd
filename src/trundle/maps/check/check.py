"""Checking a map: its file, its image, its place in the world, its space, and a robot's paths through it."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from trundle.errors import InputError, MapError
from trundle.files.opening import is_file
from trundle.files.yaml_nodes import read_text
from trundle.geometry import Pose2D
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.check.areas import Areas, Cells, Chart, Mask, grow
from trundle.maps.check.finding import PLACEMENT_KINDS, Finding, Kind, MapReport, by_severity
from trundle.maps.check.map_file import check_description, read_map
from trundle.maps.check.placement import PlacementCheck, check_placement
from trundle.maps.check.placement_findings import apply_match
from trundle.maps.check.reach import check_doors, check_reach
from trundle.maps.check.space import check_islands, check_openings, check_speckles, check_unknown
from trundle.maps.from_world import SolidWorld
from trundle.maps.grid import OccupancyGrid
from trundle.maps.occupancy import Compat
from trundle.maps.resample import resample_axis_aligned
from trundle.maps.ros_yaml import MAX_YAML_BYTES
from trundle.robots import Robot

LEAST_AREA = 0.09
"""A smaller area [m²] is no finding: 0.1 m² less what rounding to cells takes off."""

TOLERANCE = 2
"""How far [cells] a map's walls may be off, as in a noisy map or one with thicker walls."""

_MOSTLY = 0.5  # of an area beyond the tolerance, or beside such cells, make all of it one


@dataclass(frozen=True, slots=True, eq=False)
class Contradictions:
    """Where a map and its world have different obstacles.

    Attributes:
        missing: Obstacles that the map lacks.
        phantom: Obstacles that the world lacks.
    """

    missing: Areas
    phantom: Areas

    def count(self, chart: Chart) -> int:
        """Count the map's cells in areas that are large enough for a finding."""
        return sum(int(areas.sizes[_is_large(chart, areas)].sum()) for areas in (self.missing, self.phantom))


def compare_obstacles(chart: Chart, truth: Cells) -> Contradictions:
    """Compare a map's obstacles with the world's."""
    solid = truth == OCCUPIED
    missing = _find_areas(solid & chart.free, chart.occupied)
    return Contradictions(missing, _find_areas(chart.occupied & (truth == FREE), solid))


def list_obstacles(chart: Chart, found: Contradictions) -> list[Finding]:
    """List the findings. Missing obstacles are corrected from the world; phantom ones only the maker can judge."""
    missing, phantom = found.missing, found.phantom
    lacking = missing.select(_is_large(chart, missing))
    if lacking.any():
        chart.cells[lacking] = OCCUPIED
        chart.corrected.add("missing_obstacle")
    return [
        *chart.list_areas(
            missing,
            _is_large(chart, missing),
            "missing_obstacle",
            "error",
            (
                "the world has an obstacle of {size} here, and the map is free",
                "obstacles of the world that the map lacks",
            ),
            "take it from the world's map",
        ),
        *chart.list_areas(
            phantom,
            _is_large(chart, phantom),
            "phantom_obstacle",
            "error",
            ("the map has an obstacle of {size} here, and the world is free", "obstacles that the world lacks"),
            "take it out, or put it into the world if it does stand there",
        ),
    ]


def _find_areas(differs: Mask, obstacles: Mask) -> Areas:
    """Find connected areas of cells that differ, each partly beyond the tolerance from an obstacle of the other map."""
    core = differs & ~grow(obstacles, TOLERANCE)
    # With what is within the tolerance, but not all of a wall that is a cell off.
    near = differs & grow(core, TOLERANCE + 1)
    whole = Areas(differs, diagonal=True)
    shares = np.bincount(whole.labels[near], minlength=len(whole) + 1)[1:] / np.maximum(whole.sizes, 1)
    return Areas(near | whole.select(shares >= _MOSTLY), diagonal=True)


def _is_large(chart: Chart, areas: Areas) -> Mask:
    return areas.sizes * chart.grid.resolution**2 >= LEAST_AREA


DEFAULT_ROBOT = "nova_carter"
"""Whose height band `DEFAULT_Z_RANGE` is."""

DEFAULT_Z_RANGE = (0.10, 0.62)


def check_map(
    path: str | os.PathLike[str],
    *,
    world: SolidWorld | None = None,
    robot: Robot | None = None,
    start: Pose2D | Sequence[float] | None = None,
    goals: Sequence[Pose2D | Sequence[float]] = (),
    z_range: tuple[float, float] | None = None,
    compat: Compat | None = None,
    allow_outside: bool = False,
    max_cells: int | None = None,
) -> MapReport:
    """Find everything that is wrong with a map.

    Args:
        path: The map's YAML file, or a MovingAI map.
        world: The world that it shows; without one, a map that is flipped, rotated, shifted or half a cell off looks
            like any other.
        robot: The robot whose paths through doors, and from start to goals, are checked.
        start: Where a robot starts [m, m, rad], map frame.
        goals: Its goals [m, m, rad], map frame.
        z_range: The heights of the world that the map shows [m]; by default the robot's.
        compat: As for `OccupancyGrid.load`.
        allow_outside: As for `OccupancyGrid.load`.
        max_cells: As for `OccupancyGrid.load`.

    Returns:
        The report. Mistakes that keep the map from loading are findings, not exceptions.

    Raises:
        MapError: If there is no such file, or it cannot be read as text.
    """
    source = Path(path)
    if not is_file(source):
        raise MapError(f"{source}: there is no such map file; give the YAML file of a map")
    findings: list[Finding] = []
    corrected: set[Kind] = set()
    negated: OccupancyGrid | None = None
    if source.suffix.lower() == ".map":
        try:
            grid = OccupancyGrid.load(source, max_cells=max_cells)
        except MapError as error:
            return _unreadable([Finding("yaml", "error", str(error), None, "correct the file")])
    else:
        try:
            read_text(source, MAX_YAML_BYTES)
        except InputError as error:
            raise MapError(f"{error}. Give the YAML file of a map, and not its image") from error
        described = check_description(source)
        findings += described.findings
        if described.description is None:
            return _unreadable(findings)
        read = partial(read_map, compat=compat, allow_outside=allow_outside, max_cells=max_cells)
        grid, found, put_right = read(source, described.description)
        findings += found
        if grid is None:
            return _unreadable(findings)
        corrected |= {*described.corrected, *put_right}
        if world is not None and described.description.rule.mode != "raw":
            rule = dataclasses.replace(described.description.rule, negate=not described.description.rule.negate)
            exchanged = dataclasses.replace(described.description, rule=rule)
            negated = read(source, exchanged).grid
    report = _check(grid, negated, world=world, robot=robot, start=start, goals=goals, z_range=z_range)
    return dataclasses.replace(
        report,
        findings=by_severity([*findings, *report.findings]),
        corrected=report.corrected if report.corrected is not None else (grid if corrected else None),
        corrected_kinds=tuple(sorted(corrected | set(report.corrected_kinds))),
    )


def check_grid(
    grid: OccupancyGrid,
    *,
    world: SolidWorld | None = None,
    robot: Robot | None = None,
    start: Pose2D | Sequence[float] | None = None,
    goals: Sequence[Pose2D | Sequence[float]] = (),
    z_range: tuple[float, float] | None = None,
) -> MapReport:
    """Find everything that is wrong with a grid: the checks of `check_map` that need no file."""
    return _check(grid, None, world=world, robot=robot, start=start, goals=goals, z_range=z_range)


def _check(
    grid: OccupancyGrid,
    negated: OccupancyGrid | None,
    *,
    world: SolidWorld | None,
    robot: Robot | None,
    start: Pose2D | Sequence[float] | None,
    goals: Sequence[Pose2D | Sequence[float]],
    z_range: tuple[float, float] | None,
) -> MapReport:
    """Check a grid, with its greys exchanged where only that agrees with the world."""
    heights = z_range or (robot.z_range if robot is not None else DEFAULT_Z_RANGE)
    negated = _exchange(grid) if negated is None else negated
    placed = check_placement(grid, world, heights, negated=negated)
    read: tuple[Finding, ...] = ()
    if placed.is_negated:
        read, grid = placed.findings, negated
        placed = check_placement(grid, world, heights)
    chart = Chart(grid, placed.truth)
    obstacles, remarks = _check_obstacles(chart, placed, heights)
    findings = [
        *read,
        *placed.findings,
        *_check_yaw(grid),
        *obstacles,
        *check_unknown(chart),
        *check_openings(chart),
        *check_islands(chart),
        *check_speckles(chart),
        *(check_doors(chart, robot) if robot is not None else ()),
        *check_reach(chart, robot, None if start is None else Pose2D.of(start), [Pose2D.of(goal) for goal in goals]),
    ]
    corrected, kinds = _correct(chart, placed)
    if read:
        exchanged: set[Kind] = {*kinds, "negated"}
        corrected, kinds = corrected or grid, tuple(sorted(exchanged))
    return MapReport(
        findings=by_severity(findings),
        unverified=placed.unverified,
        ambiguous=placed.ambiguous,
        remarks=(*placed.remarks, *remarks),
        grid=grid,
        corrected=corrected,
        corrected_kinds=kinds,
    )


def _exchange(grid: OccupancyGrid) -> OccupancyGrid:
    """Return a grid with free and occupied cells exchanged."""
    cells = np.where(grid.data == UNKNOWN, UNKNOWN, OCCUPIED - grid.data).astype(np.int8)
    return OccupancyGrid(cells, grid.resolution, grid.origin, grid.surface)


def _check_obstacles(
    chart: Chart, placed: PlacementCheck, heights: tuple[float, float]
) -> tuple[list[Finding], tuple[str, ...]]:
    """Compare obstacles with the world's at the heights that the map seems to show: the given or the usual ones."""
    if placed.truth is None or placed.sight is None:
        return [], ()
    found = compare_obstacles(chart, placed.truth)
    differing = found.count(chart)
    if differing and heights != DEFAULT_Z_RANGE:
        other = compare_obstacles(chart, placed.sight.cells(DEFAULT_Z_RANGE))
        if other.count(chart) < differing:
            low, high = DEFAULT_Z_RANGE
            why = (
                f"missing_obstacle, phantom_obstacle: the map shows heights of {low:g} to {high:g} m, and not of "
                f"{heights[0]:g} to {heights[1]:g} m: obstacles were compared at those"
            )
            return list_obstacles(chart, other), (why,)
    return list_obstacles(chart, found), ()


def _unreadable(findings: list[Finding]) -> MapReport:
    why = f"{', '.join(PLACEMENT_KINDS)}: the map cannot be read"
    return MapReport(by_severity(findings), unverified=PLACEMENT_KINDS, remarks=(why,))


def _check_yaw(grid: OccupancyGrid) -> list[Finding]:
    yaw = grid.origin.yaw
    if yaw == 0.0:
        return []
    quarters = yaw / (math.pi / 2.0)
    loss = "" if abs(quarters - round(quarters)) < 1e-9 else ", each obstacle up to a cell thicker"
    return [
        Finding(
            "yaw_ignored",
            "warning",
            f"the origin has a yaw of {math.degrees(yaw):g}°: Nav2's costmaps ignore it, and the map lies turned there",
            (grid.origin.x, grid.origin.y),
            f"make the map axis-aligned{loss}",
        )
    ]


def _correct(chart: Chart, placed: PlacementCheck) -> tuple[OccupancyGrid | None, tuple[Kind, ...]]:
    grid = chart.grid
    kinds: set[Kind] = set(chart.corrected)
    made = dataclasses.replace(grid, data=chart.cells) if kinds else grid
    if placed.match is not None and placed.grid is not None:
        made = apply_match(placed.grid, made.data, placed.match)
        kinds |= {finding.kind for finding in placed.findings}
    if made.origin.yaw != 0.0:
        made = _free_of_specks(resample_axis_aligned(made))
    if grid.origin.yaw != 0.0 and made.origin.yaw == 0.0:
        kinds.add("yaw_ignored")
    return (made, tuple(sorted(kinds))) if kinds else (None, ())


def _free_of_specks(grid: OccupancyGrid) -> OccupancyGrid:
    """Return a rotated map without the specks of free cells that remain between thickened obstacles."""
    chart = Chart(grid)
    check_islands(chart)
    return dataclasses.replace(grid, data=chart.cells) if chart.corrected else grid
