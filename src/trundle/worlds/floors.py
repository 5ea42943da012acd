"""Finding the floor that a robot is on, in worlds whose floor is not at z = 0.

A floor is level, faces up, lies under the whole footprint and has the robot's height free above it. A world whose file
declares a ground plane has one there, and none below; any other has one at z = 0, unless a surface lies below that. The
lowest of several floors is taken. A level above it may be another storey, a roof or a table. It counts as another
floor if it is large (`LARGE`) and either lies within `STOREY` of the lower one or has something on it; then the choice
is ambiguous and the user must give the floor.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose2D, Pose3D
from trundle.geometry.solids import OccupancyCells, Solid, solids_bounds
from trundle.robots import Robot
from trundle.worlds.shapes import LARGE
from trundle.worlds.tessellate import box_mesh, solid_triangles
from trundle.worlds.world_like import WorldLike, WorldT

STOREY = 2.0
"""A level at least this far [m] above a floor is a roof, unless something is on it."""

_LEVEL = math.cos(math.radians(1.0))
_SAME = 0.005
"""Tiles whose heights differ by up to this [m] are one floor."""

_SPACING = 0.05  # between the points of a footprint that are looked at [m]: the edge of a usual map's cell
_PROBES = 9  # places along each side of a world that are looked at
_EDGE = 1e-6  # [m²]: a point this little beside a triangle's edge is on it, so that none falls between two triangles

FLOOR_TOP = 1e-3
"""Anything that ends within this height [m] of the ground belongs to the ground and is not an obstacle."""


@dataclass(frozen=True, slots=True)
class _Column:
    """Surfaces above and below one point: heights [m] and directions where its vertical line crosses them.

    Attributes:
        heights: shape (N,), ascending.
        rising: Third component of the unit normals, shape (N,).
        owners: Index of the solid that each belongs to, shape (N,).
    """

    heights: FloatArray
    rising: FloatArray
    owners: npt.NDArray[np.int64]

    def is_free(self, low: float, height: float) -> bool:
        """Return whether the space between a floor and a height above it is free."""
        between = (self.heights > low + _SAME) & (self.heights < low + height)
        if between.any():
            return False
        for owner in set(self.owners.tolist()):
            own = self.owners == owner
            above = np.flatnonzero(own & (self.heights >= low + height))
            below = np.flatnonzero(own & (self.heights <= low + _SAME))
            # Inside a closed body: its surface enters it below and leaves it above.
            if len(above) and len(below) and self.rising[above[0]] > 0.0 and self.rising[below[-1]] < 0.0:
                return False
        return True


class _Surfaces:
    """The surfaces of a world's solids as triangles, computed once per solid."""

    def __init__(self, world: WorldLike) -> None:
        self.solids = world.solids
        self.ground = world.ground_z
        self.lows, self.highs = solids_bounds(world.solids)
        self._made: dict[int, FloatArray] = {}

    def triangles(self, index: int, low: FloatArray, high: FloatArray) -> FloatArray:
        """Return triangles [m] of one solid that overlap a rectangle (x, y), map frame, shape (N, 3, 3)."""
        solid = self.solids[index]
        if isinstance(solid.shape, OccupancyCells):
            return _cell_triangles(solid.pose, solid.shape, low, high)
        if index not in self._made:
            self._made[index] = solid_triangles(solid)
        corners = self._made[index]
        flat = corners[:, :, :2]
        return corners[((flat.min(axis=1) <= high) & (flat.max(axis=1) >= low)).all(axis=1)]

    def columns(self, points: FloatArray) -> list[_Column]:
        """Return surfaces above and below each point (x, y)."""
        low, high = points.min(axis=0), points.max(axis=0)
        near = ((self.lows[:, :2] <= high) & (self.highs[:, :2] >= low)).all(axis=1)
        found = {index: self.triangles(index, low, high) for index in np.flatnonzero(near).tolist()}
        corners = np.concatenate([np.empty((0, 3, 3)), *found.values()])
        owner = np.repeat(np.array(list(found), dtype=np.int64), [len(part) for part in found.values()])
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(normals, axis=1)
        upright = np.abs(normals[:, 2]) > 1e-9 * np.maximum(lengths, 1e-30)
        corners, owner, normals = corners[upright], owner[upright], normals[upright]
        rising = normals[:, 2] / lengths[upright]
        return [_column(point, corners, normals, rising, owner) for point in points]


