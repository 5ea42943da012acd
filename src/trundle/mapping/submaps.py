"""`Submaps`: twelve key frames each, as surfaces that later scans are matched with."""

from __future__ import annotations

import heapq
import math
from collections import OrderedDict, defaultdict
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import SurfaceMap
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.nodes import Nodes
from trundle.mapping.pose_graph import LOOP
from trundle.mapping.window import CELL_M

KEY_FRAMES = 12  # of a submap: with one every 0.4 m it is 5 m long
_KEPT = 24  # surfaces in memory, up to 5 MB each
_LOOP_LENGTH_M = 0.5  # what a closed loop counts as


@dataclass(slots=True)
class Submap:
    """Key frames in a row.

    Attributes:
        first, last: Its nodes.
        part: Their part.
    """

    first: int
    last: int
    part: int

    @property
    def middle(self) -> int:
        """The node in whose frame it is."""
        return (self.first + self.last) // 2


@dataclass(frozen=True, slots=True)
class SubmapSurface:
    """What a submap saw, seen from its middle node: as surfaces, and as a table for the search."""

    surface: SurfaceMap
    table: npt.NDArray[np.uint8]
    corner: FloatArray
    resolution: float


class Submaps:
    """All submaps of a graph, and how far apart they are along its edges."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self.all: list[Submap] = []
        self.of_node: list[int] = []
        self._surfaces: OrderedDict[int, SubmapSurface] = OrderedDict()
        self._beside: dict[int, dict[int, float]] = defaultdict(dict)
        for node in range(len(nodes)):
            self.add(node)
        for a, b, kind in nodes.edges:
            if kind == LOOP:
                self.tie(a, b)

    def add(self, node: int) -> bool:
        """Add a new node; return whether it is the last one of its submap."""
        part = self._nodes.parts[node]
        last = self.all[-1] if self.all else None
        if last is None or last.part != part or last.last - last.first + 1 >= KEY_FRAMES:
            self.all.append(Submap(node, node, part))
            if last is not None and last.part == part:
                length = self._nodes.travelled[node] - self._nodes.travelled[last.first]
                index = len(self.all) - 1
                self._beside[index][index - 1] = self._beside[index - 1][index] = length
        else:
            last.last = node
        self.of_node.append(len(self.all) - 1)
        return self.all[-1].last - self.all[-1].first + 1 == KEY_FRAMES

    def remove_last(self) -> None:
        """Forget the newest node."""
        index = self.of_node.pop()
        self._surfaces.pop(index, None)
        if self.all[index].first == self.all[index].last:
            self.all.pop()
            for other in self._beside.pop(index, {}):
                self._beside[other].pop(index, None)
        else:
            self.all[index].last -= 1

    def tie(self, a: int, b: int) -> None:
        """Note that a loop joins two nodes."""
        first, second = self.of_node[a], self.of_node[b]
        if first != second:
            self._beside[first][second] = self._beside[second][first] = _LOOP_LENGTH_M

    def lengths_from(self, node: int) -> dict[int, float]:
        """Return how far it is along the graph from a node to each submap that it hangs together with [m]."""
        start = self.of_node[node]
        found: dict[int, float] = {}
        queue = [(0.0, start)]
        while queue:
            length, at = heapq.heappop(queue)
            if at in found:
                continue
            found[at] = length
            for other, step in self._beside[at].items():
                if other not in found:
                    heapq.heappush(queue, (length + step, other))
        return found

    def seen_from_middle(self, submap: Submap, node: int) -> Pose2D:
        """Return the pose of one of its nodes seen from the middle one."""
        return self._nodes.pose(submap.middle).inverse() @ self._nodes.pose(node)

    def surface(self, index: int) -> SubmapSurface:
        """Return what a submap saw."""
        found = self._surfaces.get(index)
        if found is not None:
            self._surfaces.move_to_end(index)
            return found
        submap = self.all[index]
        surface = SurfaceMap(CELL_M)
        for node in range(submap.first, submap.last + 1):
            one = self._nodes.key_surface(node)
            seen = self.seen_from_middle(submap, node)
            try:
                surface.add(one.points, one.normals, np.array(seen.as_tuple()), 1)
            except ValueError:
                raise InputError(
                    f"the poses {submap.middle} and {node} of the pose graph follow each other, and lie too far apart "
                    f"({math.hypot(seen.x, seen.y):.0f} m)"
                ) from None
        table, corner = surface.table(CELL_M)
        resolution = CELL_M
        if max(table.shape) > 400:
            resolution = 2.0 * CELL_M
            table, corner = surface.table(resolution)
        found = SubmapSurface(surface, table, corner, resolution)
        self._surfaces[index] = found
        if len(self._surfaces) > _KEPT:
            self._surfaces.popitem(last=False)
        return found
