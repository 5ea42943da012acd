"""Contacts of a footprint: convex outlines against the sections of solids, for many poses at once, and their names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

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


@dataclass(frozen=True, slots=True)
class CellField:
    """Blocked cells in the plane.

    Attributes:
        name: Of the solid; a cell of it is `name[row,col]`.
        frame: Pose of the corner of cell (0, 0) in the map frame.
        blocked: bool, shape (rows, cols).
        resolution: [m].
    """

    name: str
    frame: Pose2D
    blocked: npt.NDArray[np.bool_]
    resolution: float

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

    def find(self, poses: FloatArray) -> tuple[Contact, ...]:
        """Return the contacts at any of the poses (x, y, yaw), map frame, shape (P, 3), one per solid."""
        reach = self._footprint.circumscribed_radius
        x, y = poses[:, 0].tolist(), poses[:, 1].tolist()
        left, right, below, above = self._bounds
        near = (left < max(x) + reach) & (right > min(x) - reach) & (below < max(y) + reach) & (above > min(y) - reach)
        indices = near.nonzero()[0]
        if len(indices) == 0 and not self._fields:
            return ()
        outlines = self._footprint.at_poses(poses)
        contacts: list[Contact] = []
        touched: set[str] = set()
        for index in indices:
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
        for field in self._fields:
            contacts += self._touched_cells(field, poses)
        return tuple(contacts)

    def _touched_cells(self, field: CellField, poses: FloatArray) -> list[Contact]:
        """A contact for each blocked cell under the footprint, the deepest first."""
        local = field.frame.inverse()
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
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        squares: FloatArray = (cells[:, None, ::-1].astype(np.float64) + corners) * field.resolution
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
    """Penetration depth of a disc in outlines, shape (P, N, 2) → (P,) [m]; if negative, their distance."""
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
    """Mean of the corners of the overlap of an outline and a section: the reported contact point."""
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
    """The part of a polygon on the left of the line from `start` to `end` (Sutherland and Hodgman, 1974)."""
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
    """The blocked cell (row, col) nearest to a point [m] in the map frame, among its own cell and the neighbours."""
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
