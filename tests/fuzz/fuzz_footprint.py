"""Footprints at poses: touching and clearance as shapely tells them, for outlines and poses of every kind."""

from __future__ import annotations

import contextlib
import math
import random
from collections.abc import Sequence

import numpy as np
import shapely

from fuzz.loop import attempt, rng_of, spoil
from trundle._core import footprint_clearance, footprint_collides, footprint_sweep
from trundle.costmap import LETHAL, Costmap
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import PathCheck

CLOSE = 1e-6


def make_outline(generator: random.Random, sizes: Sequence[float] = (0.01, 0.3, 1.0, 4.0, 300.0)) -> FloatArray:
    """A convex outline around base_link: a box, or corners on an ellipse."""
    size = generator.choice(sizes)
    if generator.random() < 0.5:
        front, back, side = (size * generator.uniform(0.05, 1.0) for _ in range(3))
        return np.array([(front, side), (-back, side), (-back, -side), (front, -side)])
    angles = np.linspace(0.0, 2.0 * math.pi, generator.choice((3, 5, 16)), endpoint=False) + generator.uniform(0.0, 1.0)
    return size * np.column_stack([np.cos(angles), generator.uniform(0.1, 1.0) * np.sin(angles)])


def make_costmap(generator: random.Random) -> Costmap:
    rng = rng_of(generator)
    costs = rng.integers(0, 254, (generator.choice((1, 5, 20, 33)), generator.choice((1, 7, 16, 40)))).astype(np.uint8)
    costs[rng.random(costs.shape) < generator.choice((0.0, 0.01, 0.1))] = generator.choice((254, 255))
    origin = Pose2D(
        generator.uniform(-5, 5), generator.uniform(-5, 5), generator.choice((0.0, generator.uniform(-6, 6)))
    )
    return Costmap(costs, generator.choice((0.02, 0.1, 1.0)), origin, make_outline(generator), 1.0)


def placed(costmap: Costmap, pose: FloatArray) -> shapely.Polygon:
    """The footprint at a pose, in grid units."""
    in_map = Pose2D(*pose[:2].tolist(), wrap_angle(float(pose[2]))).transform_points(costmap.footprint)
    return shapely.Polygon(costmap.origin.inverse().transform_points(in_map) / costmap.resolution)


