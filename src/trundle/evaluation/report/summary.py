"""`summary.json`: the figures of an evaluation, for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.evaluation.statistics.figures import FIGURES, Figure
from trundle.evaluation.statistics.gates import GateResult
from trundle.evaluation.statistics.intervals import wilson
from trundle.evaluation.statistics.table import LABELS, Table, group_rows


def summarise(table: Table, *, total: int | None = None, gates: Sequence[GateResult] = ()) -> dict[str, Any]:
    """The figures of an evaluation, and of each of its groups, as plain values.

    Args:
        table: The rows so far.
        total: How many episodes there are to be; none means those that there are.
        gates: The results of what is required.

    Returns:
        `episodes`, `total`, `complete`, `success` (None without an episode) with the ends of its 95 % interval
        `success_low` and `success_high`, `outcomes`, `medians`, `passed` (None without a gate), `gates`, and
        `by_group`, with the same figures for each combination of labels: `world=office planner=auto`.
    """
    total = len(table) if total is None else total
    everything = np.arange(len(table))
    return {
        "episodes": len(table),
        "total": total,
        "complete": len(table) >= total,
        **_figures(table, everything),
        "passed": all(gate.passed for gate in gates) if gates else None,
        "gates": [gate.as_dict() for gate in gates],
        "by_group": {
            _key(group.labels): {
                "labels": dict(group.labels),
                "episodes": len(group.rows),
                **_figures(table, group.rows),
            }
            for group in group_rows(table)
        },
    }


def count_outcomes(table: Table, rows: npt.NDArray[np.intp] | None = None) -> dict[str, int]:
    """How many rows ended how: `arrived` first, then the others from the most frequent."""
    outcomes = table.named["outcome"]
    codes = outcomes.codes if rows is None else outcomes.codes[rows]
    counts = np.bincount(codes, minlength=len(outcomes.names))
    found = {name: int(count) for name, count in zip(outcomes.names, counts, strict=True) if count}
    return dict(sorted(found.items(), key=lambda item: (item[0] != "arrived", -item[1], item[0])))


def _key(labels: Mapping[str, str]) -> str:
    return " ".join(f"{name}={labels[name]}" for name in LABELS if labels[name])


def _figures(table: Table, rows: npt.NDArray[np.intp]) -> dict[str, Any]:
    successes = int(table.arrived[rows].sum())
    low, high = wilson(successes, len(rows))
    return {
        "success": successes / len(rows) if len(rows) else None,
        "success_low": low,
        "success_high": high,
        "outcomes": count_outcomes(table, rows),
        "medians": {figure.name: _median(table, figure, rows) for figure in FIGURES if figure.name != "success"},
    }


def _median(table: Table, figure: Figure, rows: npt.NDArray[np.intp]) -> float | None:
    values = figure.values(table)[rows]
    known = values[~np.isnan(values)]
    return round(float(np.median(known)), 6) if len(known) else None
