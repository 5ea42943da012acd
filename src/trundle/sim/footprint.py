"""Contacts of a footprint: convex outlines against the sections of solids, for many poses at once, and their names."""

from __future__ import annotations

import dataclasses
import math
import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from trundle._core import chebyshev_field
from trundle.errors import WorldError
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.geometry.solids import OccupancyCells, Solid
from trundle.robots import Robot
from trundle.sim.convex import take_apart
from trundle.sim.sections import Disc, Polygon, piece_section, slab_section
from trundle.sim.state import Contact
from trundle.worlds import World

_TOUCH = 1e-9
"""Overlaps up to this depth [m] are rounding noise of adjacent shapes."""

_AROUND_M = 1.0
"""Sections this close to where the robot was are looked at until it has driven as far, ..."""

_FEW = 40
"""... unless there are more of them; NumPy is then faster with all sections."""

_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])

_Bytes = npt.NDArray[np.uint8]

_fields: dict[int, tuple[weakref.ref[npt.NDArray[np.bool_]], _Bytes]] = {}


def free_squares(blocked: npt.NDArray[np.bool_]) -> _Bytes:
    """Return the Chebyshev distance [cells] of each cell from the nearest blocked one, shape (rows, cols).

    It is computed once for an array, which must not change, and kept for as long as the array.
    """
    key = id(blocked)
    kept = _fields.get(key)
    if kept is None or kept[0]() is not blocked:
        kept = weakref.ref(blocked, lambda _: _fields.pop(key, None)), chebyshev_field(blocked.view(np.uint8))
        _fields[key] = kept
    return kept[1]


@dataclass(frozen=True, slots=True)
class CellField:
    """Blocked cells in the plane.

    Attributes:
        name: Name of the solid; a cell of it is `name[row,col]`.
        frame: Pose of the corner of cell (0, 0) in the map frame.
        inverse: Pose of the map frame in that frame.
        blocked: bool, shape (rows, cols).
        resolution: [m].
    """

    name: str
    frame: Pose2D
    blocked: npt.NDArray[np.bool_]
    resolution: float
    inverse: Pose2D = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "inverse", self.frame.inverse())

    @property
    def free(self) -> _Bytes:
        """How far [cells] each cell is from the nearest blocked one; see `free_squares`."""
        return free_squares(self.blocked)

    @classmethod
    def of(cls, solid: Solid, cells: OccupancyCells) -> CellField:
        """Create from the cells of a solid.

        Raises:
            WorldError: If they are not level.
        """
        if not solid.pose.is_upright():
            raise WorldError(f"blocked cells {solid.name!r} must be level; their pose is tilted")
        x, y, _ = solid.pose.position
        return cls(solid.name, Pose2D(x, y, solid.pose.yaw()), cells.blocked, cells.resolution)


