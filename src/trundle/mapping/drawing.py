"""`draw_map`: the map of a pose graph from all of its scans; `LiveMap`: the same while the graph grows."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle._core import count_beams, draw_cells, label_components
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.mapping.nodes import Nodes
from trundle.mapping.parts import component_of
from trundle.mapping.pose_graph import FARTHEST_M, Lidar, PoseGraph
from trundle.maps import OccupancyGrid
from trundle.maps.cells import FREE_UP_TO, MAX_CELLS, UNKNOWN
from trundle.robots import Robot
from trundle.values import check_number

_SHORT_BY_CELLS = 2.0  # beams that graze a wall pass through its cells
# Of the beams in a cell of a wall, many only graze it: with a share of 0.3, 78 % of the surface of a warehouse that was
# seen is mapped, with 0.15 97 %, with 0.08 99 %; 99.8 % of what is marked is right in all cases, also among people.
_LEAST_ENDS, _LEAST_SHARE, _LEAST_BEAMS = 2.0, 0.1, 1.0
_PADDING_M = 1.0
# Far beams that graze a wall pass by many of its cells. Behind such gaps nothing was seen, and the robot does not fit
# through them; where it is not known, few do: a TurtleBot3 Burger is 0.21 m wide, most others more than 0.3 m.
_WIDEST_GAP_M = 0.3
# What lies between far beams, amid free space: nothing that lidars see is so small and apart from all else. A planner
# that goes through known space alone would drive around it.
_SPECK_M2 = 0.02
_WALL = 65
_TILE_M = 8.0
RESOLUTIONS_M = (0.005, 10.0)
"""Edges of cells from the smallest to the largest [m]."""


def draw_map(graph: PoseGraph, *, resolution: float = 0.05, robot: Robot | None = None) -> OccupancyGrid:
    """Draw the map of a pose graph.

    Each cell is as occupied as the share of beams that end in it, of those that reach it. Walls are one cell thick, and
    pass through the middle of their cells on average (`surface` "centre"). Of parts that were not joined, that of the
    first node is drawn.

    Args:
        graph: The pose graph.
        resolution: Edge of a cell [m].
        robot: The robot that is to drive on it: gaps of a wall that it fits through are not closed. If None, those of
            up to 0.3 m are, where nothing was seen behind them.

    Raises:
        InputError: If there is no scan, or the map would be too large.
    """
    resolution = check_number("the map's resolution", resolution, *RESOLUTIONS_M, "m")
    canvas = Canvas(resolution, widest_gap_m(robot))
    roots = component_of(len(graph.times), graph.edges)
    places = graph.poses[np.array(roots, dtype=np.int64) == roots[0], :2] if len(roots) else graph.poses[:, :2]
    if len(places):
        canvas.reach(places.min(axis=0), places.max(axis=0))  # at once: a map that grows is copied each time
    counts = [len(graph.lidars[lidar].angles) for lidar in graph.scan_lidars.tolist()]
    ends = np.cumsum(counts, dtype=np.int64).tolist()
    for i, end in enumerate(ends):
        node, lidar = int(graph.scan_nodes[i]), graph.lidars[int(graph.scan_lidars[i])]
        if roots[node] != roots[0]:
            continue
        beams = place_beams(graph.ranges[end - counts[i] : end], lidar, graph.scan_poses[i])
        canvas.count(beams, graph.poses[node], 1)
    if canvas.is_empty:
        raise InputError("the pose graph has no scan, so there is nothing to draw")
    return canvas.grid(places)


def widest_gap_m(robot: Robot | None) -> float:
    """Return up to which width gaps of walls are closed [m]: not where the robot may fit through; None if unknown."""
    return _WIDEST_GAP_M if robot is None else min(_WIDEST_GAP_M, robot.planar.least_width)


class Beams(tuple[FloatArray, FloatArray, npt.NDArray[np.uint8]]):
    """Where beams began and ended, seen from their node [m], and whether they met something."""


def place_beams(ranges: npt.NDArray[np.float32], lidar: Lidar, poses: FloatArray) -> Beams:
    """Return the beams of a scan; what is too close or not measured is left out.

    Args:
        ranges: As REP-117 has them.
        lidar: The lidar.
        poses: Base_link at the first and at the last beam, seen from the node, shape (2, 3).
    """
    far = min(lidar.range_max, FARTHEST_M)
    met = (ranges >= lidar.range_min) & (ranges < far)
    # Beyond the range there may be anything, and glass or black things return nothing: believe a half of it.
    none = np.isposinf(ranges) | (ranges >= far)
    # A lone beam without a return is a dropout, which would draw free space through walls.
    used = met | (none & np.roll(none, 1) & np.roll(none, -1))
    length = np.where(met, ranges, 0.5 * far)[used].astype(np.float64)
    angles = lidar.angles[used] + lidar.mount.yaw
    share = (np.arange(len(ranges)) / max(1, len(ranges) - 1))[used]
    x, y, yaw = (
        first + share * ((math.remainder(last - first, 2.0 * math.pi)) if k == 2 else last - first)
        for k, (first, last) in enumerate(zip(poses[0].tolist(), poses[1].tolist(), strict=True))
    )
    cos, sin = np.cos(yaw), np.sin(yaw)
    sx = x + cos * lidar.mount.x - sin * lidar.mount.y
    sy = y + sin * lidar.mount.x + cos * lidar.mount.y
    sensors = np.column_stack((sx, sy))
    points = np.column_stack((sx + length * np.cos(angles + yaw), sy + length * np.sin(angles + yaw)))
    return Beams((sensors, points, met[used].astype(np.uint8)))


class Canvas:
    """Counts of beams per cell, which grow where beams go; what was counted can be taken away again.

    Args:
        resolution: Edge of a cell [m].
        widest_gap_m: Up to which width gaps of walls are closed [m].
    """

    def __init__(self, resolution: float, widest_gap_m: float) -> None:
        self.resolution, self.widest_gap_m = resolution, widest_gap_m
        self._corner = (0, 0)  # in tiles
        self._tile = max(1, round(_TILE_M / resolution))
        self._counts = np.zeros((0, 0, 4), dtype=np.int32)

    @property
    def is_empty(self) -> bool:
        """Whether nothing was counted."""
        return not self._counts.any()

    def count(self, beams: Beams, pose: FloatArray, sign: int) -> None:
        """Count beams seen from a pose (x, y, yaw), or take them away (-1)."""
        sensors, points, hits = beams
        if not len(points):
            return
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        turn = np.array(((cos, sin), (-sin, cos)))
        sensors, points = sensors @ turn + pose[:2], points @ turn + pose[:2]
        self.reach(
            np.minimum(sensors.min(axis=0), points.min(axis=0)), np.maximum(sensors.max(axis=0), points.max(axis=0))
        )
        size = self._tile * self.resolution
        corner = np.array((self._corner[0] * size, self._corner[1] * size))
        count_beams(
            self._counts, sensors, points, hits, corner, self.resolution, _SHORT_BY_CELLS * self.resolution, sign
        )

    def reach(self, low: FloatArray, high: FloatArray) -> None:
        """Make room for what lies between two corners [m].

        Raises:
            InputError: If the map would be too large.
        """
        size = self._tile * self.resolution
        rows, cols = (n // self._tile for n in self._counts.shape[:2])
        left, bottom = (math.floor((value - self.resolution) / size) for value in low.tolist())
        right, top = (math.floor((value + self.resolution) / size) + 1 for value in high.tolist())
        if rows:
            inside = left >= self._corner[0] and bottom >= self._corner[1]
            if inside and right <= self._corner[0] + cols and top <= self._corner[1] + rows:
                return
            left, bottom = min(left, self._corner[0]), min(bottom, self._corner[1])
            right, top = max(right, self._corner[0] + cols), max(top, self._corner[1] + rows)
        height, width = (top - bottom) * self._tile, (right - left) * self._tile
        if height * width > MAX_CELLS // 4:
            raise InputError(
                f"the map would be {width * self.resolution:.0f} x {height * self.resolution:.0f} m, "
                f"{height * width / 1e6:.0f} million cells; use a coarser resolution"
            )
        counts = np.zeros((height, width, 4), dtype=np.int32)
        if rows:
            row, col = (self._corner[1] - bottom) * self._tile, (self._corner[0] - left) * self._tile
            counts[row : row + self._counts.shape[0], col : col + self._counts.shape[1]] = self._counts
        self._counts, self._corner = counts, (left, bottom)

    def grid(self, places: FloatArray) -> OccupancyGrid:
        """Return the map.

        Free cells that do not hang together with one of the places are specks behind walls: they are not known. Specks
        of unknown cells amid free ones lie between beams: they are free.

        Args:
            places: Where the robot was (x, y) [m], shape (N, 2).
        """
        cells = draw_cells(self._counts, np.array((_LEAST_ENDS, _LEAST_SHARE, _LEAST_BEAMS)))
        self._leave_specks(cells, places)
        _fill_specks(cells, _SPECK_M2 / self.resolution**2 + 1e-9)
        for view in (cells, cells.T):
            _close_gaps(view, math.floor(self.widest_gap_m / self.resolution + 1e-9))
        seen = cells >= 0
        rows, cols = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
        size, pad = self._tile * self.resolution, max(1, round(_PADDING_M / self.resolution))
        x, y = self._corner[0] * size, self._corner[1] * size
        if len(rows):
            low, left = max(0, rows[0] - pad), max(0, cols[0] - pad)
            cells = cells[low : rows[-1] + 1 + pad, left : cols[-1] + 1 + pad]
            x, y = x + float(left) * self.resolution, y + float(low) * self.resolution
        return OccupancyGrid(cells, self.resolution, Pose2D(x, y), surface="centre")

    def _leave_specks(self, cells: npt.NDArray[np.int8], places: FloatArray) -> None:
        """Make free cells unknown from which no place can be reached over free cells."""
        free = (cells >= 0) & (cells <= FREE_UP_TO)
        labels, parts = label_components(free.view(np.uint8), diagonal=False)
        corner = np.array(self._corner) * (self._tile * self.resolution)
        at = np.floor((places - corner) / self.resolution).astype(np.int64)
        kept = np.zeros(len(parts) + 1, dtype=bool)
        for row in (-1, 0, 1):  # a robot may stand where something was seen later
            for col in (-1, 0, 1):
                rows = np.clip(at[:, 1] + row, 0, cells.shape[0] - 1)
                kept[labels[rows, np.clip(at[:, 0] + col, 0, cells.shape[1] - 1)]] = True
        kept[0] = False
        cells[free & ~kept[labels]] = UNKNOWN


def _fill_specks(cells: npt.NDArray[np.int8], most: float) -> None:
    """Make unknown areas of up to `most` cells free that border on free cells alone."""
    unknown = cells < 0
    labels, parts = label_components(unknown.view(np.uint8), diagonal=True)
    filled = np.concatenate(((False,), parts[:, 0] <= most))
    taken = np.pad(cells > FREE_UP_TO, 1, constant_values=True)
    for row in range(3):
        for col in range(3):
            beside = taken[row : row + cells.shape[0], col : col + cells.shape[1]]
            filled[labels[beside & unknown]] = False
    filled[0] = False
    cells[filled[labels]] = 0


def _close_gaps(cells: npt.NDArray[np.int8], widest: int) -> None:
    """Draw what is missing of walls along the rows: free cells between two walls that border on unknown ones."""
    wall, unknown = cells >= _WALL, cells < 0
    behind = np.zeros_like(wall)
    for here, there in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
        behind[:] = False
        behind[here] = unknown[there]
        open_cells = behind & ~wall & ~unknown
        for width in range(1, widest + 1):
            if cells.shape[1] <= width + 1:
                break
            last = cells.shape[1] - width - 1
            gap = wall[:, :last] & wall[:, width + 1 :]
            for step in range(1, width + 1):
                gap &= open_cells[:, step : step + last]
            for step in range(1, width + 1):
                cells[:, step : step + last][gap] = _WALL


_MOVED_M, _MOVED_RAD = 0.01, 0.001  # a node that moves by less has not moved
_BLANK_CELLS = 20  # edge of the unknown map around a robot that has not seen anything


class LiveMap:
    """A canvas, and which scans were drawn on it from where.

    Args:
        resolution: Edge of a cell [m].
        robot: The robot; gaps of a wall that it fits through are not closed.
    """

    def __init__(self, resolution: float, robot: Robot) -> None:
        self.resolution = check_number("the map's resolution", resolution, *RESOLUTIONS_M, "m")
        self._canvas = Canvas(self.resolution, widest_gap_m(robot))
        self._drawn: dict[int, tuple[FloatArray, int]] = {}  # by node: from which pose, and how many of its scans

    def draw(self, nodes: Nodes, start: Pose2D) -> OccupancyGrid:
        """Return the map of what hangs together with the newest node; a square around the start where that is nothing.

        Args:
            nodes: The graph.
            start: Where the robot began, map frame.
        """
        roots = component_of(len(nodes), nodes.edges)
        for node in range(len(nodes)):
            scans, pose = nodes.scans_of(node), nodes.poses[node]
            old = self._drawn.get(node)
            wanted = roots[node] == roots[-1]
            if old is not None and wanted and not _has_moved(old[0], pose):
                self._count(nodes, scans[old[1] :], old[0], 1)
                self._drawn[node] = (old[0], len(scans))
                continue
            if old is not None:
                self._count(nodes, scans[: old[1]], old[0], -1)
                del self._drawn[node]
            if wanted:
                self._count(nodes, scans, pose, 1)
                self._drawn[node] = (pose.copy(), len(scans))
        if self._canvas.is_empty:
            row, col = (round(value / self.resolution) - _BLANK_CELLS // 2 for value in (start.y, start.x))
            cells = np.full((_BLANK_CELLS, _BLANK_CELLS), UNKNOWN, dtype=np.int8)
            origin = Pose2D(col * self.resolution, row * self.resolution)
            return OccupancyGrid(cells, self.resolution, origin, surface="centre")
        drawn = [nodes.poses[node][:2] for node in self._drawn]
        return self._canvas.grid(np.array(drawn).reshape(-1, 2))

    def _count(self, nodes: Nodes, scans: list, pose: FloatArray, sign: int) -> None:
        for scan in scans:
            self._canvas.count(place_beams(scan.ranges, nodes.lidars[scan.lidar], scan.poses), pose, sign)


def _has_moved(old: FloatArray, new: FloatArray) -> bool:
    moved = abs(old[0] - new[0]) > _MOVED_M or abs(old[1] - new[1]) > _MOVED_M
    return bool(moved or abs(wrap_angle(float(old[2] - new[2]))) > _MOVED_RAD)