def find_floor(world: WorldLike, robot: Robot, start: Pose2D) -> float:
    """Return the height [m] of the floor under a robot at a pose, in the world's own coordinates.

    If no floor has the robot's height free above its whole footprint, the one with the largest free part is taken:
    the start is blocked, and the contact names the obstacle.

    Raises:
        WorldError: If the floor is ambiguous: the robot could be on one of several.
    """
    surfaces = _Surfaces(world)
    levels = _levels_under(surfaces, robot, _footprint_points(robot, start))
    if len(levels) > 1:
        others = [level for level in levels[1:] if _is_floor_too(surfaces, levels[0], level)]
        if others:
            heights = ", ".join(f"{level:.3f}" for level in (levels[0], *others))
            raise WorldError(
                f"the robot at ({start.x:.2f}, {start.y:.2f}) could be on a floor at z = {heights} m of world "
                f"{world.name!r}; choose one with --floor-z (floor_z in Python and in a scenario)"
            )
    return levels[0]


def find_common_floor(world: WorldLike, robot: Robot) -> float:
    """Return the height [m] of the floor under most of a world, for when the robot's start is unknown.

    The lowest floor is sampled at 9 x 9 points over the world, and the most frequent height is taken. A floor other
    than the ground must be large and have something on it, unlike the top of a crate or a container.
    """
    ground = world.ground_z or 0.0
    if not world.solids:
        return ground
    (x_low, y_low, _), (x_high, y_high, _) = (corner.tolist() for corner in world.bounds)
    steps = (np.arange(_PROBES) + 0.5) / _PROBES
    surfaces = _Surfaces(world)
    found: Counter[float] = Counter()
    for x in (x_low + steps * (x_high - x_low)).tolist():
        for y in (y_low + steps * (y_high - y_low)).tolist():
            points = robot.outline + np.array([x, y])
            levels = _levels_under(surfaces, robot, np.vstack([points, [[x, y]]]), blocked=False)
            if levels:
                found[round(levels[0], 4)] += 1
    for level in sorted(found, key=lambda level: (-found[level], level)):
        if level == round(ground, 4):
            return ground
        if _carries(surfaces, level):
            return level
    return ground


def _levels_under(surfaces: _Surfaces, robot: Robot, points: FloatArray, *, blocked: bool = True) -> list[float]:
    """Return floors under all the points with the robot's height free above, lowest first.

    If there is none and `blocked` is set, the one with the largest free part; the highest of equal ones.
    """
    columns = surfaces.columns(points)
    levels = _shared_levels(columns)
    ground = surfaces.ground
    if ground is not None:
        levels = [max(level, ground) for level in levels if level >= ground - _SAME]
    base = ground or 0.0
    if not levels or levels[0] > base + _SAME:
        levels = [base, *levels]
    levels = [base if abs(level - base) < FLOOR_TOP else level for level in levels]
    if blocked:
        # A shelf around the start has a free top, which is not a floor.
        near = levels[0] + robot.z_range[0]
        levels = [level for level in levels if level <= near or _is_floor_too(surfaces, levels[0], level)]
    counts = [sum(column.is_free(level, robot.body.height) for column in columns) for level in levels]
    free = [level for level, count in zip(levels, counts, strict=True) if count == len(columns)]
    if free or not blocked:
        return free
    return [max(zip(counts, levels, strict=True))[1]]


def _shared_levels(columns: Sequence[_Column]) -> list[float]:
    """Return heights where all points have a level surface that faces up; of each floor, that of its highest tile."""
    tops = [column.heights[column.rising >= _LEVEL] for column in columns]
    levels: list[float] = []
    for height in np.unique(np.round(tops[0], 6)):
        nearest = [top[np.abs(top - height) <= _SAME] for top in tops]
        if all(len(near) for near in nearest):
            level = max(float(near.max()) for near in nearest)
            if not levels or level - levels[-1] > _SAME:
                levels.append(level)
    return levels


def _column(
    point: FloatArray, corners: FloatArray, normals: FloatArray, rising: FloatArray, owner: npt.NDArray[np.int64]
) -> _Column:
    """Intersect the vertical line through a point with triangles."""
    edges = np.roll(corners, -1, axis=1)[:, :, :2] - corners[:, :, :2]
    to = point - corners[:, :, :2]
    side = (edges[:, :, 0] * to[:, :, 1] - edges[:, :, 1] * to[:, :, 0]) * np.sign(rising)[:, None]
    hit = np.flatnonzero((side >= -_EDGE).all(axis=1))
    offset = point - corners[hit, 0, :2]
    heights = corners[hit, 0, 2] - (normals[hit, :2] * offset).sum(axis=1) / normals[hit, 2]
    order = np.argsort(heights, kind="stable")
    return _Column(heights[order], rising[hit][order], owner[hit][order])


