"""Where the inside of a map is open: gaps in the outer wall, and places beyond which nothing was seen."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import mark_gaps
from trundle.maps.cells import OCCUPIED
from trundle.maps.check.areas import NEIGHBOURS, SPECK_CELLS, Area, Areas, Chart, Mask, shorten
from trundle.maps.check.finding import MOST_A_KIND, Finding

WIDEST_LEAK_M = 3.0
"""A gap in an outer wall; where free and unknown cells meet along more than this [m], a part was not seen."""

_LEAST_INSIDE_SHARE = 0.05  # of the free space: an area that counts as the inside of a building
_NEAR_CELLS = 3  # around a leak, where the world's wall is drawn
_DRAW = "draw the wall there, unless it is a door that the robot may use"


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
    """The finding for a gap between a large free area and the edge of the map, or for the lack of a wall."""
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
    """Number of cells of the large areas that gaps part from the edge, and the middle of the smallest such gap."""
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
