"""The figures of a public benchmark, from the rows of its evaluation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from trundle.evaluation.statistics import Table
from trundle.evaluation.statistics.table import Names


def barn_figures(table: Table, rows: npt.NDArray[np.bool_] | None = None) -> Mapping[str, float | None]:
    """The means of BARN: of the score over all runs, of the times [s] over those that arrived."""
    every = np.ones(len(table), dtype=bool) if rows is None else rows
    arrived = every & table.arrived
    times, shortest = (table.numbers[name].astype(float) for name in ("time_s", "shortest_time_s"))
    return {
        "barn_score": _mean(table.numbers["barn_score"][every]),
        "mean_time_s": _mean(times[arrived]),
        "mean_shortest_time_s": _mean(shortest[arrived]),
    }


def dynabarn_figures(table: Table) -> Mapping[str, float | None]:
    """The shares of success of DynaBARN's levels, and the mean time [s] of the runs that arrived."""
    shares = {
        f"success_{level}": _mean(table.arrived[of_level].astype(float))
        for level, of_level in rows_by_level(table).items()
    }
    return {**shares, "mean_time_s": _mean(table.numbers["time_s"][table.arrived])}


def rows_by_level(table: Table) -> dict[str, npt.NDArray[np.bool_]]:
    """Which rows are of which of DynaBARN's levels, in order of appearance."""
    worlds: Names = table.named["world"]
    levels = [name.partition("/")[0] for name in worlds.names]
    return {level: np.array([each == level for each in levels])[worlds.codes] for level in dict.fromkeys(levels)}


def _mean(values: npt.NDArray[np.floating]) -> float | None:
    known = values[~np.isnan(values)].astype(float)
    return float(known.mean()) if len(known) else None
