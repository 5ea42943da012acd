"""`LiveMap`: the map of a graph while it grows: what is new or was corrected is drawn, the rest stays."""

from __future__ import annotations

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.mapping.drawing import RESOLUTIONS_M, Canvas, place_beams, widest_gap_m
from trundle.mapping.nodes import Nodes
from trundle.mapping.parts import component_of
from trundle.maps import OccupancyGrid
from trundle.maps.cells import UNKNOWN
from trundle.robots import Robot
from trundle.values import check_number

_MOVED_M, _MOVED_RAD = 0.01, 0.001
_BLANK_CELLS = 20


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
