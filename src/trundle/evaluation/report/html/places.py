"""A map of each world with where robots failed, came close and stood; and the failures in clusters."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise

import numpy as np

from trundle.evaluation.report.html.charts import CLOSE, MARKED, count_text, icon, kind_of
from trundle.evaluation.report.html.world_map import Cluster, Frame, WorldMap, draw_map, find_clusters
from trundle.evaluation.report.text import cause, replay_command
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.figures import write_number
from trundle.evaluation.statistics.table import VARIANT, Table, cluster_of
from trundle.maps.grid import OccupancyGrid

Maps = Callable[[str], OccupancyGrid | None]
"""The map of a place by its key; None where it is not known."""

_MOST_WORLDS = 6
_MOST_MAPS = 24
_MAP_BYTES = 260_000
"""The size of all maps in the page together; worlds with fewer failures have none."""
_MOST_CARDS = 24
_MOST_MARKS = 300
_MOST_LOST = 60
_CLOSE_SHOWN = 20
_MORE = 6
_CARD = (300.0, 200.0)
_LEAST_VIEW = 5.0
"""Half the width of a thumbnail [m]."""
_SCALE_STEPS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 5000.0)


@dataclass(slots=True)
class Place:
    """One world with what happened in it.

    Attributes:
        key: Its number in the table.
        title: Name of the place, for people.
        rows: Numbers of its rows in the table.
        map_key: Key of its map; None where no row that was kept has one.
        failed: Its rows that did not arrive, as far as they were kept.
        located: Failures that have a place, in order; clusters refer to them.
        clusters: Clusters of `located`.
        drawn: Its map; None where there is none, or no more room.
        name: Name of the map in the page.
    """

    key: int
    title: str
    rows: np.ndarray
    map_key: str | None = None
    failed: list[Row] = field(default_factory=list)
    located: list[Row] = field(default_factory=list)
    clusters: list[Cluster] = field(default_factory=list)
    drawn: WorldMap | None = None
    name: str = ""


def find_places(table: Table, maps: Maps) -> list[Place]:
    """Return the worlds, those with the most failures first, with as many maps as the page has room for."""
    keys, first, codes = np.unique(table.clusters, return_index=True, return_inverse=True)
    worlds = table.named["world"]
    several = Counter(worlds.of(row) for row in first)
    order = np.argsort(codes, kind="stable")
    parts = np.split(order, np.cumsum(np.bincount(codes, minlength=len(keys)))[:-1])
    places: dict[int, Place] = {}
    for key, row, rows in zip(keys.tolist(), first.tolist(), parts, strict=True):
        world = worlds.of(row)
        title = world if several[world] == 1 else f"{world}, seed {int(table.seed[row])}"
        places[key] = Place(key, title, rows)
    for row in table.failed:
        places[cluster_of(row)].failed.append(row)
    for row in (*table.failed, *(row for rows in table.examples.values() for row in rows)):
        places[cluster_of(row)].map_key = row.place
    ordered = sorted(places.values(), key=lambda place: (-len(place.failed), int(place.rows.min())))
    for number, place in enumerate(ordered):
        place.located = [row for row in place.failed if _failed_at(row) is not None]
        place.clusters = find_clusters(np.array([_failed_at(row) for row in place.located]).reshape(-1, 2))
        place.name = f"map-{number}"
    _draw_maps(ordered, maps)
    return ordered


def _draw_maps(places: Sequence[Place], maps: Maps) -> None:
    room = _MAP_BYTES
    for rank, place in enumerate(places[:_MOST_MAPS]):
        wanted = place.failed or rank < _MOST_WORLDS
        grid = maps(place.map_key) if wanted and place.map_key is not None else None
        if grid is None:
            continue
        drawn = draw_map(grid)
        room -= len(drawn.png)
        if room < 0:
            return
        place.drawn = drawn


def map_definitions(places: Sequence[Place]) -> str:
    """Return the pictures of the maps, to be used by name; once in a page."""
    images = "".join(place.drawn.image(place.name) for place in places if place.drawn is not None)
    return f'<svg class="defs" aria-hidden="true"><defs>{images}</defs></svg>'


def world_maps(table: Table, places: Sequence[Place]) -> str:
    """Return a map of each world, with its failures as numbered clusters, the closest passes, and some trails."""
    shown = places[:_MOST_WORLDS]
    figures = "".join(_world_figure(table, place, _numbers(places)) for place in shown)
    outcomes = {kind_of(row.outcome) for row in table.failed}
    key = [(kind, kind.replace("_", " ").replace("broken", "crashed, hung or error")) for kind in MARKED]
    entries = [f"<span>{icon(kind)}{text}</span>" for kind, text in key if kind in outcomes]
    entries.append(f"<span>{icon(CLOSE)}closest passes of those that arrived</span>")
    entries.append(
        '<span><svg class="line" viewBox="0 0 34 12"><path class="trail" d="M0 6h34"/></svg>drove here</span>'
    )
    entries.append(
        '<span><svg class="line" viewBox="0 0 34 12"><path class="lost" d="M0 6h34"/></svg>and failed</span>'
    )
    entries.append('<span><span class="no">1</span>failures within 2 m, listed below</span>')
    more = ""
    if len(places) > len(shown):
        more = f" These are the {len(shown)} with the most failures of {len(places):,} worlds."
    return (
        '<section><h2>Where it fails</h2><p class="note">Each mark is an episode, where the robot stood when it ended '
        f"or where it came closest to something.{more}</p>"
        f'<div class="key">{"".join(entries)}</div><div class="figures maps">{figures}</div></section>'
    )


def failure_cards(table: Table, places: Sequence[Place], folder: str) -> str:
    """Return a card for each cluster of failures: a thumbnail, its causes, and the command that repeats an episode."""
    if not table.failed:
        return "<section><h2>Failures</h2><p>None: every episode arrived.</p></section>"
    numbers = _numbers(places)
    cards = [
        _card(place, place.clusters[at], number, folder, variant_labels(table))
        for (key, at), number in numbers.items()
        for place in places
        if place.key == key
    ]
    cards += cards_without_place(table, folder)
    clusters = sum(len(place.clusters) for place in places)
    more = "" if clusters <= len(numbers) else f" The {len(numbers)} largest of {clusters:,} clusters are shown."
    command = escape(f"trundle evaluate show {folder} --failed")
    return (
        '<section><h2>Failures</h2><p class="note">Failures within 2 m of each other are one cluster, with one of '
        "its episodes as the example: ○ start, ◎ goal (dashed: which way it is), and ringed where it ended."
        f"{more} All of them: <code>{command}</code></p>"
        f'<div class="figures cards">{"".join(cards)}</div></section>'
    )


def _numbers(places: Sequence[Place]) -> dict[tuple[int, int], int]:
    """Number the clusters that have a card, by place and position in it; the largest first."""
    every = [
        (-len(cluster.members), rank, at)
        for rank, place in enumerate(places)
        for at, cluster in enumerate(place.clusters)
    ]
    best = sorted(every)[:_MOST_CARDS]
    return {(places[rank].key, at): number for number, (_, rank, at) in enumerate(best, 1)}


def _failed_at(row: Row) -> tuple[float, float] | None:
    if row.end_x is not None and row.end_y is not None:
        return row.end_x, row.end_y
    return None if row.start_x is None or row.start_y is None else (row.start_x, row.start_y)


def _world_figure(table: Table, place: Place, numbers: dict[tuple[int, int], int]) -> str:
    frame = _frame(table, place)
    if frame is None:
        return ""
    parts = [_ground(place, frame)]
    arrived = [
        row
        for row in table.examples.get(table.named["world"].of(int(place.rows[0])), ())
        if cluster_of(row) == place.key
    ]
    parts += [f'<path class="trail" d="{_path(row.trail, frame)}"/>' for row in arrived]
    lost = [row for row in place.located if row.trail][:_MOST_LOST]
    parts += [f'<path class="lost" d="{_path(row.trail, frame)}"/>' for row in lost]
    close = _closest(table, place)
    parts += [_mark(CLOSE, frame.x(x), frame.y(y)) for x, y in close]
    step = max(1, -(-len(place.located) // _MOST_MARKS))
    for row in place.located[::step]:
        x, y = _failed_at(row) or (0.0, 0.0)
        parts.append(_mark(kind_of(row.outcome), frame.x(x), frame.y(y)))
    for at, cluster in enumerate(place.clusters):
        number = numbers.get((place.key, at))
        if number is not None:
            parts.append(_number(number, frame, cluster.center))
    parts.append(_scale_bar(frame, frame.width, frame.height))
    n, failed = len(place.rows), int((~table.arrived[place.rows]).sum())
    counted = "1 failure" if failed == 1 else f"{failed:,} failures"
    note = "" if place.drawn is not None else " (its map is not in this page)"
    fewer = "" if step == 1 else f"; 1 in {step} failures is marked"
    text = f"{place.title}: {n:,} episodes, {counted}"
    size = f"0 0 {frame.width:.0f} {frame.height:.0f}"
    return (
        f"<figure><b>{escape(place.title)}</b>{note}<figcaption>{n:,} episodes, {counted}{fewer}</figcaption>"
        f'<svg viewBox="{size}" role="img" aria-label="{escape(text)}">{"".join(parts)}</svg></figure>'
    )


def _frame(table: Table, place: Place) -> Frame | None:
    """Return the frame of the place's map, or else one around its episodes; None if no position is known."""
    if place.drawn is not None:
        return place.drawn.frame
    numbers = table.numbers
    pairs = (("closest_x", "closest_y"), ("end_x", "end_y"))
    known = [np.stack([numbers[x][place.rows], numbers[y][place.rows]], axis=1) for x, y in pairs]
    points = np.concatenate([*known, np.array([_failed_at(row) for row in place.located]).reshape(-1, 2)])
    points = points[~np.isnan(points).any(axis=1)]
    return Frame.around(points, margin=1.0) if len(points) else None


