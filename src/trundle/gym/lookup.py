"""`Lookup`: where robots are on their maps, how far their goals are, and what is around them, in a device's arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

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
    """

    def __init__(self, arena: Arena, arrays: Arrays, count: int) -> None:
        self._arena, self._arrays, self._resolution = arena, arrays, arena.resolution
        self._map_frames, self._map_shapes = arrays.put(arena.frames), arrays.put(arena.shapes)
        self._map_starts = arrays.put(arena.map_starts)
        self._distances, self._field_starts = arrays.put(arena.distances_to_goals), arrays.put(arena.field_starts)
        self._ahead: dict[bool, Any] = {}
        self._costs: Any = None
        # Of each robot: (x, y, cos, sin) of its map, that map's shape, and where that map and the goal's field begin.
        self._frames, self._shapes = arrays.full((count, 4), 0.0), arrays.full((count, 2), 0, "int64")
        self._cells, self._fields = arrays.full(count, 0, "int64"), arrays.full(count, 0, "int64")

    def settle(self, robots: Any, maps: Any, fields: Any) -> None:
        """Note the map of some robots, and the field of their goal."""
        self._frames[robots], self._shapes[robots] = self._map_frames[maps], self._map_shapes[maps]
        self._cells[robots], self._fields[robots] = self._map_starts[maps], self._field_starts[fields]

    def locate(self, poses: Any) -> tuple[Any, Any]:
        """Return the cell of each robot in its map, row after row, and whether it is on its map; 0 beyond it."""
        row, col = self._rows_and_columns(poses[:, 0], poses[:, 1], self._frames)
        rows, cols = self._shapes[:, 0], self._shapes[:, 1]
        inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
        return self._arrays.lib.where(inside, row * cols + col, 0), inside

    def distance(self, cell: Any, inside: Any) -> Any:
        """Return the length of the shortest path from cells to the goal [m]; infinite in walls and beyond the map."""
        found = self._arrays.cast(self._distances[self._fields + cell], "float64")
        return self._arrays.lib.where(inside, found, np.inf)

    def path(self, poses: Any, points: int, *, known: bool) -> list[tuple[Any, Any]]:
        """Return (x, y) of points of the path ahead, map frame [m], each of shape (N,).

        The path descends on the costs to go to the goal, which keeps it away from walls.

        Args:
            poses: Of the robots.
            points: How many points.
            known: Whether the path is on the maps that the robots have, which may lack something.
        """
        arena = self._arena
        known = known and arena.known is not arena.grids
        if known not in self._ahead:
            on = arena.known if known else arena.grids
            self._ahead[known] = self._arrays.put(arena.cells_ahead(POINT_SPACING, on))
        ahead = self._ahead[known]
        lib, (x0, y0, cos, sin) = self._arrays.lib, self._frames.T
        cell, inside = self.locate(poses)
        cols = self._shapes[:, 1]
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
            x = poses[part, 0, None] + (cos[part] * offsets[:, 0] - sin[part] * offsets[:, 1])
            y = poses[part, 1, None] + (sin[part] * offsets[:, 0] + cos[part] * offsets[:, 1])
            row, col = self._rows_and_columns(x, y, self._frames[part, None])
            rows, cols = self._shapes[part, None, 0], self._shapes[part, None, 1]
            inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
            at = lib.where(inside, row * cols + col, 0) + self._cells[part, None]
            out[part] = lib.where(inside, self._costs[at], out[part])
        return out

    def _rows_and_columns(self, x: Any, y: Any, frames: Any) -> tuple[Any, Any]:
        """Return (row, col) of points of the map frame; not clipped."""
        floor, cast = self._arrays.lib.floor, self._arrays.cast
        cos, sin = frames[..., 2], frames[..., 3]
        dx, dy = x - frames[..., 0], y - frames[..., 1]
        row, col = (cos * dy - sin * dx) / self._resolution, (cos * dx + sin * dy) / self._resolution
        return cast(floor(row), "int64"), cast(floor(col), "int64")
