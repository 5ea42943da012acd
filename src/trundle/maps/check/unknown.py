"""Unknown space that a map should know: holes in rooms, and large parts that were never seen."""

from __future__ import annotations

import numpy as np

from trundle.maps.cells import FREE, UNKNOWN
from trundle.maps.check.areas import SPECK_CELLS, Areas, Cells, Chart, Mask
from trundle.maps.check.finding import Finding

UNSEEN_SHARE = 0.10
"""Unknown space of at least this share of the free space is a large part that was never seen."""

_LEAST_FREE_RIM = 0.5  # free share of a hole's rim; a walled-in hole is the inside of a thing
_LEAST_FRONT_M = 0.5  # along which a part that was not seen meets free space [m]

_BY_HAND = "drive past it once more, or paint it by hand"
_FROM_WORLD = "take it from the world's map"


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