def _ground(place: Place, frame: Frame) -> str:
    if place.drawn is None:
        return f'<rect class="bare" width="{frame.width:.0f}" height="{frame.height:.0f}"/>'
    return f'<use href="#{place.name}"/>'


def _closest(table: Table, place: Place) -> list[tuple[float, float]]:
    """Return where robots that arrived came closest to something, for the closest of them."""
    rows = place.rows[table.arrived[place.rows]]
    clearance = table.numbers["min_clearance_m"][rows]
    x, y = (table.numbers[name][rows].astype(float) for name in ("closest_x", "closest_y"))
    known = np.flatnonzero(~np.isnan(clearance) & ~np.isnan(x) & ~np.isnan(y))
    best = known[np.argsort(clearance[known], kind="stable")[:_CLOSE_SHOWN]]
    return list(zip(x[best].tolist(), y[best].tolist(), strict=True))


def _path(trail: Sequence[float], frame: Frame, scale: float = 1.0, left: float = 0.0, top: float = 0.0) -> str:
    """Return a trail as an SVG path in whole units, relative after its first point."""
    points = [
        (round((frame.x(x) - left) * scale), round((frame.y(y) - top) * scale))
        for x, y in zip(trail[::2], trail[1::2], strict=True)
    ]
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(points)]
    moves = " ".join(f"{dx} {dy}" for dx, dy in steps if (dx, dy) != (0, 0))
    return f"M{points[0][0]} {points[0][1]}l{moves}" if moves else f"M{points[0][0]} {points[0][1]}"


