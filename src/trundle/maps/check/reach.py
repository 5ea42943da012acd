"""Where a robot can go on a map: doors that it fits through, and whether its start and goals are free and connected."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import inflate, mark_gaps
from trundle.geometry import Pose2D
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check.areas import Area, Areas, Chart, Mask, grow, shorten
from trundle.maps.check.finding import Finding
from trundle.robots import Robot

# Found on good maps of all generated worlds, which must not raise a warning: there are slits of 5 cm behind desks.
_DETOUR_M = 2.5  # a gap with a detour that stays within this distance is not a door
_LEAST_ROOM_M2 = 1.0  # behind a door; less is a corner between things
# As a share of the robot's width, and in metres: a narrower gap is a slit between things and not a door.
_LEAST_ONLY = (0.35, 0.15)
_LEAST_DETOUR = (0.6, 0.25)  # where there is a detour
_SLACK = 1.1  # slanted gaps are up to 8 % narrower than the runs of cells that find them
_LEVELS = 250  # widths that are told apart: costs of 8 bits hold no more


def check_reach(chart: Chart, robot: Robot | None, start: Pose2D | None, goals: Sequence[Pose2D]) -> list[Finding]:
    """Check whether a robot can stand at the start and the goals, and whether one free area connects them.

    With a robot, a cell is free where its inscribed circle touches nothing, as on a costmap; without one, a free cell.
    Start or goals alone are compared with the largest area.
    """
    places = [("the start", start)] if start is not None else []
    places += [("the goal" if len(goals) == 1 else f"goal {n}", goal) for n, goal in enumerate(goals, start=1)]
    if not places:
        return []
    passable = chart.free if robot is None else _passable(chart, robot)
    areas = Areas(passable, diagonal=robot is not None)
    home = int(np.argmax(areas.sizes)) + 1 if len(areas) else 0
    home_name = "the largest free area"
    findings: list[Finding] = []
    for name, pose in places:
        blocked = _describe_blocked(chart, passable, name, pose)
        if blocked is not None:
            findings.append(blocked)
            continue
        row, col = (int(index) for index in chart.grid.world_to_cell(pose.x, pose.y))
        label = int(areas.labels[row, col])
        if name == "the start" and goals:
            home, home_name = label, "the start"
        elif label != home:
            findings.append(
                _finding(
                    f"{name} ({pose.x:g}, {pose.y:g}) is in a free area of "
                    f"{chart.square_metres(areas.area(label - 1).cells)} that is not joined to {home_name}"
                    + (f" for {robot.name}" if robot else ""),
                    pose,
                    "choose a place in the same area, or look for a wall or a narrow door in between",
                )
            )
    return findings


def _passable(chart: Chart, robot: Robot) -> Mask:
    reach = (robot.inscribed_radius + 1e-9) / chart.grid.resolution
    table = np.full(int(reach * reach) + 1, 253, dtype=np.uint8)
    table[0] = 254
    return inflate(chart.grid.data, table) == 0


def _describe_blocked(chart: Chart, passable: Mask, name: str, pose: Pose2D) -> Finding | None:
    grid = chart.grid
    row, col = (int(index) for index in grid.world_to_cell(pose.x, pose.y))
    where = f"{name} ({pose.x:g}, {pose.y:g})"
    if not grid.contains(row, col):
        return _finding(f"{where} lies outside the map", pose, "choose a place on the map")
    if passable[row, col]:
        return None
    value = grid.data[row, col]
    what = {OCCUPIED: "lies in an obstacle", UNKNOWN: "lies in unknown space"}.get(int(value), "is too near to a wall")
    rows, cols = np.nonzero(passable)
    if len(rows) == 0:
        return _finding(f"{where} {what}", pose, "there is no free place on this map")
    nearest = int(np.argmin((rows - row) ** 2 + (cols - col) ** 2))
    x, y = chart.place(rows[nearest], cols[nearest])
    return _finding(f"{where} {what}", pose, f"the nearest free place is ({x:.2f}, {y:.2f})")


def _finding(message: str, pose: Pose2D, fix: str) -> Finding:
    return Finding("disconnected", "error", message, (pose.x, pose.y), fix)


@dataclass(frozen=True, slots=True)
class _Door:
    width: float
    cell: tuple[float, float]
    only_way: bool


def check_doors(chart: Chart, robot: Robot) -> list[Finding]:
    """Find gaps between two roomy places that the robot does not fit through when it drives straight.

    A gap with a detour near it, as between a pillar and a wall, is not a door.
    """
    width = robot.planar.size[1]
    limit = width / chart.grid.resolution * _SLACK
    # A gap beside a hole in the map is not a door.
    free = chart.free | chart.holes
    gaps = mark_gaps((~free).view(np.uint8), limit + 1e-6).view(np.bool_)
    if not gaps.any():
        return []
    rooms = Areas(free & ~gaps, diagonal=False)
    large = rooms.sizes * chart.grid.resolution**2 >= max(_LEAST_ROOM_M2, width**2)
    search = _Search(chart, free, Areas(gaps, diagonal=True), np.where(rooms.select(large), rooms.labels, 0), width)
    doors = [
        door
        for index in search.near_rooms()
        if (door := search.examine(index)) and _least_width(door, width) <= door.width + 1e-6 < width
    ]
    doors.sort(key=lambda door: (not door.only_way, door.width))
    findings = [_describe(door, chart, robot, width) for door in doors]
    return shorten(findings, len(findings), "narrow doors")


def _least_width(door: _Door, width: float) -> float:
    share, metres = _LEAST_ONLY if door.only_way else _LEAST_DETOUR
    return max(share * width, metres)


def _describe(door: _Door, chart: Chart, robot: Robot, width: float) -> Finding:
    row, col = door.cell
    size = f"door of {door.width:.2f} m: {robot.name} is {width:.2f} m wide"
    if door.only_way:
        return Finding(
            "narrow_door",
            "warning",
            f"{size}, and what is beyond cannot be reached otherwise",
            chart.place(row, col),
            "widen it in the map if the real one is wider (a finer resolution helps), or use a narrower robot",
        )
    return Finding(
        "narrow_door",
        "info",
        f"{size}; there is a detour",
        chart.place(row, col),
        "nothing, if the detour is meant; else check the door's real width",
    )


class _Search:
    """Examines gaps one by one, each in a window that is large enough to see a detour.

    Args:
        chart: The map.
        free: Its free cells, holes included.
        gaps: Clusters of runs of free cells that are too short for the robot.
        rooms: The number of the room of each cell, 0 for gaps, walls and places without room.
        width: Width of the robot [m].
    """

    def __init__(self, chart: Chart, free: Mask, gaps: Areas, rooms: npt.NDArray[np.int32], width: float) -> None:
        self._chart = chart
        self._free = free
        self._gaps = gaps
        self._rooms = rooms
        self._width = width

    def near_rooms(self) -> list[int]:
        """Return clusters that touch a room at two cells at least."""
        return np.flatnonzero(self._gaps.beside(self._rooms > 0) >= 2).tolist()

    def examine(self, index: int) -> _Door | None:
        """Return the door at a cluster, or None."""
        gap = self._gaps.area(index)
        ring = self._window(gap, 1)
        own = self._gaps.labels[ring] == gap.label
        sides = Areas((self._rooms[ring] > 0) & grow(own, 1), diagonal=True)
        if len(sides) < 2:
            return None
        window = self._window(gap, math.ceil(_DETOUR_M / self._chart.grid.resolution))
        own = self._gaps.labels[window] == gap.label
        rooms = self._rooms[window]
        parts = Areas(rooms > 0, diagonal=False)
        touching = parts.beside(own) > 0
        if np.count_nonzero(touching) < 2:
            return None
        first, second = np.argsort(np.where(touching, parts.sizes, 0), kind="stable")[:-3:-1].tolist()
        allowed = own | (rooms > 0)
        half = _HalfCells(self._free[window], allowed, self._width / self._chart.grid.resolution)
        ends = [parts.labels == side + 1 for side in (first, second)]
        found = half.narrowest(own, ends[0], ends[1])
        if found is None:
            return None
        cells, (row, col) = found
        only = rooms[ends[0]][0] != rooms[ends[1]][0]
        place = (window[0].start + row, window[1].start + col)
        return _Door(cells * self._chart.grid.resolution, place, bool(only))

    def _window(self, gap: Area, margin: int) -> tuple[slice, slice]:
        rows, cols = self._rooms.shape
        return (
            slice(max(0, gap.row - margin), min(rows, gap.row_end + margin)),
            slice(max(0, gap.col - margin), min(cols, gap.col_end + margin)),
        )


class _HalfCells:
    """A part of a map on a lattice of half cells, on which distances to the squares of blocked cells are exact.

    Args:
        free: The free cells.
        allowed: The free cells that may be passed.
        limit: The widest gap that matters, in cells.
    """

    def __init__(self, free: Mask, allowed: Mask, limit: float) -> None:
        self._reach = limit * _SLACK + 1.0  # in half cells, as the radius of a disc as wide as the gap
        self._allowed = _nodes(allowed, closed=True)
        blocked = np.where(_nodes(~free, closed=True), np.int8(100), np.int8(0))
        squared = np.arange(int(self._reach**2) + 1)
        self._step = self._reach / _LEVELS if len(squared) > _LEVELS else 0.0
        ranks = np.sqrt(squared) / self._step if self._step else squared
        table = (252 - np.minimum(ranks, _LEVELS + 1)).astype(np.uint8)
        table[0] = 254
        costs = inflate(np.ascontiguousarray(blocked), table)
        # From 0 at a blocked cell up to the largest where all is farther than the reach.
        self._levels = np.where(costs == 254, -1, 252 - costs.astype(np.int16))

    def narrowest(self, gap: Mask, start: Mask, end: Mask) -> tuple[float, tuple[float, float]] | None:
        """Return the width [cells] of the widest path from start to end and its narrowest cell; None without one."""
        start_nodes, end_nodes = _nodes(start, closed=False), _nodes(end, closed=False)
        values = np.flatnonzero(np.bincount(self._levels[self._levels > 0]))
        low, high, best = 0, len(values) - 1, None
        while low <= high:
            middle = (low + high) // 2
            path = self._connect(int(values[middle]), start_nodes, end_nodes)
            if path is None:
                high = middle - 1
            else:
                low, best = middle + 1, (int(values[middle]), path)
        if best is None:
            return None
        level, path = best
        tight = path & _nodes(gap, closed=True) & (self._levels == level)
        if not tight.any():
            tight = path & (self._levels == level)
        rows, cols = np.nonzero(tight)
        gap_rows, gap_cols = np.nonzero(gap)
        middle_row, middle_col = 2 * gap_rows.mean() + 1, 2 * gap_cols.mean() + 1
        nearest = int(np.argmin((rows - middle_row) ** 2 + (cols - middle_col) ** 2))
        # A node is half a cell from the next; the radius in half cells is the width in cells.
        width = (level + 1) * self._step if self._step else math.sqrt(level)
        return width, ((rows[nearest] - 1) / 2.0, (cols[nearest] - 1) / 2.0)

    def _connect(self, level: int, start: Mask, end: Mask) -> Mask | None:
        wide = Areas((self._levels >= level) & self._allowed, diagonal=True)
        common = np.intersect1d(wide.labels[start], wide.labels[end])
        common = common[common > 0]
        return None if len(common) == 0 else wide.labels == common[0]


def _nodes(cells: Mask, *, closed: bool) -> Mask:
    """Return nodes of the half-cell lattice, shape (2·rows + 1, 2·cols + 1): middles of cells, and rims if closed."""
    rows, cols = cells.shape
    nodes = np.zeros((2 * rows + 1, 2 * cols + 1), dtype=np.bool_)
    nodes[1::2, 1::2] = cells
    if closed:
        nodes[:-1:2] |= nodes[1::2]
        nodes[2::2] |= nodes[1::2]
        nodes[:, :-1:2] |= nodes[:, 1::2]
        nodes[:, 2::2] |= nodes[:, 1::2]
    return nodes
