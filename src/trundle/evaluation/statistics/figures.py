"""The figures that are compared and required: their names, which rows their means go over, and what is better."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from trundle.evaluation.statistics.table import Table
from trundle.geometry import FloatArray


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of an episode.

    Attributes:
        name: In `--require` and in JSON: the column's name, or `success`.
        text: What it is, in words.
        unit: Of its values; empty for a share or a number.
        better: Whether more or less of it is better; None where neither is.
        arrived: Whether its mean goes over the episodes that arrived alone; of pairs, over those where both did.
        measured: Whether it depends on the machine.
    """

    name: str
    text: str
    unit: str = ""
    better: Literal["more", "less"] | None = None
    arrived: bool = False
    measured: bool = False

    def values(self, table: Table) -> FloatArray:
        """Its value for each row, shape (N,); NaN for those that it leaves out."""
        if self.name == "success":
            return table.arrived.astype(float)
        values = table.numbers[self.name].astype(float)
        return np.where(table.arrived, values, np.nan) if self.arrived else values


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
    Figure("planning_ms", "planning", "ms", better="less", measured=True),
)
BY_NAME = {figure.name: figure for figure in FIGURES}


def write_number(value: float) -> str:
    """A number with three or four digits, as tables have it; a dash for none."""
    if np.isnan(value):
        return "–"
    if abs(value) >= 1000.0:
        return f"{value:.0f}"
    text = f"{value:.3g}"
    return f"{value:.1f}" if abs(value) >= 100.0 and "e" not in text else (f"{value:.4f}" if "e" in text else text)


def write_share(share: float, n: int) -> str:
    """A share in percent, with the decimals that `n` episodes warrant; only all of them are 100 %."""
    decimals = 1 if n < 2000 else 2
    text = f"{100.0 * share:.{decimals}f}"
    full = f"{100.0:.{decimals}f}"
    if text == full and share < 1.0:
        text = f"{100.0 - 10.0**-decimals:.{decimals}f}"
    return f"{text.removesuffix('.' + '0' * decimals)} %"