def _mark(kind: str, x: float, y: float) -> str:
    return f'<use href="#m-{kind}" x="{x:.0f}" y="{y:.0f}"/>'


def _number(number: int, frame: Frame, center: tuple[float, float]) -> str:
    """Draw the number of a cluster, up and right of it, or on the other side at the drawing's edge."""
    x, y = frame.x(center[0]), frame.y(center[1])
    across = 24.0 if x < frame.width - 40.0 else -24.0
    up = -24.0 if y > 40.0 else 24.0
    return (
        f'<g class="number" transform="translate({x + across:.0f} {y + up:.0f})"><circle r="15"/>'
        f'<text y="7" font-size="20">{number}</text></g>'
    )


def _scale_bar(frame: Frame, width: float, height: float, scale: float = 1.0) -> str:
    """Draw a bar of a round length, at the lower left."""
    unit = frame.scale * scale
    length = max([step for step in _SCALE_STEPS if step * unit <= 0.3 * width] or [_SCALE_STEPS[0]])
    size = 22 if scale == 1.0 and width > 500.0 else 12
    y = height - 0.6 * size
    bar = f"M{0.6 * size:.0f} {y:.0f}h{length * unit:.0f}"
    return (
        f'<path class="under" d="{bar}"/><path class="scale" d="{bar}"/>'
        f'<text class="scaletext" x="{0.6 * size:.0f}" y="{y - 0.35 * size:.0f}" font-size="{size}">{length:g} m</text>'
    )


def variant_labels(table: Table) -> list[str]:
    """Return the labels in which the settings differ."""
    return [name for name in VARIANT if len(table.named[name].names) > 1]


def _card(place: Place, cluster: Cluster, number: int, folder: str, variants: Sequence[str]) -> str:
    rows = [place.located[member] for member in cluster.members]
    title = f'<span class="no">{number}</span><b>{escape(place.title)}</b>'
    x, y = (round(number, 1) + 0.0 for number in cluster.center)
    near = f"near ({x:.1f}, {y:.1f})"
    words = _words(rows, folder, variants)
    return f'<div class="card">{thumbnail(place, rows)}<div><p>{title} {near}</p>{words}</div></div>'


