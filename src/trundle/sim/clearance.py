"""Clearance between a robot's footprint and a world's solids: exact distances, for all poses of a run."""

from __future__ import annotations

import math

import numpy as np

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Mesh, OccupancyCells, Solid, solids_bounds
from trundle.maps import OccupancyGrid
from trundle.maps.rasterise import HeightBand, SolidRaster
from trundle.robots import Robot
from trundle.sim.sections import Disc, Polygon, cut_triangles, slab_section
from trundle.worlds import World

_MOST_CELLS = 60_000_000
"""Limit on the cells of a world's map; cells are enlarged to stay within it."""

_POINT_M = 1e-4
"""Size of a cell that represents a point [m]."""

_LETHAL = 254


def map_world(world: World, robot: Robot, points: FloatArray, *, resolution: float, margin: float) -> Costmap:
    """Return the true map of a world for a robot: its solids between the robot's clearance and its height, inflated.

    Args:
        world: The world.
        robot: The robot, for its heights and footprint.
        points: What the map must reach [m], beside the world, shape (N, 2).
        resolution: Edge of a cell [m]; larger where there would be more than 60 million.
        margin: Added on all sides [m].
    """
    edge, corner, shape = map_extent(world, points, resolution=resolution, margin=margin)
    cells = np.zeros(shape, dtype=np.int8)
    band = HeightBand(robot.body.clearance, robot.body.height)
    SolidRaster(cells, edge, corner, band).add(world.solids)
    return Costmap.from_grid(OccupancyGrid(cells, edge, Pose2D(*corner)), robot)


