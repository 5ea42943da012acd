"""Obstacles of the world that the map lacks, and obstacles of the map that the world lacks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trundle.maps.cells import FREE, OCCUPIED
from trundle.maps.check.areas import Areas, Cells, Chart, Mask, grow
from trundle.maps.check.finding import Finding

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