def cards_without_place(table: Table, folder: str) -> list[str]:
    """Return a card for each cause of failures of which not even the start is known."""
    causes: dict[str, list[Row]] = {}
    for row in table.failed:
        if _failed_at(row) is None:
            causes.setdefault(cause(row), []).append(row)
    variants = variant_labels(table)
    ordered = sorted(causes.values(), key=lambda rows: -len(rows))[:_MORE]
    return [
        f'<div class="card"><div><p><b>Before the start</b></p>{_words(rows, folder, variants)}</div></div>'
        for rows in ordered
    ]


def _words(rows: Sequence[Row], folder: str, variants: Sequence[str]) -> str:
    counts = dict(Counter(row.outcome for row in rows).most_common())
    parts = [f"<p>{count_text(counts)}</p>"]
    if variants:
        names = Counter(" · ".join(getattr(row, name) or "default" for name in variants) for row in rows)
        text = ", ".join(name if len(rows) == 1 else f"{name} ({count})" for name, count in names.most_common(3))
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        parts.append(f'<p class="note">{escape(text + more)}</p>')
    text = cause(rows[0])
    parts.append(f"<p>{escape(text if len(text) <= 300 else text[:299] + '…')}</p>")
    parts.append(f"<p><code>{escape(replay_command(folder, rows[0].id))}</code></p>")
    others = rows[1 : 1 + _MORE]
    if others:
        left_out = len(rows) - 1 - len(others)
        more = f'<br><span class="note">and {left_out:,} more</span>' if left_out else ""
        items = "<br>".join(f"<code>{escape(replay_command(folder, row.id))}</code>" for row in others)
        parts.append(f"<details><summary>{len(rows) - 1:,} more like it</summary>{items}{more}</details>")
    return "".join(parts)


def thumbnail(place: Place, rows: Sequence[Row]) -> str:
    """Draw the surroundings of a cluster, with the route of its first episode and where all of them ended."""
    points = np.array([_failed_at(row) for row in rows])
    center = points.mean(axis=0)
    half = max(_LEAST_VIEW, 1.3 * float(np.abs(points - center).max()))
    frame = place.drawn.frame if place.drawn is not None else Frame.around([center], margin=half)
    wide, high = _CARD
    scale = wide / (2.0 * half * frame.scale)
    left, top = frame.x(center[0]) - wide / (2.0 * scale), frame.y(center[1]) - high / (2.0 * scale)

    def place_at(x: float, y: float) -> tuple[float, float]:
        return (frame.x(x) - left) * scale, (frame.y(y) - top) * scale

    parts = [f'<rect class="bare" width="{wide:g}" height="{high:g}"/>']
    if place.drawn is not None:
        move = f"scale({scale:.5g}) translate({-left:.2f} {-top:.2f})"
        parts.append(f'<use href="#{place.name}" transform="{move}"/>')
    example = rows[0]
    if example.trail:
        path = _path(example.trail, frame, scale, left, top)
        parts.append(f'<path class="halo" d="{path}"/><path class="route" d="{path}"/>')
    if example.start_x is not None and example.start_y is not None:
        x, y = place_at(example.start_x, example.start_y)
        parts.append(f'<circle class="start" cx="{x:.0f}" cy="{y:.0f}" r="5"/>')
    if example.goal_x is not None and example.goal_y is not None:
        x, y = place_at(example.goal_x, example.goal_y)
        ended = place_at(*(_failed_at(example) or (0.0, 0.0)))
        parts.append(f'<path class="aim" d="M{ended[0]:.0f} {ended[1]:.0f}L{x:.0f} {y:.0f}"/>')
        parts.append(f'<g class="goal" transform="translate({x:.0f} {y:.0f})"><circle r="7"/><circle r="1.5"/></g>')
    for row in rows[:_MOST_MARKS][::-1]:
        x, y = place_at(*(_failed_at(row) or (0.0, 0.0)))
        parts.append(f'<g transform="translate({x:.0f} {y:.0f}) scale(.7)">{_mark(kind_of(row.outcome), 0.0, 0.0)}</g>')
    x, y = place_at(*(_failed_at(example) or (0.0, 0.0)))
    parts.append(f'<circle class="ring" cx="{x:.0f}" cy="{y:.0f}" r="11"/>')
    parts.append(_scale_bar(frame, wide, high, scale))
    clearance = "" if example.min_clearance_m is None else f", closest {write_number(example.min_clearance_m)} m"
    text = f"{example.outcome} in {place.title}{clearance}"
    return f'<svg viewBox="0 0 {wide:g} {high:g}" role="img" aria-label="{escape(text)}">{"".join(parts)}</svg>'