class FootprintChecker:
    """Finds solids that overlap the robot's prism: its footprint from clearance to height.

    Args:
        world: The world.
        robot: The robot.
    """

    def __init__(self, world: World, robot: Robot) -> None:
        self._take(world.solids, robot.planar, robot.body.clearance, robot.body.height)

    @classmethod
    def of(cls, solids: Sequence[Solid], footprint: Footprint, low: float, high: float) -> Self:
        """Create for any footprint, from one height to another [m]."""
        checker = object.__new__(cls)
        checker._take(solids, footprint, low, high)
        return checker

    def _take(self, solids: Sequence[Solid], footprint: Footprint, low: float, high: float) -> None:
        self._footprint = footprint
        pieces = take_apart(solids, ceiling=high)
        self._names: list[str] = []
        self._sections: list[Polygon | Disc] = []
        self._fields: list[CellField] = []
        for solid in solids:
            if isinstance(solid.shape, OccupancyCells):
                base = solid.pose.position[2]
                if base < high and base + solid.shape.height > low:
                    self._fields.append(CellField.of(solid, solid.shape))
                continue
            if solid.name in pieces:
                found: list[Polygon | Disc | None] = [
                    piece_section(piece, low, high) for piece in pieces[solid.name].hulls
                ]
            else:
                found = [slab_section(solid, low, high)]
            for section in found:
                if section is not None:
                    self._names.append(solid.name)
                    self._sections.append(section)
        bounds = [_bounds(section) for section in self._sections]
        self._bounds: FloatArray = np.ascontiguousarray(np.array(bounds).reshape(-1, 4).T[[0, 2, 1, 3]])
        self._looked_at = self._clear = math.inf, -math.inf, math.inf, -math.inf
        self._around: list[tuple[int, float, float, float, float]] = []

    def find(self, poses: Sequence[tuple[float, float, float]] | FloatArray) -> tuple[Contact, ...]:
        """Return the contacts at any of the poses (x, y, yaw), map frame, shape (P, 3), one per solid."""
        array = np.asarray(poses, np.float64)
        x, y = array[:, 0], array[:, 1]
        return self.find_within((float(x.min()), float(x.max()), float(y.min()), float(y.max())), array)

    def find_within(self, bounds: tuple[float, float, float, float], poses: FloatArray) -> tuple[Contact, ...]:
        """Return the same where the least and the greatest x, and those of y, are known; more columns are ignored."""
        indices = self._near(*bounds)
        fields = [field for field in self._fields if not self._is_clear_of(field, bounds, poses)]
        if not indices and not fields:
            return ()
        return self._touched(np.ascontiguousarray(poses[:, :3]), indices, fields)

    def _near(self, left: float, right: float, below: float, above: float) -> list[int]:
        """Return sections whose bounds are within the footprint's reach of a box [m]."""
        reach = self._footprint.circumscribed_radius
        left, right, below, above = left - reach, right + reach, below - reach, above + reach
        west, east, south, north = self._clear
        if west <= left and right <= east and south <= below and above <= north:
            return []
        west, east, south, north = self._looked_at
        if not (west <= left and right <= east and south <= below and above <= north):
            west, east, south, north = left - _AROUND_M, right + _AROUND_M, below - _AROUND_M, above + _AROUND_M
            low_x, high_x, low_y, high_y = self._bounds
            around = (low_x < east) & (high_x > west) & (low_y < north) & (high_y > south)
            found = around.nonzero()[0]
            if len(found) > _FEW:
                near = (low_x < right) & (high_x > left) & (low_y < above) & (high_y > below)
                return near.nonzero()[0].tolist()
            self._looked_at = west, east, south, north
            self._around = [
                (int(i), *bounds) for i, bounds in zip(found, self._bounds[:, found].T.tolist(), strict=True)
            ]
        near, room = list[int](), math.inf
        for index, low_x, high_x, low_y, high_y in self._around:
            apart = max(low_x - right, left - high_x, low_y - above, below - high_y)
            if apart < 0.0:
                near.append(index)
            else:
                room = min(room, apart)
        if not near:
            self._clear = (
                max(west, left - room),
                min(east, right + room),
                max(south, below - room),
                min(north, above + room),
            )
        return near

    def _is_clear_of(self, field: CellField, bounds: tuple[float, float, float, float], poses: FloatArray) -> bool:
        """Return whether the free square around the last of some poses surely holds the footprint at all of them."""
        left, right, below, above = bounds
        local, edge = field.inverse, field.resolution
        cos, sin = math.cos(local.yaw), math.sin(local.yaw)
        at_x, at_y = poses[-1, :2].tolist()
        col = math.floor((local.x + cos * at_x - sin * at_y) / edge)
        row = math.floor((local.y + sin * at_x + cos * at_y) / edge)
        rows, cols = field.blocked.shape
        if not (0 <= row < rows and 0 <= col < cols):
            return False
        moved = math.hypot(max(right - at_x, at_x - left), max(above - at_y, at_y - below))
        # One cell less, as the robot may be anywhere in its own one, and one more for rounding.
        return (self._footprint.circumscribed_radius + moved) / edge < int(field.free[row, col]) - 2

    def _touched(self, poses: FloatArray, indices: list[int], fields: list[CellField]) -> tuple[Contact, ...]:
        outlines = self._footprint.at_poses(poses)
        contacts: list[Contact] = []
        touched: set[str] = set()
        (left, below), (right, above) = outlines.min(axis=(0, 1)).tolist(), outlines.max(axis=(0, 1)).tolist()
        low_x, high_x, low_y, high_y = self._bounds[:, indices]
        around = (low_x < right) & (high_x > left) & (low_y < above) & (high_y > below)
        for index in np.array(indices, np.intp)[around].tolist():
            if self._names[index] in touched:  # by another piece of the solid
                continue
            section = self._sections[index]
            if isinstance(section, Disc):
                depth = _disc_depth(outlines, section)
            else:
                depth = polygon_depth(outlines, section.corners[None])[:, 0]
            hits = np.flatnonzero(depth > _TOUCH)
            if len(hits):
                touched.add(self._names[index])
                x, y = _middle_of_overlap(outlines[hits[0]], section)
                contacts.append(Contact("chassis", self._names[index], x, y))
        for field in fields:
            contacts += self._touched_cells(field, poses)
        return tuple(contacts)

    def _touched_cells(self, field: CellField, poses: FloatArray) -> list[Contact]:
        """Return a contact for each blocked cell under the footprint, the deepest first."""
        local = field.inverse
        placed = np.c_[local.transform_points(poses[:, :2]), poses[:, 2] + local.yaw]
        outlines = self._footprint.at_poses(placed)
        rows, cols = field.blocked.shape
        low = np.floor(outlines.min(axis=(0, 1)) / field.resolution).astype(int)
        high = np.floor(outlines.max(axis=(0, 1)) / field.resolution).astype(int) + 1
        first_col, first_row = np.clip(low, 0, (cols, rows))
        last_col, last_row = np.clip(high, 0, (cols, rows))
        cells = np.argwhere(field.blocked[first_row:last_row, first_col:last_col])
        if len(cells) == 0:
            return []
        cells += np.array([first_row, first_col])
        squares: FloatArray = (cells[:, None, ::-1].astype(np.float64) + _SQUARE) * field.resolution
        depth = polygon_depth(outlines, squares).max(axis=0)
        deepest = np.argsort(-depth, kind="stable")
        touched = deepest[depth[deepest] > _TOUCH]
        middles = field.frame.transform_points(squares[touched].mean(axis=1))
        return [
            Contact("chassis", f"{field.name}[{row},{col}]", x, y)
            for (row, col), (x, y) in zip(cells[touched].tolist(), middles.tolist(), strict=True)
        ]


