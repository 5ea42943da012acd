"""Distributions of the figures, the slowest plans and the closest passes."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from trundle.evaluation.report.html.charts import LINE_COLORS, distribution, line_key
from trundle.evaluation.report.text import replay_command
from trundle.evaluation.statistics.figures import BY_NAME, write_number
from trundle.evaluation.statistics.table import VARIANT, Group, Table, group_rows, name_labels
from trundle.geometry import FloatArray

_SHOWN = ("time_s", "min_clearance_m", "max_cross_track_error_m", "planning_ms")
_MOST_LINES = len(LINE_COLORS)
_ROWS = 8


def distributions(table: Table) -> str:
    """Return the distributions of times, clearances, errors and planning times, a line for each setting."""
    every = group_rows(table, VARIANT)
    groups = every[:_MOST_LINES]
    charts = [_chart(table, figure, groups) for figure in _SHOWN]
    if not any(charts):
        return ""
    keys = "".join(f"<span>{line_key(place)}{escape(group.name)}</span>" for place, group in enumerate(groups))
    legend = f'<div class="key">{keys}</div>' if len(groups) > 1 else ""
    more = f" The first {len(groups)} of {len(every)} settings are shown." if len(every) > len(groups) else ""
    return (
        '<section><h2>Distributions</h2><p class="note">How large a share of the episodes (upwards) has at most this '
        f"value (to the right). Planning times are measured and depend on the machine.{more}</p>"
        f'{legend}<div class="figures charts">{"".join(charts)}</div></section>'
    )


def _chart(table: Table, name: str, groups: Sequence[Group]) -> str:
    figure = BY_NAME[name]
    values = figure.values(table)
    series: list[tuple[str, FloatArray]] = [(group.name, values[group.rows]) for group in groups]
    if all(np.isnan(part).all() for _, part in series):
        return ""
    known = [(label, part[~np.isnan(part)]) for label, part in series]
    medians = ", ".join(
        f"{label + ' ' if len(groups) > 1 else ''}{write_number(float(np.median(part)))}"
        for label, part in known
        if len(part)
    )
    which = " of those that arrived" if figure.arrived else ""
    return (
        f"<figure><b>{figure.text}{which} [{figure.unit}]</b><figcaption>median: {escape(medians)}</figcaption>"
        f"{distribution(series, figure.unit)}</figure>"
    )


def extremes(table: Table, folder: str) -> str:
    """Tables of the slowest plans and of the closest passes among those that arrived."""
    planning = table.numbers["planning_ms"].astype(float)
    slowest = _first(-planning)
    clearance = BY_NAME["min_clearance_m"].values(table)
    closest = _first(clearance)
    parts = [
        _table(table, slowest, "Slowest plans", "planning", planning, "ms", folder),
        _table(table, closest, "Closest passes of those that arrived", "clearance", clearance, "m", folder),
    ]
    return "".join(part for part in parts if part)


def _first(keys: FloatArray) -> list[int]:
    known = np.flatnonzero(~np.isnan(keys))
    return known[np.argsort(keys[known], kind="stable")[:_ROWS]].tolist()


def _table(
    table: Table, rows: Sequence[int], title: str, column: str, values: FloatArray, unit: str, folder: str
) -> str:
    if not rows:
        return ""
    named = ["world", *(name for name in VARIANT if len(table.named[name].names) > 1)]
    lines: list[str] = []
    for row in rows:
        command = escape(replay_command(folder, table.id_of(row)))
        lines.append(
            f'<tr><td class="text">{escape(name_labels(table.labels_of(row), named))}</td>'
            f'<td data-name="{column}"><b>{write_number(float(values[row]))} {unit}</b></td>'
            f'<td data-name="driven">{write_number(float(table.numbers["distance_m"][row]))} m</td>'
            f'<td data-name="time">{write_number(float(table.numbers["time_s"][row]))} s</td>'
            f'<td class="text"><code>{command}</code></td></tr>'
        )
    titles = f"<th>{escape(' · '.join(named))}</th><th>{column}</th><th>driven</th><th>time</th>"
    return (
        f'<section><h2>{title}</h2><div class="wide"><table class="stack"><thead><tr>{titles}'
        f'<th class="text">run it again</th></tr></thead><tbody>{"".join(lines)}</tbody></table></div></section>'
    )