def check_path(generator: random.Random) -> None:
    """A path on a map that changes: the check finds the first pose that the footprint does not get to."""
    rng = rng_of(generator)
    shape = generator.choice((30, 60, 80)), generator.choice((33, 60))
    data = np.where(rng.random(shape) < generator.choice((0.0, 0.002, 0.02)), 100, 0).astype(np.int8)
    data[rng.random(shape) < generator.choice((0.0, 0.001))] = -1
    origin = Pose2D(*rng.uniform(-5, 5, 2).tolist(), generator.choice((0.0, generator.uniform(-6, 6))))
    outline = make_outline(generator, (0.01, 0.3, 1.0, 4.0))
    options = generator.choice((0.0, 0.5, None)), generator.choice((0.0, 1.0, 3.0, 30.0))
    costmap = Costmap.from_grid(OccupancyGrid(data, generator.choice((0.05, 0.1)), origin), outline, *options)
    size = np.array(shape[::-1]) * costmap.resolution
    places = origin.transform_points(rng.uniform(-0.1, 1.1, (generator.choice((1, 2, 5)), 2)) * size)
    check = PathCheck(Path(np.column_stack([places, rng.uniform(-7, 7, len(places))])))
    for _ in range(3):
        begin = generator.randrange(len(check.poses))
        touching = np.flatnonzero(costmap.footprint_collides(check.poses[begin:]))
        hit = check.first_hit(costmap, begin)
        index = None if hit is None else hit.index
        if index != (begin + int(touching[0]) if len(touching) else None):
            # Something is touched between two poses that are free.
            assert index is not None
            assert begin < index < (begin + int(touching[0]) if len(touching) else math.inf)
            between = np.linspace(check.poses[index - 1], check.poses[index], 2001)
            assert costmap.footprint_collides(between, outline=costmap.footprint * 1.001).any()
        row, col = generator.randrange(shape[0]), generator.randrange(shape[1])
        rectangle = slice(row, row + 1 + (shape[0] - row) // 5), slice(col, col + 1 + (shape[1] - col) // 5)
        costmap = costmap.update(*rectangle, generator.choice((100, 100, 0, -1)))


def check_sweeps(generator: random.Random) -> None:
    """Free motions touch nothing all along, and blocked ones touch something, to within 0.02 mm."""
    costmap, rng = make_costmap(generator), rng_of(generator)
    rows, cols = costmap.shape
    x, y = costmap.cell_to_world(rng.uniform(-1, rows + 1, 4), rng.uniform(-1, cols + 1, 4))
    first = np.column_stack([x, y, rng.uniform(-7, 7, 4)])
    change = rng.uniform(-1, 1, (4, 3)) * rng.choice([0.0, 0.1, 1.0], (4, 3)) * (1.0, 1.0, 4.0)
    for pose, moved, share in zip(first, change, costmap.footprint_sweeps(first, first + change).tolist(), strict=True):
        if share > 0.0:
            free = pose + min(share, 1.0) * np.linspace(0.0, 1.0, 301)[:, None] * moved
            assert not costmap.footprint_collides(free, outline=costmap.footprint * (1.0 - 1e-8)).any()
        if share < math.inf:
            ahead = pose + np.linspace(share, min(1.0, share + 1e-4), 101)[:, None] * moved
            wider = costmap.footprint * (1.0 + 3e-5 / costmap.inscribed_radius)
            assert costmap.footprint_collides(ahead, outline=wider).any()


def check_poses(generator: random.Random) -> None:
    costmap, rng = make_costmap(generator), rng_of(generator)
    rows, cols = costmap.shape
    x, y = costmap.cell_to_world(rng.uniform(-1, rows + 1, 6), rng.uniform(-1, cols + 1, 6))
    poses = np.column_stack([x, y, rng.uniform(-7, 7, 6)])
    poses[rng.random(6) < 0.2, 2] = costmap.origin.yaw + generator.choice((0.0, math.pi / 2))
    cap = generator.choice((0.01, 0.5, 30.0))
    if generator.random() < 0.3:
        frame = (costmap.data, costmap.resolution, *costmap.origin.as_tuple(), costmap.footprint, poses)
        attempt(footprint_collides, spoil(generator, frame))
        attempt(footprint_clearance, spoil(generator, (*frame, cap)))
        attempt(footprint_sweep, spoil(generator, (*frame, poses[::-1].copy())))
        spoiled = spoil(generator, (poses, costmap.footprint))
        with contextlib.suppress(InputError):
            costmap.footprint_collides(spoiled[0], outline=spoiled[1])
        return
    hits, clearances = costmap.footprint_collides(poses), costmap.clearance(poses, cap)
    blocked_rows, blocked_cols = np.nonzero(costmap.data >= LETHAL)
    boxes = shapely.box(blocked_cols, blocked_rows, blocked_cols + 1, blocked_rows + 1)
    area, tree = shapely.box(0, 0, cols, rows), shapely.STRtree(boxes)
    for pose, hit, clearance in zip(poses, hits.tolist(), clearances.tolist(), strict=True):
        polygon = placed(costmap, pose)
        close = CLOSE * max(1.0, costmap.circumscribed_radius / costmap.resolution * 1e-3)
        grown, shrunk = polygon.buffer(close), polygon.buffer(-close)
        touches = [len(tree.query(shape, "intersects")) > 0 or not area.contains(shape) for shape in (shrunk, grown)]
        if touches[0] != touches[1] or shrunk.is_empty:
            continue
        assert hit == touches[0]
        to_edge = shapely.boundary(area).distance(polygon)
        distance = min([to_edge, *shapely.distance(boxes, polygon).tolist()]) * costmap.resolution
        assert math.isclose(clearance, 0.0 if hit else min(cap, distance), rel_tol=1e-7, abs_tol=1e-7)


def one_round(generator: random.Random) -> None:
    generator.choice((check_path, check_sweeps, check_poses, check_poses))(generator)