def _cell_triangles(pose: Pose3D, cells: OccupancyCells, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the blocked cells near some points, each a box."""
    middle = pose.inverse().transform_points([[*((low + high) / 2.0), pose.position[2]]])[0]
    reach = float(np.hypot(*(high - low))) / 2.0 + cells.resolution
    rows, cols = cells.blocked.shape
    col, row = (
        np.clip(np.floor((middle[axis] + np.array([-reach, reach])) / cells.resolution), 0, most).astype(int)
        for axis, most in ((0, cols), (1, rows))
    )
    found = np.argwhere(cells.blocked[row[0] : row[1] + 1, col[0] : col[1] + 1]) + np.array([row[0], col[0]])
    box = box_mesh((cells.resolution, cells.resolution, cells.height))
    centers = np.c_[(found[:, ::-1] + 0.5) * cells.resolution, np.full(len(found), cells.height / 2.0)]
    points = (centers[:, None] + box.vertices).reshape(-1, 3)
    return pose.transform_points(points).reshape(len(found), -1, 3)[:, box.faces].reshape(-1, 3, 3)


def _footprint_points(robot: Robot, start: Pose2D) -> FloatArray:
    """Return points of the footprint at a pose, map frame: its corners and a grid within it."""
    outline = robot.outline
    low, high = outline.min(axis=0), outline.max(axis=0)
    axes = [np.linspace(low[i], high[i], max(2, math.ceil((high[i] - low[i]) / _SPACING) + 1)) for i in (0, 1)]
    grid = np.array(np.meshgrid(*axes)).reshape(2, -1).T
    edges = np.roll(outline, -1, axis=0) - outline
    to = grid[:, None] - outline
    inside = (edges[:, 0] * to[:, :, 1] - edges[:, 1] * to[:, :, 0] >= 0.0).all(axis=1)
    return start.transform_points(np.vstack([outline, grid[inside]]))


def _is_floor_too(surfaces: _Surfaces, floor: float, level: float) -> bool:
    """Return whether a level above a floor could be the robot's floor as well."""
    carries = _carries(surfaces, level)
    return carries is not None and (carries or level - floor < STOREY)


def _carries(surfaces: _Surfaces, level: float) -> bool | None:
    """Return whether something is on a level; None if the level is not large."""
    lows, highs = surfaces.lows, surfaces.highs
    reaching = np.flatnonzero((lows[:, 2] <= level + _SAME) & (highs[:, 2] >= level - _SAME)).tolist()
    everything = [surfaces.triangles(index, lows[index, :2], highs[index, :2]) for index in reaching]
    corners = np.concatenate(everything)
    corners = corners[(np.abs(corners[:, :, 2] - level) <= _SAME).all(axis=1)]
    across = corners[:, 1:, :2] - corners[:, :1, :2]
    turns = across[:, 0, 0] * across[:, 1, 1] - across[:, 0, 1] * across[:, 1, 0]
    if float(np.maximum(turns, 0.0).sum()) / 2.0 < LARGE:
        return None
    flat = corners[:, :, :2].reshape(-1, 2)
    over = ((lows[:, :2] < flat.max(axis=0)) & (highs[:, :2] > flat.min(axis=0))).all(axis=1)
    stands = over & (lows[:, 2] < level + STOREY) & (highs[:, 2] > level + 0.1)
    return bool(stands.any())


def lower_world(world: WorldT, floor_z: float) -> WorldT:
    """Move a world down so that its floor at a height [m] is at z = 0, where robots drive.

    Raises:
        WorldError: If the height is not a finite number, below the world's ground, or not within the world.
    """
    ground = world.ground_z
    if floor_z == 0.0 and ground in (None, 0.0):
        return world
    check_floor(world, floor_z)
    solids = world.solids if floor_z == 0.0 else tuple(lower_solid(solid, floor_z) for solid in world.solids)
    return replace(world, solids=solids, ground_z=None if ground is None else 0.0)


def check_floor(world: WorldLike, floor_z: float) -> None:
    """Refuse a floor height [m] with nothing on it, or below the ground plane.

    Raises:
        WorldError: If it is refused, or not a finite number.
    """
    if not math.isfinite(floor_z):
        raise WorldError(f"floor_z must be a height in metres, got {floor_z}")
    if world.ground_z is not None and floor_z < world.ground_z - _SAME:
        raise WorldError(
            f"floor_z is {floor_z:g} m, below the ground plane of world {world.name!r} at {world.ground_z:g} m; give "
            "at least that"
        )
    if not world.solids:
        return
    low, high = (float(corner[2]) for corner in world.bounds)
    if world.ground_z is not None:
        low, high = min(low, world.ground_z), max(high, world.ground_z)
    if not low - STOREY <= floor_z <= high + _SAME:
        raise WorldError(
            f"floor_z is {floor_z:g} m, and the solids of world {world.name!r} span heights {low:g} to {high:g} m: a "
            "floor there has nothing on it; give the height of the floor in metres, in the file's coordinates"
        )


def lower_solid(solid: Solid, by: float) -> Solid:
    """Move a solid down [m]."""
    x, y, z = solid.pose.position
    return replace(solid, pose=replace(solid.pose, position=(x, y, z - by)))
