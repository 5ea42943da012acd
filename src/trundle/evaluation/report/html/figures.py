"""The figures of an evaluation's report: distributions and extremes, settings compared, and what was varied."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from trundle.evaluation.report.html.charts import LINE_COLORS, distribution, interval_bar, line_key, share_axis
from trundle.evaluation.report.text import notes, replay_command, write_difference, write_p, write_value
from trundle.evaluation.statistics.comparison import Comparison, PairComparison
from trundle.evaluation.statistics.figures import BY_NAME, write_number, write_share
from trundle.evaluation.statistics.intervals import CONFIDENCE, Interval, rank_correlation, wilson
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
    """Return tables of the slowest plans and of the closest passes among those that arrived."""
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


_OPEN = 3
"""Comparisons that are shown; more of them are folded."""
_AGAINST = ("success", "time_s", "min_clearance_m")
_PARTS = 5


def comparisons(comparison: Comparison | None) -> str:
    """Return a table for each pair of settings; nothing where there is only one setting."""
    if comparison is None:
        return ""
    parts = [_pair(pair, folded=place >= _OPEN) for place, pair in enumerate(comparison.pairs)]
    text = " ".join(notes(comparison.count))
    return (
        '<section><h2>Compared on the same missions</h2><p class="note">Both of a pair drove the same worlds with the '
        f"same starts and goals. {escape(text)}</p>{''.join(parts)}</section>"
    )


def _pair(pair: PairComparison, *, folded: bool) -> str:
    success = pair.change("success")
    lost, won = len(pair.newly_failing), len(pair.newly_passing)
    first, second = escape(pair.first), escape(pair.second)
    sentence = (
        f"On {pair.missions:,} missions: {second} arrived on {won:,} where {first} failed, and failed on {lost:,} "
        f"where {first} arrived (McNemar's exact test: p {escape(write_p(success.p))}). Both arrived on {pair.both:,}."
    )
    rows: list[str] = []
    for change in pair.changes:
        if change.difference.n == 0:
            continue
        difference, interval = write_difference(change)
        word, kind = change.direction or "not clear", {"better": "good", "worse": "bad"}.get(change.direction, "note")
        remark = "both arrive" if change.figure.arrived else "measured" if change.figure.measured else ""
        where = f' <span class="note">{remark}</span>' if remark else ""
        rows.append(
            f'<tr><th scope="row">{escape(change.figure.text)}{where}</th>'
            f'<td data-name="{first}">{write_value(change, change.first, pair.missions)}</td>'
            f'<td data-name="{second}">{write_value(change, change.second, pair.missions)}</td>'
            f'<td data-name="difference"><b>{difference}</b> <span class="ci">{interval}</span></td>'
            f'<td class="word"><span class="{kind}">{word}</span></td></tr>'
        )
    table = (
        f'<div class="wide"><table class="stack"><thead><tr><th>mean of</th><th>{first}</th><th>{second}</th>'
        f'<th>difference, 95 % interval</th><th class="text">{second} is</th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )
    title = f"{first} → {second}"
    if folded:
        return f"<details><summary>{title}</summary><p>{sentence}</p>{table}</details>"
    return f"<h3>{title}</h3><p>{sentence}</p>{table}"


def variations(table: Table) -> str:
    """Return which variation decides: rank correlations of what was varied with success, time and clearance."""
    names = [name for name, values in table.vary.items() if np.ptp(values[~np.isnan(values)]) > 0.0]
    if not names:
        return ""
    # As many intervals are read at once, each has the confidence that Bonferroni's correction asks for.
    confidence = 1.0 - (1.0 - CONFIDENCE) / len(names)
    found = {
        (name, figure): rank_correlation(table.vary[name], BY_NAME[figure].values(table), confidence)
        for name in names
        for figure in _AGAINST
    }
    names.sort(key=lambda name: -abs(np.nan_to_num(found[name, "success"][0])))
    rows = "".join(_variation_row(name, {figure: found[name, figure] for figure in _AGAINST}) for name in names)
    titles = "".join(f'<th class="mid">with {BY_NAME[figure].text}</th>' for figure in _AGAINST)
    clear = [name for name in names if _clear(found[name, "success"][1])]
    sentence = "No variation clearly decides whether episodes arrive."
    if clear:
        words = (f"{name} ({'more' if found[name, 'success'][0] > 0.0 else 'less'} is better)" for name in clear)
        sentence = f"Success clearly depends on {escape(', '.join(words))}."
    corrected = f" Intervals are 95 % for all {len(names)} variations together (Bonferroni)." if len(names) > 1 else ""
    return (
        f"<section><h2>Which variation decides</h2><p>{sentence}</p>"
        '<p class="note">Spearman\'s rank correlation of each value drawn with what became of the episode, from -1 to '
        f"1: 0 means that it does not matter. Time and clearance are of those that arrived.{corrected}</p>"
        f'<div class="wide"><table class="stack"><thead><tr><th>variation</th>{titles}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>{''.join(_success_by_part(table, name) for name in clear[:2])}</section>"
    )


def _variation_row(name: str, found: dict[str, tuple[float, Interval]]) -> str:
    cells: list[str] = []
    for figure, (rho, interval) in found.items():
        if math.isnan(rho):
            cells.append('<td class="mid note">does not vary</td>')
            continue
        text = f"{rho:+.2f} ({interval.low:+.2f} to {interval.high:+.2f})"
        bar = interval_bar(rho, interval, (-1.0, 1.0), text=text, bound=0.0)
        shown = f"<b>{text}</b>" if _clear(interval) else text
        cells.append(f'<td class="mid" data-name="with {BY_NAME[figure].text}">{bar}<br>{shown}</td>')
    return f'<tr><th scope="row">{escape(name)}</th>{"".join(cells)}</tr>'


def _clear(interval: Interval) -> bool:
    return interval.low > 0.0 or interval.high < 0.0


def _success_by_part(table: Table, name: str) -> str:
    """Return success in each fifth of the values drawn."""
    values = table.vary[name]
    known = np.flatnonzero(~np.isnan(values))
    edges = np.unique(np.quantile(values[known], np.linspace(0.0, 1.0, _PARTS + 1)))
    part = np.clip(np.searchsorted(edges, values[known], side="right") - 1, 0, len(edges) - 2)
    arrived = table.arrived[known]
    parts = [(number, part == number) for number in range(len(edges) - 1)]
    counts = [(number, int(arrived[inside].sum()), int(inside.sum())) for number, inside in parts if inside.any()]
    intervals = [wilson(successes, n) for _, successes, n in counts]
    axis, ends = share_axis([interval.low for interval in intervals])
    rows: list[str] = []
    for (number, successes, n), interval in zip(counts, intervals, strict=True):
        share, low, high = (write_share(value, n) for value in (successes / n, *interval))
        bar = interval_bar(successes / n, interval, axis, text=f"{share}, {low} to {high}")
        rows.append(
            f'<tr><th scope="row">{write_number(edges[number])} to {write_number(edges[number + 1])}</th>'
            f'<td data-name="arrived">{successes:,} of {n:,}</td><td data-name="success">{share}</td>'
            f'<td data-name="95 %">{low} to {high}</td><td class="mid" data-name="{ends}">{bar}</td></tr>'
        )
    title = escape(name)
    return (
        f'<h3>Success by {title}</h3><div class="wide"><table class="stack"><thead><tr><th>{title}</th>'
        f'<th>arrived</th><th>success</th><th>95 % interval</th><th class="mid">{ends}</th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )
