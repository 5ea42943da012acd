"""Small charts as SVG; and the marks of outcomes, each with its own shape besides its colour."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from trundle.evaluation.statistics.figures import write_number
from trundle.evaluation.statistics.intervals import Interval
from trundle.geometry import FloatArray
from trundle.pictures.colors import SEVERAL

CLOSE = "close"
_SHAPES = {
    "arrived": '<path d="M-8 0 -3 6 8 -6" fill="none" stroke="currentColor" stroke-width="4"/>',
    "collided": '<path d="M-7-7 7 7M-7 7 7-7" fill="none" stroke="currentColor" stroke-width="4.5"/>',
    "stuck": '<path d="M-7-7h14v14h-14z"/>',
    "timed_out": '<path d="M0-10 10 0 0 10-10 0z"/>',
    "no_path": '<path d="M0-9 10 8h-20z"/>',
    "arrived_by_estimate": '<path d="M-8 0 -3 6 8 -6" fill="none" stroke="currentColor" stroke-width="3" '
    'stroke-dasharray="4 2.5"/>',
    "finished": '<path d="M-6 9V-9h13l-4 4.5 4 4.5h-10.5V9z"/>',
    "broken": '<circle r="8"/>',
    CLOSE: '<path d="M0-8 8 0 0 8-8 0z" fill="none" stroke="currentColor" stroke-width="3"/>',
}
_KIND = {"planning_timed_out": "timed_out"}
MARKED = tuple(_SHAPES)

# Dashes beside the colours, so that lines are told apart in grey as well.
DASHES = ("", "7 3", "2 3", "10 3 2 3", "4 4", "12 4")
LINE_COLORS = tuple("#{:02x}{:02x}{:02x}".format(*color) for color in SEVERAL[:6])


def kind_of(outcome: str) -> str:
    """Return the mark of an outcome; episodes that did not end by themselves share one."""
    kind = _KIND.get(outcome, outcome)
    return kind if kind in _SHAPES else "broken"


def definitions() -> str:
    """Return the marks, to be used by name; once in a page."""
    marks = "".join(f'<g id="m-{kind}" class="c-{kind}">{shape}</g>' for kind, shape in _SHAPES.items())
    return f'<svg class="defs" aria-hidden="true"><defs>{marks}</defs></svg>'


def icon(kind: str) -> str:
    """Return a mark in a line of text."""
    return f'<svg class="icon" viewBox="-11 -11 22 22" aria-hidden="true"><use href="#m-{kind}"/></svg>'


def outcome_text(outcome: str) -> str:
    """Return an outcome in words."""
    return outcome.replace("_", " ")


def count_text(counts: Mapping[str, int], *, skip: str = "") -> str:
    """Return outcomes with their marks and counts, as HTML."""
    parts = [
        f'<span class="count">{icon(kind_of(name))}{count} {escape(outcome_text(name))}</span>'
        for name, count in counts.items()
        if name != skip
    ]
    return " ".join(parts)


_WIDE, _HIGH = 360.0, 210.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 38.0, 10.0, 10.0, 24.0
_STEPS = 60
"""Points of a distribution: its quantiles."""


def interval_bar(
    value: float, interval: Interval, axis: tuple[float, float], *, text: str, bound: float | None = None
) -> str:
    """Return a dot with its interval on an axis; a dashed line stands for a bound, or for zero."""
    low, high = axis
    span = (high - low) or 1.0

    def place(position: float) -> float:
        return 6.0 + 196.0 * min(1.0, max(0.0, (position - low) / span))

    parts = ['<path class="axis" d="M6 12h196"/>']
    if bound is not None:
        kind = "zero" if bound == 0.0 else "bound"
        parts.append(f'<path class="{kind}" d="M{place(bound):.1f} 2v20"/>')
    if not math.isnan(interval.low):
        start, end = place(interval.low), place(interval.high)
        parts.append(f'<path class="range" d="M{start:.1f} 12H{end:.1f}M{start:.1f} 8v8M{end:.1f} 8v8"/>')
    if not math.isnan(value):
        parts.append(f'<circle class="dot" cx="{place(value):.1f}" cy="12" r="4.5"/>')
    return f'<svg class="interval" viewBox="0 0 208 24" role="img" aria-label="{escape(text)}">{"".join(parts)}</svg>'


def share_axis(lows: Sequence[float]) -> tuple[tuple[float, float], str]:
    """Return an axis of shares that begins at a round number below all of these, and what it is called."""
    least = max(0.0, math.floor(min(lows) * 20.0 - 0.2) / 20.0)
    return (least, 1.0), f"{100.0 * least:.0f} % to 100 %"


def outcome_bar(counts: Mapping[str, int]) -> str:
    """Draw how episodes ended, as shares of a bar, in the given order."""
    total = sum(counts.values()) or 1
    parts: list[str] = []
    left = 0.0
    for outcome, count in counts.items():
        wide = 144.0 * count / total
        kind = kind_of(outcome)
        shown = max(0.0, wide - (0.8 if wide > 3.0 else 0.0))
        # A share that would be too thin to be seen is drawn with the least width that can be.
        parts.append(f'<rect class="c-{kind}" x="{min(left, 142.0):.1f}" width="{max(1.6, shown):.1f}" height="16"/>')
        left += wide
    text = ", ".join(f"{count} {outcome_text(outcome)}" for outcome, count in counts.items())
    head = f'<svg class="bar" viewBox="0 0 144 16" preserveAspectRatio="none" role="img" aria-label="{escape(text)}">'
    return f"{head}{''.join(parts)}</svg>"


def distribution(series: Sequence[tuple[str, FloatArray]], unit: str) -> str:
    """Return the share of the episodes (upwards) with at most this value (to the right), a line for each series.

    Args:
        series: Name and values; those without a value are left out.
        unit: Unit of the values.
    """
    known = [(name, np.sort(values[~np.isnan(values)])) for name, values in series]
    shown = [(place, name, values) for place, (name, values) in enumerate(known) if len(values)]
    low = min(float(values[0]) for _, _, values in shown)
    high = max(float(values[-1]) for _, _, values in shown)
    ticks = nice_ticks(low, high)
    low, high = min(low, ticks[0]), max(high, ticks[-1])
    span = (high - low) or 1.0
    wide, tall = _WIDE - _LEFT - _RIGHT, _HIGH - _TOP - _BOTTOM
    parts: list[str] = []
    for share in (0.0, 0.5, 1.0):
        y = _TOP + tall * (1.0 - share)
        parts.append(f'<path class="grid" d="M{_LEFT:g} {y:.0f}h{wide:g}"/>')
        parts.append(f'<text x="{_LEFT - 5:g}" y="{y + 4:.0f}" text-anchor="end" font-size="11">{share:.0%}</text>')
    for tick in ticks:
        x = _LEFT + wide * (tick - low) / span
        anchor = "end" if x > _WIDE - 25.0 else "middle"
        parts.append(f'<path class="grid" d="M{x:.0f} {_TOP:g}v{tall:g}"/>')
        parts.append(f'<text x="{x:.0f}" y="{_HIGH - 8:g}" text-anchor="{anchor}" font-size="11">{tick:g}</text>')
    for place, _, values in shown:
        share = np.linspace(0.0, 1.0, min(_STEPS, 2 * len(values)) + 1)
        at = np.quantile(values, share)
        points = "L".join(
            f"{_LEFT + wide * (value - low) / span:.0f} {_TOP + tall * (1.0 - part):.0f}"
            for value, part in zip(at, share, strict=True)
        )
        style = f'stroke="{LINE_COLORS[place % len(LINE_COLORS)]}" stroke-dasharray="{DASHES[place % len(DASHES)]}"'
        parts.append(f'<path d="M{points}" fill="none" stroke-width="2.4" {style}/>')
    label = f"distribution up to {write_number(high)} {unit}"
    return f'<svg viewBox="0 0 {_WIDE:g} {_HIGH:g}" role="img" aria-label="{escape(label)}">{"".join(parts)}</svg>'


def line_key(place: int) -> str:
    """Return the line of a series, for a legend."""
    style = f'stroke="{LINE_COLORS[place % len(LINE_COLORS)]}" stroke-dasharray="{DASHES[place % len(DASHES)]}"'
    return (
        f'<svg class="line" viewBox="0 0 34 12" aria-hidden="true"><path d="M0 6h34" stroke-width="4" {style}/></svg>'
    )


def nice_ticks(low: float, high: float, wanted: int = 4) -> list[float]:
    """Round numbers from about `low` to about `high`, at least one."""
    span = high - low
    if span <= 0.0:
        return [low]
    step = 10.0 ** math.floor(math.log10(span / wanted))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if span / (step * factor) <= wanted + 0.5)
    first = math.floor(low / step + 1e-9)
    last = math.ceil(high / step - 1e-9)
    return [round(number * step, 12) for number in range(first, last + 1)]
