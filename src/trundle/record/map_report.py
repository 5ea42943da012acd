"""A picture of a map with what its check found."""

from __future__ import annotations

from collections import Counter

import numpy as np
from PIL import Image, ImageDraw

from trundle.costmap import FREE_SPACE, LETHAL, NO_INFORMATION, Costmap
from trundle.maps.check import Finding, MapReport, Severity
from trundle.maps.grid import OCCUPIED, UNKNOWN, OccupancyGrid
from trundle.record.colors import BAD, FAINT, GOOD, INK, PAGE, WARNING, Rgb
from trundle.record.colors import OCCUPIED as WALL
from trundle.record.colors import UNKNOWN as DARK
from trundle.record.map_view import MapView
from trundle.record.page import Mark, compose_page, draw_tag, font, plain

COLORS: dict[Severity, Rgb] = {"error": BAD, "warning": WARNING, "info": FAINT}

_POINT = np.array([[1e-3, 1e-3], [-1e-3, 1e-3], [-1e-3, -1e-3], [1e-3, -1e-3]])
_LEGEND = (Mark("square", WALL, "occupied"), Mark("square", DARK, "unknown"))
_RING = 13  # [px]
_LINE = 46  # [px], for each finding below the map
_MOST_LINES = 24


def draw_report(grid: OccupancyGrid, report: MapReport, *, title: str) -> Image.Image:
    """Draw a map with its findings: a ring and a number at each place, and below what they mean.

    Args:
        grid: The map.
        report: What was found in it.
        title: Headline.
    """
    view = MapView(_as_costmap(grid))
    for finding in report.findings:
        if finding.where is not None:
            view.ring(finding.where, _RING, COLORS[finding.severity], 4)
    picture = view.finish()
    draw = ImageDraw.Draw(picture)
    for number, finding in enumerate(report.findings, start=1):
        if finding.where is not None:
            x, y = view.to_pixels([finding.where])[0]
            color = COLORS[finding.severity]
            draw_tag(draw, (float(x), float(y)), str(number), color, apart=_RING - 3, size=view.size)
    page = compose_page(
        picture,
        title=title,
        status=_status(report),
        lines=[plain(remark) for remark in report.remarks],
        legend=_LEGEND,
        pixels_per_metre=view.pixels_per_metre,
    )
    return _add_list(page, report.findings)


def count_by_severity(report: MapReport) -> str:
    """How many errors, warnings and remarks there are, in words."""
    counts = Counter(finding.severity for finding in report.findings)
    names: tuple[tuple[Severity, str], ...] = (("error", "error"), ("warning", "warning"), ("info", "remark"))
    parts = [f"{counts[key]} {name}{'s' if counts[key] > 1 else ''}" for key, name in names if counts[key]]
    return ", ".join(parts) or "nothing found"


def _status(report: MapReport) -> tuple[str, Rgb]:
    color = COLORS[report.findings[0].severity] if report.findings else GOOD
    return count_by_severity(report), color


def _as_costmap(grid: OccupancyGrid) -> Costmap:
    costs = np.full(grid.shape, FREE_SPACE, dtype=np.uint8)
    costs[grid.data == OCCUPIED] = LETHAL
    costs[grid.data == UNKNOWN] = NO_INFORMATION
    return Costmap(costs, grid.resolution, grid.origin, _POINT, inflation_radius=0.0)


def _add_list(page: Image.Image, findings: tuple[Finding, ...]) -> Image.Image:
    shown = findings[:_MOST_LINES]
    rest = len(findings) - len(shown)
    whole = Image.new("RGB", (page.width, page.height + _LINE * len(shown) + (28 if rest else 0) + 16), PAGE)
    whole.paste(page, (0, 0))
    draw = ImageDraw.Draw(whole)
    letters, small = font(16), font(14)
    room = page.width - 28 - 72
    for index, finding in enumerate(shown):
        y = page.height + index * _LINE
        number = str(index + 1)
        draw.rounded_rectangle((28, y, 60, y + 24), radius=5, fill=COLORS[finding.severity])
        draw.text((44, y + 12), number, font=letters, fill=PAGE, anchor="mm")
        draw.text((72, y), _fit(f"{finding.kind} · {finding.message}", 16, room), font=letters, fill=INK)
        draw.text((72, y + 20), _fit(f"Fix: {finding.fix}", 14, room), font=small, fill=FAINT)
    if rest:
        draw.text((72, page.height + _LINE * len(shown)), f"and {rest} more", font=letters, fill=FAINT)
    return whole


def _fit(text: str, size: int, room: float) -> str:
    text = plain(text)
    letters = font(size)
    if letters.getlength(text) <= room:
        return text
    while letters.getlength(f"{text}…") > room:
        text = text[:-1]
    return f"{text}…"
