"""`Lookup`: where robots are on their maps, how far their goals are, and what is around them, in a device's arrays."""

from __future__ import annotations

from typing import Any

from trundle.gym.arena import Arena
from trundle.gym.arrays import Arrays
from trundle.navigation.policies.policy import PATH_SPACING_M

POINT_SPACING = PATH_SPACING_M
"""Length of path from one observed point to the next [m]: along the axes of the map, up to √2 of it aslant."""

_MOST_POINTS = 2**20
"""Cells of local costmaps that are looked up at once: each needs some hundred bytes meanwhile."""


class Lookup:
    """Looks things up for N robots, each on its map and with its goal.

    Args:
        arena: The maps and missions.
        arrays: The functions and arrays of the device.
        count: Number of robots.
        threads: Number of threads that find paths.
    """

    def __init__(self, arena: Arena, arrays: Arrays, count: int, threads: int) -> None:
        self._arena, self._arrays, self._resolution, self._threads = arena, arrays, arena.resolution, threads
        self._map_frames, self._map_sizes = arrays.put(arena.frames), arrays.put(arena.shapes[:, ::-1])
        self._is_turned = bool((arena.frames[:, 3] != 0.0).any())
        self._map_starts = arrays.put(arena.map_starts)
        self._distances, self._field_starts = arrays.put(arena.distances_to_goals), arrays.put(arena.field_starts)
        self._ahead: dict[bool, Any] = {}
        self._costs: Any = None
        # Of each robot: (x, y, cos, sin) of its map, columns and rows of that, and where it and the goal's field begin.
        self._frames, self._sizes = arrays.full((count, 4), 0.0), arrays.full((count, 2), 0, "int64")
        self._cells, self._fields = arrays.full(count, 0, "int64"), arrays.full(count, 0, "int64")

    def settle(self, robots: Any, maps: Any, fields: Any) -> None:
        """Note the map of some robots, and the field of their goal."""
        self._frames[robots], self._sizes[robots] = self._map_frames[maps], self._map_sizes[maps]
        self._cells[robots], self._fields[robots] = self._map_starts[maps], self._field_starts[fields]

    def locate(self, poses: Any) -> tuple[Any, Any]:
        """Return the cell of each robot in its map, row after row, and whether it is on its map; 0 beyond it."""
        return self._cells_at(poses[:, :2], self._frames, self._sizes)

    def distance(self, cell: Any, inside: Any, otherwise: Any) -> Any:
        """Return the length of the shortest path from cells to the goal [m], or another in walls and beyond the map."""
        lib, found = self._arrays.lib, self._distances[self._fields + cell]
        return lib.where(inside & lib.isfinite(found), self._arrays.cast(found, "float64"), otherwise)

    def path(self, poses: Any, points: int, *, known: bool) -> list[tuple[Any, Any]]:
        """Return (x, y) of points of the path ahead, map frame [m], each of shape (N,).

        The path descends on the costs to go to the goal, which keeps it away from walls.

        Args:
            poses: Poses of the robots.
            points: How many points.
            known: Whether the path is on the maps that the robots have, which may lack something.
        """
        arena = self._arena
        known = known and arena.known is not arena.grids
        if known not in self._ahead:
            on = arena.known if known else arena.grids
            self._ahead[known] = self._arrays.put(arena.cells_ahead(POINT_SPACING, on, self._threads))
        ahead = self._ahead[known]
        lib, (x0, y0, cos, sin) = self._arrays.lib, self._frames.T
        cell, inside = self.locate(poses)
        cols = self._sizes[:, 0]
        found: list[tuple[Any, Any]] = []
        for _ in range(points):
            cell = self._arrays.cast(ahead[self._fields + cell], "int64")
            row = cell // cols
            along, up = ((cell - row * cols) + 0.5) * self._resolution, (row + 0.5) * self._resolution
            x, y = x0 + cos * along - sin * up, y0 + sin * along + cos * up
            found.append((lib.where(inside, x, poses[:, 0]), lib.where(inside, y, poses[:, 1])))
        return found

    def costs_around(self, poses: Any, offsets: Any) -> Any:
        """Return costs of the map at offsets (x, y) from each robot, base_link [m], shape (K, 2); beyond the map 255.

        Returns:
            Costs, uint8, shape (N, K).
        """
        if self._costs is None:
            self._costs = self._arrays.put(self._arena.costs())
        arrays, lib = self._arrays, self._arrays.lib
        out = arrays.full((len(poses), len(offsets)), 255, "uint8")
        cos, sin = lib.cos(poses[:, 2, None]), lib.sin(poses[:, 2, None])
        chunk = max(1, _MOST_POINTS // len(offsets))
        for first in range(0, len(poses), chunk):
            part = slice(first, first + chunk)
            points = arrays.full((*out[part].shape, 2), 0.0)
            points[..., 0] = poses[part, 0, None] + (cos[part] * offsets[:, 0] - sin[part] * offsets[:, 1])
            points[..., 1] = poses[part, 1, None] + (sin[part] * offsets[:, 0] + cos[part] * offsets[:, 1])
            cell, inside = self._cells_at(points, self._frames[part, None], self._sizes[part, None])
            out[part] = lib.where(inside, self._costs[cell + self._cells[part, None]], out[part])
        return out

    def _cells_at(self, points: Any, frames: Any, sizes: Any) -> tuple[Any, Any]:
        """Return the cells of points (x, y), shape (…, 2), row after row, and whether they are on the map; else 0."""
        local = points - frames[..., :2]
        if self._is_turned:  # else the cosines are 1 and the sines 0
            (dx, dy), (cos, sin) = (local[..., 0], local[..., 1]), (frames[..., 2], frames[..., 3])
            local[..., 0], local[..., 1] = cos * dx + sin * dy, cos * dy - sin * dx
        cells = self._arrays.cast(self._arrays.lib.floor(local / self._resolution), "int64")
        fits = (cells >= 0) & (cells < sizes)
        inside = fits[..., 0] & fits[..., 1]
        return self._arrays.lib.where(inside, cells[..., 1] * sizes[..., 0] + cells[..., 0], 0), inside
