"""Free areas that cannot be reached, and specks: a few cells that are probably noise."""

from __future__ import annotations

import numpy as np

from trundle.maps.cells import FREE, UNKNOWN
from trundle.maps.check.areas import SPECK_CELLS, Areas, Chart
from trundle.maps.check.finding import Finding

_SPECK_EDGE = 2  # cells: a wider one is a thin thing


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