def polygon_depth(first: FloatArray, second: FloatArray) -> FloatArray:
    """Penetration depth of convex polygons [m], by the separating axis theorem; 0 or less if they do not overlap.

    Args:
        first: Corners, counter-clockwise, shape (P, N, 2).
        second: Corners, counter-clockwise, shape (Q, M, 2).

    Returns:
        Smallest overlap over the normals of both, shape (P, Q).
    """
    own = _overlap_along(first, second)
    other = _overlap_along(second, first).T
    return np.minimum(own, other)


def _overlap_along(polygons: FloatArray, others: FloatArray) -> FloatArray:
    edges = np.roll(polygons, -1, axis=1) - polygons
    normals = np.stack([edges[..., 1], -edges[..., 0]], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    reach = np.einsum("pnd,pnd->pn", normals, polygons)
    # The nearest point of each other polygon along each outward normal: (P, N, Q).
    nearest = np.einsum("pnd,qmd->pnqm", normals, others).min(axis=-1)
    return (reach[:, :, None] - nearest).min(axis=1)


def _disc_depth(outlines: FloatArray, disc: Disc) -> FloatArray:
    """Return the penetration depth of a disc in outlines, shape (P, N, 2) → (P,) [m]; if negative, their distance."""
    offset = np.array([disc.x, disc.y]) - outlines
    edges = np.roll(outlines, -1, axis=1) - outlines
    along = np.clip(np.einsum("pnd,pnd->pn", offset, edges) / np.einsum("pnd,pnd->pn", edges, edges), 0.0, 1.0)
    distance = np.linalg.norm(offset - along[..., None] * edges, axis=-1).min(axis=1)
    inside = (edges[..., 0] * offset[..., 1] - edges[..., 1] * offset[..., 0] > 0.0).all(axis=1)
    return np.where(inside, disc.radius + distance, disc.radius - distance)


def _bounds(section: Polygon | Disc) -> tuple[float, float, float, float]:
    if isinstance(section, Disc):
        radius = section.radius
        return section.x - radius, section.y - radius, section.x + radius, section.y + radius
    (left, bottom), (right, top) = section.corners.min(axis=0), section.corners.max(axis=0)
    return float(left), float(bottom), float(right), float(top)


def _middle_of_overlap(outline: FloatArray, section: Polygon | Disc) -> tuple[float, float]:
    """Return the mean of the corners of the overlap of an outline and a section: the reported contact point."""
    if isinstance(section, Disc):
        angles = np.arange(24) * (math.tau / 24)
        corners = np.c_[section.x + section.radius * np.cos(angles), section.y + section.radius * np.sin(angles)]
    else:
        corners = section.corners
    shared = outline
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        shared = _clip(shared, start, end)
        if len(shared) == 0:
            return float(corners[:, 0].mean()), float(corners[:, 1].mean())
    return float(shared[:, 0].mean()), float(shared[:, 1].mean())


def _clip(polygon: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the part of a polygon on the left of the line from `start` to `end` (Sutherland and Hodgman, 1974)."""
    edge = end - start
    side = edge[0] * (polygon[:, 1] - start[1]) - edge[1] * (polygon[:, 0] - start[0])
    kept: list[FloatArray] = []
    for index, point in enumerate(polygon):
        following, here, there = (index + 1) % len(polygon), side[index], side[(index + 1) % len(polygon)]
        if here >= 0.0:
            kept.append(point)
        if here * there < 0.0:
            kept.append(point + (here / (here - there)) * (polygon[following] - point))
    return np.array(kept).reshape(-1, 2)


class CellNames:
    """Names contacts with a world's blocked cells, alike for all simulators: `map[row,col]`.

    Args:
        world: Whose cells.
    """

    def __init__(self, world: World) -> None:
        self._cells = {
            solid.name: (solid, solid.shape) for solid in world.solids if isinstance(solid.shape, OccupancyCells)
        }

    def name(self, solid: str, x: float, y: float) -> str:
        """Return a solid's name, followed by the touched cell at (x, y) [m], map frame, if the solid has cells."""
        if solid not in self._cells:
            return solid
        row, col = nearest_blocked_cell(*self._cells[solid], x, y)
        return f"{solid}[{row},{col}]"


def nearest_blocked_cell(solid: Solid, cells: OccupancyCells, x: float, y: float) -> tuple[int, int]:
    """Return the blocked cell (row, col) nearest to a point [m], map frame, of its own cell and the neighbours."""
    origin = Pose2D(solid.pose.position[0], solid.pose.position[1], solid.pose.yaw())
    local = origin.inverse() @ Pose2D(x, y)
    along, across = local.x / cells.resolution, local.y / cells.resolution
    rows, cols = cells.blocked.shape
    row = min(max(math.floor(across), 0), rows - 1)
    col = min(max(math.floor(along), 0), cols - 1)
    low_row, low_col = max(row - 1, 0), max(col - 1, 0)
    near = np.argwhere(cells.blocked[low_row : row + 2, low_col : col + 2]) + np.array([low_row, low_col])
    if len(near) == 0:
        return row, col
    best = near[np.argmin(np.hypot(near[:, 0] + 0.5 - across, near[:, 1] + 0.5 - along))]
    return int(best[0]), int(best[1])
