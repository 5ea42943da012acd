"""The figures that are compared and required: their names, which rows their means go over, and what is better."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.evaluation.statistics.table import Table
from trundle.geometry import FloatArray


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of an episode.

    Attributes:
        name: In `--require` and in JSON: the column's name, or `success`.
        text: What it is, in words.
        unit: Unit of its values; empty for a share or a number.
        better: Whether more or less of it is better; None where neither is.
        arrived: Whether its mean goes over the episodes that arrived alone; of pairs, over those where both did.
        measured: Whether it depends on the machine.
        sensing: Whether it is of runs with lidars, movers, a localizer or recovery alone, or of one benchmark: where it
            is 0 or missing in every episode, tables and comparisons leave it out.
    """

    name: str
    text: str
    unit: str = ""
    better: Literal["more", "less"] | None = None
    arrived: bool = False
    measured: bool = False
    sensing: bool = False

    def values(self, table: Table) -> FloatArray:
        """Return its value for each row, shape (N,); NaN for those that it leaves out."""
        if self.name == "success":
            return table.arrived.astype(float)
        values = table.numbers[self.name].astype(float)
        return np.where(table.arrived, values, np.nan) if self.arrived else values

    def is_used(self, *values: FloatArray) -> bool:
        """Return whether it says anything about episodes with these values; only figures of sensing may not."""
        return not self.sensing or any(bool(np.nan_to_num(some).any()) for some in values)


FIGURES = (
    Figure("success", "success", better="more"),
    Figure("spl", "SPL", better="more"),
    Figure("time_s", "time", "s", better="less", arrived=True),
    Figure("distance_m", "distance", "m", better="less", arrived=True),
    Figure("min_clearance_m", "smallest clearance", "m", better="more", arrived=True),
    Figure("contacts", "contacts", better="less"),
    Figure("replans", "replans", better="less", arrived=True),
    Figure("max_cross_track_error_m", "cross-track error", "m", better="less", arrived=True),
    Figure("smoothness_rad_per_m", "turning", "rad/m", better="less", arrived=True),
    Figure("standing_contacts", "contacts while it stood", better="less", sensing=True),
    Figure("unseen_contacts", "contacts out of the lidars' sight", better="less", sensing=True),
    Figure("position_error_m", "error of the estimate", "m", better="less", sensing=True),
    Figure("localization_error_m", "mean error of the estimate", "m", better="less", sensing=True),
    Figure("localization_error_p95_m", "error of the estimate, 95 % of the run", "m", better="less", sensing=True),
    Figure("lost_s", "time not localized", "s", better="less", sensing=True),
    Figure("monitor_stops", "stops by the collision monitor", sensing=True),
    Figure("barn_score", "BARN score", better="more", sensing=True),
    Figure("recoveries", "steps of recovery", better="less", sensing=True),
    Figure("planning_ms", "planning", "ms", better="less", measured=True),
)
BY_NAME = {figure.name: figure for figure in FIGURES}


def mean_of_known(values: npt.NDArray[np.floating]) -> float | None:
    """Return the mean of the values that are not NaN; None if there are none."""
    known = values[~np.isnan(values)].astype(float)
    return float(known.mean()) if len(known) else None


def write_number(value: float) -> str:
    """Write a number with three or four digits and at most four decimals, as tables have it; a dash for none."""
    if math.isnan(value):
        return "–"
    size = abs(value)
    if size >= 100.0:
        return f"{value:.0f}" if size >= 1000.0 else f"{value:.1f}"
    decimals = 4 if size < 0.001 else min(4, 2 - math.floor(math.log10(size)))
    return f"{round(value, decimals) + 0.0:g}"


def write_share(share: float, n: int) -> str:
    """Write a share in percent, with the decimals that `n` episodes warrant; only all of them are 100 %."""
    decimals = 1 if n < 2000 else 2
    text = f"{100.0 * share:.{decimals}f}"
    full = f"{100.0:.{decimals}f}"
    if text == full and share < 1.0:
        text = f"{100.0 - 10.0**-decimals:.{decimals}f}"
    return f"{text.removesuffix('.' + '0' * decimals)} %"
