"""A picture of a map with the findings of its check."""

from __future__ import annotations

from collections import Counter

import numpy as np
from PIL import Image, ImageDraw

from trundle.costmap import FREE_SPACE, LETHAL, NO_INFORMATION, Costmap
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check import MapReport, Severity
from trundle.maps.check.finding import Group, group_findings, tell_small
from trundle.maps.grid import OccupancyGrid
from trundle.pictures.colors import BAD, FAINT, GOOD, INK, PAGE, WARNING, Rgb
from trundle.pictures.colors import OCCUPIED as WALL
from trundle.pictures.colors import UNKNOWN as DARK
from trundle.pictures.figure import font, plain
from trundle.record.map_view import MapView
from trundle.record.page import Mark, compose_page, draw_tag

COLORS: dict[Severity, Rgb] = {"error": BAD, "warning": WARNING, "info": FAINT}

_POINT = np.array([[1e-3, 1e-3], [-1e-3, 1e-3], [-1e-3, -1e-3], [1e-3, -1e-3]])
_LEGEND = (Mark("square", WALL, "occupied"), Mark("square", DARK, "unknown"))
_RING = 13  # [px]
_TAG = (34, 24)  # room for a number [px]
_LINE = 46  # [px], for each kind of finding below the map
_MOST_LINES = 24
_MOST_RINGS = 20  # per group, at the largest findings
_ASIDE = ((1, -1), (-1, -1), (1, 1), (-1, 1), (1, 0), (-1, 0), (0, -1), (0, 1))
_NAMES: tuple[tuple[Severity, str], ...] = (("error", "error"), ("warning", "warning"), ("info", "remark"))


def draw_report(grid: OccupancyGrid, report: MapReport, *, title: str, robot_area: float | None = None) -> Image.Image:
    """Draw a map with its findings: a ring and a number at each place, and an explanation below.

    Findings of the same kind and fix share a number.

    Args:
        grid: The map.
        report: The findings.
        title: Headline.
        robot_area: Area of the robot's footprint [m²]: smaller free areas are listed last, on one line, without rings.
            By default, it is that of the smallest robot.
    """
    groups, small = group_findings(report.findings, robot_area)
    view = MapView(_as_costmap(grid))
    for group in reversed(groups):
        for finding in group[:_MOST_RINGS]:
            if finding.where is not None:
                view.ring(finding.where, _RING, COLORS[finding.severity], 4)
    picture = view.finish()
    _draw_tags(picture, view, groups)
    found = {finding.severity for finding in report.findings}
    severities = tuple(Mark("square", COLORS[key], name) for key, name in _NAMES if key in found)
    page = compose_page(
        picture,
        title=title,
        status=_status(report),
        lines=[plain(remark) for remark in report.remarks],
        legend=(*_LEGEND, *severities),
        pixels_per_metre=view.pixels_per_metre,
    )
    return _add_list(page, groups, small)


def _draw_tags(picture: Image.Image, view: MapView, groups: list[Group]) -> None:
    """Write the number beside each ring if there is room, and always beside one ring of each group."""
    draw = ImageDraw.Draw(picture)
    rings = [
        (number, finding, [float(at) for at in view.to_pixels([finding.where])[0]])
        for number, group in enumerate(groups, start=1)
        for finding in group[:_MOST_RINGS]
        if finding.where is not None
    ]
    taken = [(x - _RING, y - _RING, x + _RING, y + _RING) for _, _, (x, y) in rings]
    tagged: set[int] = set()
    for number, finding, (x, y) in rings:
        free = next((box for aside in _ASIDE if _has_room(box := _beside(x, y, aside), taken, view.size)), None)
        if free is None and number in tagged:
            continue
        left, top, _, bottom = free or _beside(x, y, _ASIDE[0])
        draw_tag(draw, (left, bottom), str(number), COLORS[finding.severity], apart=0, size=view.size)
        taken.append((left, top, left + _TAG[0], bottom))
        tagged.add(number)


Area = tuple[float, float, float, float]


def _beside(x: float, y: float, aside: tuple[int, int]) -> Area:
    across, down = (_RING + half / 2 for half in _TAG)
    left, top = x + aside[0] * across - _TAG[0] / 2, y + aside[1] * down - _TAG[1] / 2
    return left, top, left + _TAG[0], top + _TAG[1]


def _has_room(box: Area, taken: list[Area], size: tuple[int, int]) -> bool:
    left, top, right, bottom = box
    if left < 2 or top < 2 or right > size[0] - 2 or bottom > size[1] - 2:
        return False
    return not any(left < other[2] and other[0] < right and top < other[3] and other[1] < bottom for other in taken)


def count_by_severity(report: MapReport) -> str:
    """Return the numbers of errors, warnings and remarks as text."""
    counts = Counter(finding.severity for finding in report.findings)
    parts = [f"{counts[key]} {name}{'s' if counts[key] > 1 else ''}" for key, name in _NAMES if counts[key]]
    return ", ".join(parts) or "nothing found"


def _status(report: MapReport) -> tuple[str, Rgb]:
    color = COLORS[report.findings[0].severity] if report.findings else GOOD
    return count_by_severity(report), color


def _as_costmap(grid: OccupancyGrid) -> Costmap:
    costs = np.full(grid.shape, FREE_SPACE, dtype=np.uint8)
    costs[grid.data == OCCUPIED] = LETHAL
    costs[grid.data == UNKNOWN] = NO_INFORMATION
    return Costmap(costs, grid.resolution, grid.origin, _POINT, inflation_radius=0.0)


def _add_list(page: Image.Image, groups: list[Group], small: Group) -> Image.Image:
    shown = groups[:_MOST_LINES]
    last = [f"and {len(groups) - len(shown)} more"] if len(groups) > len(shown) else []
    last += [tell_small(small)] if small else []
    whole = Image.new("RGB", (page.width, page.height + _LINE * len(shown) + 28 * len(last) + 16), PAGE)
    whole.paste(page, (0, 0))
    draw = ImageDraw.Draw(whole)
    letters, finer = font(16), font(14)
    room = page.width - 28 - 72
    for index, group in enumerate(shown):
        y = page.height + index * _LINE
        first = group[0]
        draw.rounded_rectangle((28, y, 60, y + 24), radius=5, fill=COLORS[first.severity])
        draw.text((44, y + 12), str(index + 1), font=letters, fill=PAGE, anchor="mm")
        more = _tell_more(group)
        text = _fit(f"{first.kind} · {first.message}", 16, room - float(letters.getlength(plain(more))))
        draw.text((72, y), text + plain(more), font=letters, fill=INK)
        draw.text((72, y + 20), _fit(f"Fix: {first.fix}", 14, room), font=finer, fill=FAINT)
    for index, text in enumerate(last):
        draw.text((72, page.height + _LINE * len(shown) + 28 * index), _fit(text, 16, room), font=letters, fill=FAINT)
    return whole


def _tell_more(group: Group) -> str:
    return f" · and {len(group) - 1} more" if len(group) > 1 else ""


def _fit(text: str, size: int, room: float) -> str:
    text = plain(text)
    letters = font(size)
    if letters.getlength(text) <= room:
        return text
    while letters.getlength(f"{text}…") > room:
        text = text[:-1]
    return f"{text}…"
