"""The space of a map: unknown parts that it should know, gaps in its outer wall, and areas apart from the rest."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import mark_gaps
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.check.areas import NEIGHBOURS, SPECK_CELLS, Area, Areas, Cells, Chart, Mask, shorten
from trundle.maps.check.finding import MOST_A_KIND, Finding

WIDEST_LEAK_M = 3.0
"""A gap in an outer wall; where free and unknown cells meet along more than this [m], a part was not seen."""

_LEAST_INSIDE_SHARE = 0.05  # of the free space: an area that counts as the inside of a building
_NEAR_CELLS = 3  # around a leak, where the world's wall is drawn
_DRAW = "draw the wall there, unless it is a door that the robot may use"

UNSEEN_SHARE = 0.10
"""Unknown space of at least this share of the free space is a large part that was never seen."""

_LEAST_FREE_RIM = 0.5  # free share of a hole's rim; a walled-in hole is the inside of a thing
_LEAST_FRONT_M = 0.5  # along which a part that was not seen meets free space [m]

_BY_HAND = "drive past it once more, or paint it by hand"
_FROM_WORLD = "take it from the world's map"

_SPECK_EDGE = 2  # cells: a wider one is a thin thing


def check_unknown(chart: Chart) -> list[Finding]:
    """Find holes and unseen parts within the walls; with a world, all floor that the map lacks."""
    unknown = Areas(chart.unknown, diagonal=True)
    free, walled = unknown.beside(chart.free), unknown.beside(chart.occupied)
    inside = ~unknown.on_edge()
    hole = inside & (free > 0) & (free >= _LEAST_FREE_RIM * (free + walled))
    chart.holes = unknown.select(hole)
    if chart.truth is None:
        large = unknown.sizes >= max(1.0, UNSEEN_SHARE * chart.free_count)
        in_sight = free * chart.grid.resolution >= _LEAST_FRONT_M
        unseen = chart.list_areas(
            unknown,
            inside & large & in_sight,
            "unseen",
            "warning",
            ("{area} within the walls were never seen", "parts that were never seen"),
            "drive there and map it",
        )
    else:
        unseen = _compare_with_world(chart, chart.truth)
    return [*_list_holes(chart, unknown, hole), *unseen]


def _list_holes(chart: Chart, unknown: Areas, hole: Mask) -> list[Finding]:
    helped = chart.take_from_world("unknown_hole", chart.holes) if hole.any() else False
    large = unknown.sizes > SPECK_CELLS
    return [
        *chart.list_areas(
            unknown,
            hole & large,
            "unknown_hole",
            "warning",
            ("unknown hole of {area} in free space", "unknown holes"),
            _FROM_WORLD if helped else _BY_HAND,
        ),
        *chart.list_areas(
            unknown,
            hole & ~large,
            "speckle",
            "warning",
            ("unknown speck in free space (cells: {cells})", "specks of unknown cells"),
            _FROM_WORLD if helped else "paint it free, if nothing stands there",
        ),
    ]


def _compare_with_world(chart: Chart, truth: Cells) -> list[Finding]:
    reachable = truth == FREE
    missed = Areas(reachable & chart.unknown, diagonal=True)
    large = missed.sizes >= max(1.0, UNSEEN_SHARE * np.count_nonzero(reachable))
    if large.any():
        # With the walls and things that stand there.
        known = Areas(chart.unknown & (truth != UNKNOWN), diagonal=True)
        there = np.zeros(len(known), dtype=np.bool_)
        there[known.labels[missed.select(large)] - 1] = True
        chart.take_from_world("unseen", known.select(there))
    words = ("{area} of the world's reachable floor are unknown in the map", "parts that were never seen")
    return chart.list_areas(missed, large, "unseen", "warning", words, f"{_FROM_WORLD}, or drive there and map it")


def check_openings(chart: Chart) -> list[Finding]:
    """Find places where free space meets the unknown outside, or runs off the map."""
    unknown = Areas(chart.unknown, diagonal=True)
    outside = unknown.select(unknown.on_edge())
    free_areas = Areas(chart.free, diagonal=False)
    free = free_areas.select(free_areas.sizes > SPECK_CELLS)
    front = np.zeros(chart.grid.shape, dtype=np.bool_)
    for here, there in NEIGHBOURS:
        front[here] |= free[here] & outside[there]
    rim = np.zeros_like(front)
    rim[[0, -1], :] = free[[0, -1], :]
    rim[:, [0, -1]] = free[:, [0, -1]]
    fronts = Areas(front | rim, diagonal=True)
    if len(fronts) == 0:
        return []
    on_rim = 2 * np.bincount(fronts.labels[rim], minlength=len(fronts) + 1)[1:] > fronts.sizes
    narrow = fronts.lengths * chart.grid.resolution <= WIDEST_LEAK_M
    leaks = _list_fronts(chart, fronts, narrow, on_rim)
    runs_off = ~narrow & on_rim
    if runs_off.any():
        leaks.insert(0, _find_way_out(chart, fronts.area(int(np.argmax(np.where(runs_off, fronts.sizes, 0)))), fronts))
    open_front = ~narrow & ~on_rim & (chart.truth is None)
    return [*leaks, *_list_open(chart, fronts, open_front)]


def _list_fronts(chart: Chart, fronts: Areas, narrow: Mask, on_rim: Mask) -> list[Finding]:
    closed = _close_leaks(chart, fronts.select(narrow)) if narrow.any() else False
    fix = "draw the wall that the world has there" if closed else _DRAW
    indices = np.flatnonzero(narrow)
    indices = indices[np.argsort(-fronts.lengths[indices], kind="stable")]
    findings: list[Finding] = []
    for index in indices[: MOST_A_KIND + 1].tolist():
        beyond = "runs off the map" if on_rim[index] else "meets the unknown outside"
        length = int(fronts.lengths[index]) * chart.grid.resolution
        message = f"gap of {length:.2f} m in the outer wall: free space {beyond} there"
        findings.append(Finding("leak", "warning", message, chart.place(*fronts.middle(fronts.area(index))), fix))
    return shorten(findings, len(indices), "gaps in the outer wall")


def _list_open(chart: Chart, fronts: Areas, chosen: Mask) -> list[Finding]:
    findings: list[Finding] = []
    for index in np.flatnonzero(chosen)[: MOST_A_KIND + 1].tolist():
        length = int(fronts.lengths[index]) * chart.grid.resolution
        message = f"free space meets the unknown along {length:.1f} m without a wall: what is beyond was never seen"
        where = chart.place(*fronts.middle(fronts.area(index)))
        findings.append(Finding("unseen", "warning", message, where, "drive there and map it, or draw the wall"))
    return shorten(findings, int(np.count_nonzero(chosen)), "open stretches")


def _close_leaks(chart: Chart, front: Mask) -> bool:
    """Draw the walls that the world has around the leaks; return whether it has any."""
    if chart.truth is None:
        return False
    near = front.copy()
    for _ in range(_NEAR_CELLS):
        grown = near.copy()
        for here, there in NEIGHBOURS:
            grown[here] |= near[there]
        near = grown
    return chart.take_from_world("leak", near & (chart.truth == OCCUPIED) & ~chart.occupied)


def _find_way_out(chart: Chart, front: Area, fronts: Areas) -> Finding:
    """Return the finding for a gap between a large free area and the edge of the map, or for the lack of a wall."""
    widest = WIDEST_LEAK_M / chart.grid.resolution
    # Beyond the edge the map goes on: the edge makes no gap.
    free = np.pad(chart.free, margin := math.ceil(widest), constant_values=True)
    blocked = (~free).view(np.uint8)
    limit = 2.0
    while limit < 1.5 * widest:
        gaps = mark_gaps(blocked, min(limit, widest) + 1e-6).view(np.bool_)
        found = _find_separated(free, gaps, _LEAST_INSIDE_SHARE * chart.free_count)
        if found is not None:
            size, (row, col) = found
            return Finding(
                "leak",
                "warning",
                f"an area of {chart.square_metres(size)} is open to the edge of the map through a gap of at most "
                f"{min(limit, widest) * chart.grid.resolution:.2f} m",
                chart.place(row - margin, col - margin),
                _DRAW,
            )
        limit *= 1.5
    return Finding(
        "leak",
        "info",
        "free space runs off the map: there is no outer wall",
        chart.place(*fronts.middle(front)),
        "nothing, if the place is open: robots treat the edge of the map as a wall",
    )


def _find_separated(free: Mask, gaps: Mask, least: float) -> tuple[int, tuple[int, int]] | None:
    """Return the size [cells] of large areas that gaps part from the edge, and the middle of the smallest such gap."""
    areas = Areas(free & ~gaps, diagonal=False)
    on_edge = areas.on_edge()
    inner = ~on_edge & (areas.sizes >= least)
    if not inner.any():
        return None
    doors = Areas(gaps, diagonal=True)
    both = (doors.beside(areas.select(inner)) > 0) & (doors.beside(areas.select(on_edge)) > 0)
    if not both.any():
        return None
    smallest = int(np.argmin(np.where(both, doors.sizes, np.iinfo(np.int64).max)))
    return int(areas.sizes[inner].sum()), doors.middle(doors.area(smallest))


def check_islands(chart: Chart) -> list[Finding]:
    """Find free areas that are not connected with the largest one."""
    free = Areas(chart.free, diagonal=False)
    apart = np.ones(len(free), dtype=np.bool_)
    if len(free):
        apart[np.argmax(free.sizes)] = False
    large = free.sizes > SPECK_CELLS
    if (apart & ~large).any():
        # Nothing that a robot could use is lost.
        chart.cells[free.select(apart & ~large)] = UNKNOWN
        chart.corrected.add("speckle")
    return [
        *chart.list_areas(
            free,
            apart & large,
            "island",
            "warning",
            ("free area of {area} that cannot be reached from the largest one", "islands"),
            "make it unknown, or open the wall where there is a door",
        ),
        *chart.list_areas(
            free,
            apart & ~large,
            "speckle",
            "info",
            ("free speck that cannot be reached (cells: {cells})", "specks of free cells"),
            "make it unknown",
        ),
    ]


def check_speckles(chart: Chart) -> list[Finding]:
    """Find lone occupied cells in free space that the world, if given, does not have."""
    occupied = Areas(chart.occupied, diagonal=True)
    small = (occupied.sizes <= SPECK_CELLS) & (occupied.lengths <= _SPECK_EDGE) & ~occupied.on_edge()
    for index in np.flatnonzero(small).tolist():
        area = occupied.area(index)
        ring = np.s_[area.row - 1 : area.row_end + 1, area.col - 1 : area.col_end + 1]
        alone = np.count_nonzero(~chart.free[ring]) == area.cells
        in_world = chart.truth is not None and bool((chart.truth[ring] != FREE).any())
        small[index] = alone and not in_world
    helped = chart.take_from_world("speckle", occupied.select(small)) if small.any() else False
    return chart.list_areas(
        occupied,
        small,
        "speckle",
        "warning",
        ("occupied speck in free space (cells: {cells})", "specks of occupied cells"),
        "take it out: the world has nothing there" if helped else "take it out, if nothing thin stands there",
    )
