"""Rows and comparisons as text of at most 80 columns, and the causes and commands that every report has."""

from __future__ import annotations

import math
import re
import shlex
import textwrap
from collections.abc import Iterable, Sequence

from trundle.evaluation.row import Row
from trundle.evaluation.statistics.comparison import Change, Comparison, PairComparison, Turned
from trundle.evaluation.statistics.figures import write_number, write_share
from trundle.evaluation.statistics.table import ARRIVED, LABELS

_WIDTH = 80
_LONGEST_LABELS = 34
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]+")
_SHOWN = 8
_SHARES = ("success",)

_DIGITS = 12
"""Digits of an id that tell a million episodes apart."""


def short_id(episode: str) -> str:
    """Return as much of an id as tells it from all others."""
    return episode[:_DIGITS]


def replay_command(folder: str, episode: str) -> str:
    """Return the command that runs an episode of the evaluation in a folder again, quoted for a shell."""
    return f"trundle run --from {shlex.quote(f'{folder}:{short_id(episode)}')}"


def table_lines(rows: Iterable[Row], folder: str) -> list[str]:
    """Return a line for each row, and below each failed one its cause and the command that runs it again.

    No line is longer than 80 columns, except for a command with a long folder, which must be copied whole.

    Args:
        rows: The rows to show.
        folder: The folder of the evaluation, for the commands.
    """
    shown = list(rows)
    if not shown:
        return ["no such episode"]
    differ = [name for name in LABELS if len({getattr(row, name) for row in shown}) > 1] or ["world", "planner"]
    lines = [("id", "outcome", " · ".join(differ), "time", "driven")]
    for row in shown:
        labels = clean(" · ".join(getattr(row, name) or "default" for name in differ))
        lines.append((short_id(row.id), row.outcome, labels, _figure(row.time_s, "s"), _figure(row.distance_m, "m")))
    labels = min(_LONGEST_LABELS, max(len(line[2]) for line in lines))
    outcome = max(len(line[1]) for line in lines)
    text: list[str] = []
    for line, row in zip(lines, [None, *shown], strict=True):
        cut = line[2] if len(line[2]) <= labels else f"{line[2][: labels - 1]}…"
        text.append(f"{line[0]:<12}  {line[1]:<{outcome}}  {cut:<{labels}}  {line[3]:>7}  {line[4]:>6}".rstrip())
        if row is not None and row.outcome != ARRIVED:
            indent = "    "
            text += textwrap.wrap(cause(row), _WIDTH, initial_indent=indent, subsequent_indent=indent)[:3]
            text.append(indent + replay_command(folder, row.id))
    return text


def cause(row: Row) -> str:
    """Return why an episode failed, in one line: what ended it, or its outcome in words, and what it touched."""
    text = row.error or row.message or row.outcome
    if row.touched and row.touched not in text:
        text = f"{text}; touched {row.touched}"
    return clean(text)


def clean(text: str) -> str:
    """Return a text in one line, without what would steer a terminal."""
    return _CONTROL.sub(" ", text).strip()


def _figure(value: float | None, unit: str) -> str:
    return "–" if value is None else f"{write_number(value)} {unit}"


def comparison_lines(comparison: Comparison) -> list[str]:
    """Return what `trundle evaluate compare` prints: the verdict, what changed, and the missions that turned.

    No line that trundle words is longer than 80 columns; names of folders may make one so.
    """
    lines = [f"A = {comparison.first}", f"B = {comparison.second}"]
    for name, found in zip("AB", comparison.only_errors, strict=True):
        for each in found:
            lines += textwrap.wrap(clean(f"{name}, {each}; it is compared with nothing"), _WIDTH)
    if comparison.by_ends:
        lines += textwrap.wrap(
            "No mission is the same in both: a robot or a world was changed. Compared are those with the same name of "
            "the world, seed, start and goal.",
            _WIDTH,
        )
    for name, left_out in (("A", comparison.only_first), ("B", comparison.only_second)):
        if left_out:
            lines.append(
                f"{left_out} {'episode' if left_out == 1 else 'episodes'} of {name} left out: their missions are not "
                "in the other"
            )
    for pair in comparison.pairs:
        lines += ["", *_pair_lines(comparison, pair)]
    basis = [line for note in notes(comparison.count) for line in textwrap.wrap(note, _WIDTH)]
    lines += ["", *basis, "", *textwrap.wrap(verdict(comparison), _WIDTH)]
    return lines


