"""Rows as text: what `trundle evaluate show` prints."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable

from trundle.evaluation.report.commands import replay_command, short_id
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.figures import write_number
from trundle.evaluation.statistics.table import ARRIVED, LABELS

_WIDTH = 80
_LONGEST_LABELS = 34
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]+")


def table_lines(rows: Iterable[Row], folder: str) -> list[str]:
    """A line for each row, and below each failed one its cause and the command that runs it again.

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
    """Why an episode failed, in one line: what ended it, or its outcome in words, and what it touched."""
    text = row.error or row.message or row.outcome
    if row.touched and row.touched not in text:
        text = f"{text}; touched {row.touched}"
    return clean(text)


def clean(text: str) -> str:
    """A text in one line, without what would steer a terminal."""
    return _CONTROL.sub(" ", text).strip()


def _figure(value: float | None, unit: str) -> str:
    return "–" if value is None else f"{write_number(value)} {unit}"
