"""A picture of a map with the drive that made it: poses, loops, and the largest corrections by number."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from trundle.costmap import FREE_SPACE, LETHAL, NO_INFORMATION, Costmap
from trundle.mapping import PoseGraph
from trundle.mapping.parts import Correction, find_corrections, joined_nodes
from trundle.maps.grid import OccupancyGrid
from trundle.maps.ros_writer import FREE_THRESH, OCCUPIED_THRESH
from trundle.pictures.colors import BAD, ESTIMATED, GOAL, GOOD, LINE, PAGE, SAMPLED, START, WARNING, Rgb
from trundle.pictures.colors import OCCUPIED as WALL
from trundle.pictures.colors import UNKNOWN as DARK
from trundle.pictures.figure import font
from trundle.record.map_view import MapView
from trundle.record.page import Mark, compose_page

MOST_NAMED = 5
"""Corrections that are named."""

_POINT = np.array([[1e-3, 1e-3], [-1e-3, 1e-3], [-1e-3, -1e-3], [1e-3, -1e-3]])
_PARTS: tuple[Rgb, ...] = (LINE, ESTIMATED, SAMPLED, GOAL, START)
_TAG = 24  # [px]
_LEAST_M = 0.05  # smaller corrections are those of scan matching
_APART_M = 1.0  # loops that are nearer to one already named are told together with it


def draw_drive(grid: OccupancyGrid, graph: PoseGraph, *, title: str) -> Image.Image:
    """Draw a map, the path of the robot on it, and its loops.

    Args:
        grid: The map of the graph.
        graph: The graph.
        title: Headline.
    """
    view = MapView(_as_costmap(grid))
    joined = joined_nodes(graph)
    corrections = [one for one in find_corrections(graph) if joined[one.first] and joined[one.second]]
    parts = [part for part in np.unique(graph.parts).tolist() if joined[graph.parts == part].any()]
    for number, part in enumerate(parts):
        nodes = np.flatnonzero((graph.parts == part) & joined)
        view.line(graph.poses[nodes, :2], _PARTS[number % len(_PARTS)], 2.5)
    for one in corrections:
        view.line(graph.poses[[one.first, one.second], :2], WARNING, 1.5)
    view.disc(graph.poses[0, :2].tolist(), 6.0, GOOD)
    named = choose_corrections(graph, corrections)
    for one in named:
        view.ring(graph.poses[one.second, :2].tolist(), 9.0, BAD, 3.0)
    picture = view.finish()
    draw = ImageDraw.Draw(picture)
    for number, one in enumerate(named, start=1):
        x, y = view.to_pixels([graph.poses[one.second, :2]])[0].tolist()
        left, top = min(max(0.0, x + 10.0), picture.width - _TAG), min(max(0.0, y - 34.0), picture.height - _TAG)
        draw.rounded_rectangle((left, top, left + _TAG, top + _TAG), radius=5, fill=BAD)
        draw.text((left + _TAG / 2, top + _TAG / 2), str(number), font=font(16), fill=PAGE, anchor="mm")
    lines = [*tell_graph(graph), *(f"{number}  {tell(graph, one)}" for number, one in enumerate(named, start=1))]
    marks = [Mark("line", _PARTS[number % len(_PARTS)], _name(part, parts)) for number, part in enumerate(parts[:5])]
    if corrections:
        marks.append(Mark("line", WARNING, "loops"))
    return compose_page(
        picture,
        title=title,
        status=None,
        lines=lines,
        legend=(Mark("square", WALL, "occupied"), Mark("square", DARK, "unknown"), *marks),
        pixels_per_metre=view.pixels_per_metre,
    )


def tell_graph(graph: PoseGraph) -> list[str]:
    """Return lines that say how large a pose graph is, and what of it is in no map yet."""
    joined = joined_nodes(graph)
    loops = len(find_corrections(graph))
    length = drive_length(graph)
    lines = [f"{len(graph.times)} poses, {len(graph.scan_nodes)} scans, {loops} loops, {length:.1f} m driven"]
    apart = sorted({int(part) + 1 for part in graph.parts[~joined]})
    if apart:
        names = ", ".join(map(str, apart))
        lines.append(
            f"not in the map: part {names} ({int((~joined).sum())} poses): nothing seen there ties it to part 1 yet"
        )
    return lines


def drive_length(graph: PoseGraph) -> float:
    """Return how far the robot drove [m], by the odometry of the nodes."""
    if len(graph.times) < 2:
        return 0.0
    same = graph.parts[1:] == graph.parts[:-1]
    steps = np.hypot(*np.diff(graph.odometry[:, :2], axis=0).T)
    return float(steps[same].sum())


def choose_corrections(graph: PoseGraph, corrections: Sequence[Correction], most: int = MOST_NAMED) -> list[Correction]:
    """Return those that are worth a name: one of each place, joints of parts first, then the largest."""
    chosen: list[Correction] = []
    tied: set[frozenset[int]] = set()
    for one in corrections:
        if one.metres is None:  # the first loop between two parts joins them
            parts = frozenset((int(graph.parts[one.first]), int(graph.parts[one.second])))
            if parts in tied:
                continue
            tied.add(parts)
        elif one.metres < _LEAST_M:
            continue
        place = graph.poses[one.second, :2]
        if all(np.hypot(*(graph.poses[other.second, :2] - place)) > _APART_M for other in chosen):
            chosen.append(one)
        if len(chosen) == most:
            break
    return chosen


def tell(graph: PoseGraph, one: Correction) -> str:
    """Return what a loop has changed."""
    x, y = graph.poses[one.second, :2].tolist()
    part = graph.parts == graph.parts[one.second]
    after = one.time - graph.times[part][0]
    many = f" of part {int(graph.parts[one.second]) + 1}" if not part.all() else ""
    where = f"at ({x:.1f}, {y:.1f}), {after:.0f} s after the begin{many}"
    if one.metres is None or one.radians is None:
        return f"{where}: part {int(graph.parts[one.second]) + 1} joins part {int(graph.parts[one.first]) + 1}"
    return f"{where}: corrected by {one.metres:.2f} m and {math.degrees(one.radians):.1f}°"


def _name(part: int, parts: Sequence[int]) -> str:
    return "path" if len(parts) == 1 else f"part {part + 1}"


def _as_costmap(grid: OccupancyGrid) -> Costmap:
    """Return the map as its file shows it: free, occupied, and unknown for all between."""
    costs = np.full(grid.shape, FREE_SPACE, dtype=np.uint8)
    costs[(grid.data < 0) | (grid.data >= 100.0 * FREE_THRESH)] = NO_INFORMATION
    costs[grid.data >= 100.0 * OCCUPIED_THRESH] = LETHAL
    return Costmap(costs, grid.resolution, grid.origin, _POINT, inflation_radius=0.0)