def verdict(comparison: Comparison) -> str:
    """Return whether the second is worse, and in what."""
    reasons = [
        f"{change.figure.text}{f' ({pair.second or pair.first})' if len(comparison.pairs) > 1 else ''}"
        for pair in comparison.pairs
        for change in pair.changes
        if change.worse
    ]
    if reasons:
        return f"B is worse: {', '.join(reasons)}"
    return "B is not clearly worse"


def write_value(change: Change, value: float, n: int) -> str:
    """Return a mean of this figure, with its unit."""
    if change.figure.name in _SHARES:
        return "–" if math.isnan(value) else write_share(value, n)
    unit = change.figure.unit
    return write_number(value) + (f" {unit}" if unit else "")


def write_difference(change: Change) -> tuple[str, str]:
    """Return a difference and its interval, with their signs; of shares in percentage points."""
    mean, (low, high) = change.difference.value, change.difference.interval
    share = change.figure.name in _SHARES
    scale, unit = (100.0, "pp") if share else (1.0, change.figure.unit)
    interval = "–" if math.isnan(low) else f"{_signed(scale * low)} to {_signed(scale * high)}"
    return f"{_signed(scale * mean)}{unit and f' {unit}'}", interval


def turned_text(pair: PairComparison, p: float) -> str:
    """Return in words on how many missions only one of the two arrives."""
    lost, won = len(pair.newly_failing), len(pair.newly_passing)
    test = f"McNemar's exact test: p {write_p(p)}"
    return f"B fails on {lost} where A arrives, and arrives on {won} where A fails ({test})"


def write_p(p: float) -> str:
    """Return a p with two digits, and what stands before it."""
    return "< 0.0001" if p < 0.0001 else f"= {p:.2g}" if p < 0.995 else "= 1"


def notes(count: int) -> list[str]:
    """Return what the figures of a comparison rest on, in sentences."""
    return [
        "Times, distances, clearances, replans, tracking errors and turning are compared on the missions where both "
        "arrive.",
        f"Intervals are 95 %, of a paired bootstrap clustered by world. A change is called clear where p, adjusted by "
        f"Holm for all {count} comparisons made here, is below 0.05.",
    ]


def _pair_lines(comparison: Comparison, pair: PairComparison) -> list[str]:
    success = pair.change("success")
    lines: list[str] = []
    if pair.first or pair.second:
        same = pair.first == pair.second
        lines += textwrap.wrap(pair.first if same else f"A: {pair.first}  B: {pair.second}", _WIDTH)
    missions = f"{pair.missions} {'mission' if pair.missions == 1 else 'missions'} in both; "
    lines += textwrap.wrap(missions + turned_text(pair, success.p), _WIDTH)
    table = [("", "A", "B", "change", "95 % interval", "clear")]
    for change in pair.changes:
        if change.difference.n == 0:
            continue
        difference, interval = write_difference(change)
        first, second = (write_value(change, value, pair.missions) for value in (change.first, change.second))
        table.append((change.figure.text, first, second, difference, interval, change.direction))
    widths = [max(len(row[column]) for row in table) for column in range(6)]
    for row in table:
        cells = [
            row[0].ljust(widths[0]),
            *(cell.rjust(width) for cell, width in zip(row[1:5], widths[1:5], strict=True)),
        ]
        lines.append("  ".join([*cells, row[5]]).rstrip())
    lines += _turned_lines("newly failing", pair.newly_failing, comparison.second, of_second=True)
    lines += _turned_lines("newly passing", pair.newly_passing, comparison.first, of_second=False)
    return lines


def _turned_lines(title: str, missions: Sequence[Turned], folder: str, *, of_second: bool) -> list[str]:
    if not missions:
        return []
    lines = [f"{title}: {len(missions)}"]
    for mission in missions[:_SHOWN]:
        command = replay_command(folder, mission.second if of_second else mission.first)
        lines.append(f"  {command}  {clean(mission.world)}: {mission.outcome}")
    if len(missions) > _SHOWN:
        lines.append(f"  and {len(missions) - _SHOWN} more; --json has them all")
    return lines


def _signed(value: float) -> str:
    text = write_number(abs(value))
    return text if text in ("–", "0") else f"{'-' if value < 0.0 else '+'}{text}"
