"""The top of the page: the verdict with what is required, the figures of all episodes, and success by group."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from trundle.evaluation.report.html.charts import count_text, interval_bar, outcome_bar, share_axis
from trundle.evaluation.report.summary import (
    count_complete,
    count_handed_over,
    count_outcomes,
    describe_missing,
    stopped_as_dict,
)
from trundle.evaluation.report.text import clean
from trundle.evaluation.statistics.figures import BY_NAME, write_number, write_share
from trundle.evaluation.statistics.gates import Gate, GateResult
from trundle.evaluation.statistics.intervals import no_failure_bound, wilson
from trundle.evaluation.statistics.pairing import find_only_errors
from trundle.evaluation.statistics.table import LABELS, Table, group_rows, iterate_groups
from trundle.evaluation.store.folder import Stopped

_MOST_GROUPS = 40
_MARKS = {"passed": ("✓", "good"), "failed": ("✕", "bad"), "undecided": ("?", "warn")}


def verdict(
    table: Table,
    name: str,
    total: int,
    gates: Sequence[GateResult],
    facts: Mapping[str, str],
    stopped: Stopped | None = None,
) -> str:
    """Name, verdict, what only raised exceptions, what is required, and what was run."""
    done = len(table)
    text, kind = _verdict_words(gates)
    parts = [f'<header><h1><span class="badge {kind}">{text}</span> {escape(name)}</h1>']
    parts += [
        f'<p class="banner"><b>Only errors:</b> {escape(clean(str(each)))}; it is compared with nothing.</p>'
        for each in find_only_errors(table)
    ]
    if done < total:
        parts.append(f'<p class="banner">{escape(describe_missing(done, total, stopped_as_dict(stopped)))}</p>')
    if gates:
        items = "".join(_gate_item(gate) for gate in gates)
        parts.append(f'<ul class="gates">{items}</ul>')
    if done:
        names = {label: table.named[label].names for label in LABELS}
        crossed = [f"{_count(len(found), label)}" for label, found in names.items() if len(found) > 1]
        single = [found[0] for found in names.values() if len(found) == 1 and found[0]]
        missions = len(np.unique(table.keys["mission"]))
        size = [_count(done, "episode"), _count(missions, "different mission"), *crossed]
        parts.append(f'<p class="note">{" · ".join(map(escape, size))}<br>{escape(" · ".join(single))}</p>')
    if facts:
        text = " · ".join(f"{key} {value}" for key, value in facts.items())
        parts.append(f'<p class="note">{escape(text)}</p>')
    return "".join(parts) + "</header>"


def tiles(table: Table) -> str:
    """Return the figures of all episodes."""
    n, successes = len(table), int(table.arrived.sum())
    low, high = wilson(successes, n)
    failed = {outcome: count for outcome, count in count_outcomes(table).items() if outcome != "arrived"}
    touching = int((np.nan_to_num(table.numbers["contacts"]) > 0).sum())
    bound = f"at 95 %, fewer than {write_share(no_failure_bound(n), n)}"
    contact_note = (
        f"{bound} of missions touch something" if touching == 0 else f"{write_share(touching / n, n)} of all episodes"
    )
    clearance = BY_NAME["min_clearance_m"].values(table)
    clearance = clearance[~np.isnan(clearance)]
    spl = table.numbers["spl"]
    entries = [
        ("success", write_share(successes / n, n), f"95 % interval: {write_share(low, n)} to {write_share(high, n)}"),
        ("failed", f"{n - successes:,}", count_text(failed) if failed else f"none in {n:,}: {bound} fail"),
        ("touched something", f"{touching:,}", contact_note),
        ("mean SPL", write_number(float(np.nanmean(spl))), "path efficiency: 1 is the shortest path; a failure is 0"),
    ]
    proved, cut_off = count_complete(table)
    if proved + cut_off > 0:
        note = f"complete search: {proved:,} (there is no path); not complete: {cut_off:,} (none found)"
        entries.append(("no path", f"{proved + cut_off:,}", note))
    if len(clearance):
        entries.append(("closest pass", f"{write_number(float(clearance.min()))} m", "of those that arrived"))
    entries += _sensing_tiles(table)
    handed = count_handed_over(table)
    if handed:
        reasons = ", ".join(f"{count:,} {name}" for name, count in handed.items())
        entries.append(("handed over", f"{sum(handed.values()):,}", f"by batch to kinematic: {escape(reasons)}"))
    scores = BY_NAME["barn_score"].values(table)
    if BY_NAME["barn_score"].is_used(scores):
        entries.append(("BARN score", write_number(float(np.nanmean(scores))), "mean of all runs; at most 0.5"))
    cpu = float(np.nansum(table.numbers["cpu_s"].astype(float)))
    if cpu > 0.0:
        entries.append(("CPU time", _duration(cpu), f"{write_number(cpu / n)} s per episode"))
    cells = (
        f'<div class="tile"><small>{escape(title)}</small><b>{escape(value)}</b><small>{note}</small></div>'
        for title, value, note in entries
    )
    return f'<div class="tiles">{"".join(cells)}</div>'


def _sensing_tiles(table: Table) -> list[tuple[str, str, str]]:
    """Return the figures that lidars, movers and localizers add, where some episode has them."""
    entries: list[tuple[str, str, str]] = []
    for name, title, note in (
        ("standing_contacts", "run into while standing", "episodes in which a mover touched a robot that stood"),
        ("unseen_contacts", "out of sight", "episodes with a contact with what no lidar could see"),
    ):
        values = BY_NAME[name].values(table)
        if BY_NAME[name].is_used(values):
            entries.append((title, f"{int((np.nan_to_num(values) > 0).sum()):,}", note))
    errors, stops = (BY_NAME[name].values(table) for name in ("position_error_m", "monitor_stops"))
    if BY_NAME["position_error_m"].is_used(errors):
        median, most = float(np.nanmedian(errors)), float(np.nanmax(errors))
        note = f"from the true position at the end, median; {write_number(most)} m at most"
        entries.append(("error of the estimate", f"{write_number(median)} m", note))
    means, ends, lost = (
        BY_NAME[name].values(table) for name in ("localization_error_m", "localization_error_p95_m", "lost_s")
    )
    if BY_NAME["localization_error_m"].is_used(means):
        note = f"mean of the run, median; 95 % of it below {write_number(float(np.nanmedian(ends)))} m"
        entries.append(("error while driving", f"{write_number(float(np.nanmedian(means)))} m", note))
    if BY_NAME["lost_s"].is_used(lost):
        note = f"time in which a robot said so; in {int((np.nan_to_num(lost) > 0).sum()):,} episodes"
        entries.append(("not localized", f"{write_number(float(np.nansum(lost)))} s", note))
    if BY_NAME["monitor_stops"].is_used(stops):
        entries.append(
            ("monitor stops", write_number(float(np.nanmean(stops))), "of the collision monitor, per episode")
        )
    recoveries = BY_NAME["recoveries"].values(table)
    if BY_NAME["recoveries"].is_used(recoveries):
        entries.append(("recoveries", write_number(float(np.nanmean(recoveries))), "steps of recovery, per episode"))
    return entries


def groups(table: Table, gates: Sequence[GateResult]) -> str:
    """Return success of each group with Wilson's interval, and how its episodes ended."""
    found = list(iterate_groups(group_rows(table), table))
    left_out = len(found) - _MOST_GROUPS
    if left_out > 0:
        found = sorted(found, key=lambda entry: entry[1] / entry[2])[:_MOST_GROUPS]
    intervals = [wilson(successes, n) for _, successes, n in found]
    bound = next((Gate.parse(gate.gate).bound for gate in gates if gate.gate.startswith("success>=")), None)
    lows = [interval.low for interval in intervals] + ([] if bound is None else [bound])
    axis, ends = share_axis(lows)
    rows: list[str] = []
    for (group, successes, n), interval in zip(found, intervals, strict=True):
        share, low, high = (write_share(value, n) for value in (successes / n, *interval))
        counts = count_outcomes(table, group.rows)
        bar = interval_bar(successes / n, interval, axis, text=f"{share}, {low} to {high}", bound=bound)
        ended = count_text(counts, skip="arrived") or '<span class="note">all arrived</span>'
        rows.append(
            f'<tr><th scope="row">{escape(group.name)}</th><td data-name="arrived">{successes:,} of {n:,}</td>'
            f'<td data-name="success"><b>{share}</b></td><td data-name="95 %">{low} to {high}</td>'
            f'<td class="mid" data-name="{ends}">{bar}</td>'
            f'<td class="text">{outcome_bar(counts)}</td><td class="text">{ended}</td></tr>'
        )
    more = f" The {_MOST_GROUPS} groups with the least success of {len(found) + left_out}." if left_out > 0 else ""
    dashed = "" if bound is None else " The dashed line is what is required."
    return (
        '<section><h2>Success by group</h2><p class="note">The share of missions that arrived without touching '
        f"anything, with Wilson's 95 % interval: where the true share may lie.{dashed}{more}</p>"
        '<div class="wide"><table class="stack"><thead><tr><th>group</th><th>arrived</th><th>success</th>'
        f'<th>95 % interval</th><th class="mid">{ends}</th><th class="text" colspan="2">how they ended</th></tr>'
        f"</thead><tbody>{''.join(rows)}</tbody></table></div></section>"
    )


def _verdict_words(gates: Sequence[GateResult]) -> tuple[str, str]:
    if not gates:
        return "nothing required", "note"
    states = {gate.state for gate in gates}
    if "failed" in states:
        return "✕ failed", "bad"
    return ("? not decided", "warn") if "undecided" in states else ("✓ passed", "good")


def _gate_item(gate: GateResult) -> str:
    mark, kind = _MARKS[gate.state]
    word = {"passed": "passed", "failed": "failed", "undecided": "not decided, so not passed"}[gate.state]
    return f'<li><b class="{kind}">{mark} {word}</b>: <code>{escape(gate.gate)}</code> {escape(gate.text)}</li>'


def _count(number: int, what: str) -> str:
    if what == "settings":
        return f"{number:,} settings"
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{write_number(seconds)} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