def map_extent(
    world: World,
    points: FloatArray,
    *,
    resolution: float,
    margin: float,
    bounds: tuple[FloatArray, FloatArray] | None = None,
) -> tuple[float, tuple[float, float], tuple[int, int]]:
    """Return the edge of a cell [m], the corner (x, y) [m] and the shape of the map that `map_world` makes.

    `bounds` are those of each solid, where they are known.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    if world.solids:
        lows, highs = solids_bounds(world.solids) if bounds is None else bounds
        first, last = lows[:, :2].min(axis=0), highs[:, :2].max(axis=0)
        low, high = np.minimum(low, first), np.maximum(high, last)
    size = high - low + 2.0 * margin
    edge = max(resolution, math.sqrt(float(np.prod(size)) / _MOST_CELLS))
    corner = np.floor((low - margin) / edge) * edge
    cols, rows = (int(count) for count in np.ceil((high + margin - corner) / edge))
    return edge, (float(corner[0]), float(corner[1])), (rows, cols)


def least_clearance(
    world: World,
    robot: Robot,
    poses: FloatArray,
    coarse: FloatArray,
    *,
    resolution: float,
    cap: float,
    bounds: tuple[FloatArray, FloatArray] | None = None,
) -> float:
    """Smallest distance [m] from the oriented footprint, at any of the poses, to a solid within the robot's heights.

    Args:
        world: The world.
        robot: The robot, for its footprint and its heights from clearance to top.
        poses: (x, y, yaw) [m, m, rad], map frame, shape (N, 3).
        coarse: The same for each pose [m], shape (N,), measured on a map of `map_world` that reaches `cap` beyond the
            robot everywhere. It tells which poses and solids need a closer look: the map's cells hold every solid, and
            reach at most a cell's diagonal beyond. Of poses farther off than the nearest one by that, any such number
            will do.
        resolution: Edge of a cell of that map [m].
        cap: Larger distances are given as this one [m].
        bounds: Bounds (low, high) [m] of each solid, each of shape (N, 3), where they are known.

    Returns:
        0 where the footprint overlaps something.
    """
    beyond = math.sqrt(2.0) * resolution + 1e-6
    least = float(min(cap, coarse.min() + beyond))
    near = poses[coarse <= least]
    low, high = robot.body.clearance, robot.body.height
    flat: list[int] = []
    for index, solid in enumerate(world.solids):
        if isinstance(solid.shape, OccupancyCells):
            base = solid.pose.position[2]
            if base < high and base + solid.shape.height > low:
                least = min(least, _cells_clearance(solid, solid.shape, robot, near, cap))
        else:
            flat.append(index)
    if not flat or len(near) == 0:
        return least
    lows, highs = (corners[flat] for corners in (solids_bounds(world.solids) if bounds is None else bounds))
    around = robot.circumscribed_radius + least
    within = (lows[:, :2] < near[:, :2].max(axis=0) + around) & (highs[:, :2] > near[:, :2].min(axis=0) - around)
    level = np.flatnonzero((lows[:, 2] < high) & (highs[:, 2] > low) & within.all(axis=1))
    if len(level) == 0:
        return least
    # Lower bounds from each outline to each solid, by their boxes: pairs that are farther apart are skipped.
    outlines = robot.planar.at_poses(near)
    first, last = outlines.min(axis=1), outlines.max(axis=1)
    gaps = np.maximum(np.maximum(lows[level, None, :2] - last, first - highs[level, None, :2]), 0.0)
    reach = np.hypot(gaps[..., 0], gaps[..., 1])
    for index in np.argsort(reach.min(axis=1), kind="stable"):
        close = reach[index] < least
        if not close.any():
            break
        solid = world.solids[flat[int(level[index])]]
        least = min(least, _solid_clearance(solid, outlines[close], low, high, least))
    return least


def _solid_clearance(solid: Solid, outlines: FloatArray, low: float, high: float, cap: float) -> float:
    """Return the distance from outlines (P, N, 2) to a solid between two heights; `cap` or more if none is nearer."""
    if not isinstance(solid.shape, Mesh):
        match slab_section(solid, low, high):
            case Disc() as disc:
                return float(disc_distances(outlines, disc).min())
            case Polygon(corners):
                return float(polygon_distances(outlines, corners[None]).min())
            case None:
                return cap
    polygons = cut_triangles(solid.pose.transform_points(solid.shape.vertices)[solid.shape.faces], low, high)
    if _is_enclosed(solid, outlines, low, high):
        return 0.0
    first, last = outlines.min(axis=(0, 1)) - cap, outlines.max(axis=(0, 1)) + cap
    near = (polygons.min(axis=1) <= last).all(axis=1) & (polygons.max(axis=1) >= first).all(axis=1)
    return float(polygon_distances(outlines, polygons[near]).min()) if near.any() else cap


def _is_enclosed(solid: Solid, outlines: FloatArray, low: float, high: float) -> bool:
    """Return whether a corner of one of the outlines (P, N, 2) is inside a closed mesh, as maps fill it."""
    bottom, top = solid.bounds()
    for x, y in outlines[:, 0].tolist():
        if not (bottom[0] < x < top[0] and bottom[1] < y < top[1]):
            continue
        cell = np.zeros((1, 1), dtype=np.int8)
        corner = (x - _POINT_M / 2.0, y - _POINT_M / 2.0)
        SolidRaster(cell, _POINT_M, corner, HeightBand(low, high), centre=True).add([solid])
        if cell[0, 0] != 0:
            return True
    return False


def _cells_clearance(solid: Solid, cells: OccupancyCells, robot: Robot, poses: FloatArray, cap: float) -> float:
    x, y, _ = solid.pose.position
    frame = Pose2D(x, y, solid.pose.yaw())
    local = frame.inverse()
    placed = np.c_[local.transform_points(poses[:, :2]), poses[:, 2] + local.yaw]
    # Only the nearby cells, with a free rim: the edge of a map would count as blocked.
    reach = robot.circumscribed_radius + cap + cells.resolution
    first = np.floor((placed[:, :2].min(axis=0) - reach) / cells.resolution).astype(int)
    last = np.ceil((placed[:, :2].max(axis=0) + reach) / cells.resolution).astype(int)
    window = np.zeros((last - first)[::-1], dtype=np.uint8)
    inner_first, inner_last = np.maximum(first, 0), np.minimum(last, cells.blocked.shape[::-1])
    if (inner_first >= inner_last).any():
        return cap
    (col, row), (col_end, row_end) = inner_first, inner_last
    window[row - first[1] : row_end - first[1], col - first[0] : col_end - first[0]] = (
        _LETHAL * cells.blocked[row:row_end, col:col_end]
    )
    origin = first * cells.resolution
    distances = _core.footprint_clearance(
        window,
        cells.resolution,
        float(origin[0]),
        float(origin[1]),
        0.0,
        np.ascontiguousarray(robot.outline),
        np.ascontiguousarray(placed),
        cap,
    )
    return float(distances.min())


def polygon_distances(outlines: FloatArray, polygons: FloatArray) -> FloatArray:
    """Return distances [m] from convex outlines to the nearest of several convex polygons; 0 if they overlap.

    Args:
        outlines: Corners, counter-clockwise, shape (P, N, 2).
        polygons: Corners in either sense, also repeated or on one line, shape (Q, M, 2), Q ≥ 1.

    Returns:
        Shape (P,).
    """
    return _core.outline_distances(np.ascontiguousarray(outlines), np.ascontiguousarray(polygons))


def disc_distances(outlines: FloatArray, disc: Disc) -> FloatArray:
    """Return distances [m] from convex outlines, counter-clockwise, shape (P, N, 2), to a disc; 0 if they overlap."""
    centre = np.array([[[disc.x, disc.y]]])
    return np.maximum(polygon_distances(outlines, centre) - disc.radius, 0.0)
