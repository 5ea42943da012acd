"""Marks of outcomes: each has its own shape besides its colour, on maps, in bars and in text."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

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
    """The mark of an outcome; episodes that did not end by themselves share one."""
    kind = _KIND.get(outcome, outcome)
    return kind if kind in _SHAPES else "broken"


def definitions() -> str:
    """The marks, to be used by name; once in a page."""
    marks = "".join(f'<g id="m-{kind}" class="c-{kind}">{shape}</g>' for kind, shape in _SHAPES.items())
    return f'<svg class="defs" aria-hidden="true"><defs>{marks}</defs></svg>'


def icon(kind: str) -> str:
    """A mark in a line of text."""
    return f'<svg class="icon" viewBox="-11 -11 22 22" aria-hidden="true"><use href="#m-{kind}"/></svg>'


def outcome_text(outcome: str) -> str:
    """An outcome in words."""
    return outcome.replace("_", " ")


def count_text(counts: Mapping[str, int], *, skip: str = "") -> str:
    """Outcomes with their marks and counts, as HTML."""
    parts = [
        f'<span class="count">{icon(kind_of(name))}{count} {escape(outcome_text(name))}</span>'
        for name, count in counts.items()
        if name != skip
    ]
    return " ".join(parts)
