"""`summary.json`: the figures of an evaluation, for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.evaluation.statistics.figures import FIGURES, Figure
from trundle.evaluation.statistics.gates import GateResult
from trundle.evaluation.statistics.intervals import wilson
from trundle.evaluation.statistics.pairing import find_only_errors
from trundle.evaluation.statistics.table import LABELS, Table, group_rows
from trundle.evaluation.store.folder import Stopped


def summarise(
    table: Table, *, total: int | None = None, gates: Sequence[GateResult] = (), stopped: Stopped | None = None
) -> dict[str, Any]:
    """Return the figures of an evaluation, and of each of its groups, as plain values.

    Args:
        table: The rows so far.
        total: How many episodes there are to be; by default those that have a row.
        gates: The results of what is required.
        stopped: Why not all episodes have a row, where that is known.

    Returns:
        `episodes`, `total`, `complete`, `stopped` (None, or `reason`, `in_flight` and `left_out`), `handed_over` (how
        many the backend `batch` has left to the kinematic simulator, by reason), `only_errors` (the
        settings of which every episode ended in `error`), `success` (None without an episode) with the ends of its 95 %
        interval `success_low` and `success_high`, `outcomes`, `no_path_complete` (how many of `no_path` had a complete
        search), `medians`, `passed` (None without a gate), `gates`, and `by_group`, with the same figures for each
        combination of labels: `world=office planner=auto`.
    """
    total = len(table) if total is None else total
    everything = np.arange(len(table))
    return {
        "episodes": len(table),
        "total": total,
        "complete": len(table) + (0 if stopped is None else stopped.left_out) >= total,
        "stopped": stopped_as_dict(stopped),
        "handed_over": count_handed_over(table),
        "only_errors": [each.as_dict() for each in find_only_errors(table)],
        **_figures(table, everything),
        "passed": all(gate.passed for gate in gates) if gates else None,
        "gates": [gate.as_dict() for gate in gates],
        "by_group": {
            " ".join(f"{name}={group.labels[name]}" for name in LABELS if group.labels[name]): {
                "labels": dict(group.labels),
                "episodes": len(group.rows),
                **_figures(table, group.rows),
            }
            for group in group_rows(table)
        },
    }


def stopped_as_dict(stopped: Stopped | None) -> dict[str, Any] | None:
    """Return why not all episodes have a row, as plain values."""
    if stopped is None:
        return None
    return {"reason": stopped.reason, "in_flight": len(stopped.in_flight_s), "left_out": stopped.left_out}


def describe_missing(done: int, total: int, stopped: Mapping[str, Any] | None) -> str:
    """Say of an evaluation with fewer rows than episodes what is missing, and what that does to its figures.

    Args:
        done: How many episodes have a row.
        total: How many there are to be.
        stopped: Why, as in `summary.json`; None where it is not known.
    """
    missing = total - done
    if stopped is None:
        counted = f"{done:,} episode{'' if done == 1 else 's'}"
        return f"Unfinished: {counted} of {total:,} so far. All figures here are of those that are done."
    if not stopped["reason"]:
        return (
            f"{done:,} of {total:,} episodes: the other {missing:,} were left out, as the first ten with their "
            "planner, controller, backend and settings all ended in an error."
        )
    lacks = f"{missing:,} {'is' if missing == 1 else 'are'} missing"
    text = f"Stopped {stopped['reason']} after {done:,} of {total:,} episodes: {lacks}."
    begun = stopped["in_flight"]
    if begun:
        text += (
            f" {begun:,} of them had begun. Slow episodes are more often among those than quick ones, and leaving them "
            "out flatters the figures."
        )
    return f"{text} Episodes come in an order by which those that are done are a balanced sample of all."


def count_outcomes(table: Table, rows: npt.NDArray[np.intp] | None = None) -> dict[str, int]:
    """Return how many rows ended how: `arrived` first, then the others from the most frequent."""
    outcomes = table.named["outcome"]
    codes = outcomes.codes if rows is None else outcomes.codes[rows]
    counts = np.bincount(codes, minlength=len(outcomes.names))
    found = {name: int(count) for name, count in zip(outcomes.names, counts, strict=True) if count}
    return dict(sorted(found.items(), key=lambda item: (item[0] != "arrived", -item[1], item[0])))


def count_handed_over(table: Table) -> dict[str, int]:
    """Return how many missions the backend `batch` has left to the kinematic simulator, the most frequent first."""
    reasons = table.named["handed_over"]
    counts = np.bincount(reasons.codes, minlength=len(reasons.names))
    found = {name: int(count) for name, count in zip(reasons.names, counts, strict=True) if name}
    return dict(sorted(found.items(), key=lambda item: (-item[1], item[0])))


def count_complete(table: Table, rows: npt.NDArray[np.intp] | None = None) -> tuple[int, int]:
    """Return in how many rows without a path the search was complete, and in how many it was not."""
    complete = table.numbers["complete"] if rows is None else table.numbers["complete"][rows]
    return int((complete == 1.0).sum()), int((complete == 0.0).sum())


def _figures(table: Table, rows: npt.NDArray[np.intp]) -> dict[str, Any]:
    successes = int(table.arrived[rows].sum())
    low, high = wilson(successes, len(rows))
    return {
        "success": successes / len(rows) if len(rows) else None,
        "success_low": low,
        "success_high": high,
        "outcomes": count_outcomes(table, rows),
        "no_path_complete": count_complete(table, rows)[0],
        "medians": {figure.name: _median(table, figure, rows) for figure in FIGURES if figure.name != "success"},
    }


def _median(table: Table, figure: Figure, rows: npt.NDArray[np.intp]) -> float | None:
    values = figure.values(table)[rows]
    known = values[~np.isnan(values)]
    return round(float(np.median(known)), 6) if len(known) else None
