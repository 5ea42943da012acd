"""Rays against cells, segments and discs: between what they meet when all is a little larger and a little smaller."""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.lone_hits_oracle import find_lone_hits as find_lone_hits_slowly
from support.moved_points_oracle import find_moved as find_moved_slowly
from support.near_points_oracle import outline_clearances as outline_clearances_slowly
from support.near_points_oracle import points_around as points_around_slowly
from support.placed_scan_oracle import place_scan as place_scan_slowly
from trundle._core import (
    cast_grid_rays,
    cast_jumping_rays,
    cast_outline_rays,
    chebyshev_field,
    find_lone_hits,
    find_moved,
    measure_ranges,
    outline_clearances,
    place_scan,
    points_around,
)
from trundle.geometry import FloatArray

CLOSE = 1e-6


def meet_boxes(low: FloatArray, high: FloatArray, origin: FloatArray, angles: FloatArray) -> FloatArray:
    """Where rays enter the nearest of some boxes, shapes (N, 2), infinity where they meet none."""
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (low - origin) / along, (high - origin) / along
    inside = (low <= origin) & (origin <= high)
    level = along == 0.0
    near = np.where(level, np.where(inside, -np.inf, np.inf), np.minimum(first, second)).max(axis=2)
    far = np.where(level, np.where(inside, np.inf, -np.inf), np.maximum(first, second)).min(axis=2)
    hits = np.where((near <= far) & (far >= 0.0), np.maximum(near, 0.0), np.inf)
    return hits.min(axis=1, initial=np.inf)


def check_cells(generator: random.Random) -> None:
    rng = rng_of(generator)
    shape = generator.choice((1, 3, 20)), generator.choice((1, 7, 31))
    blocked = (rng.random(shape) < generator.choice((0.0, 0.03, 0.2, 1.0))).astype(np.uint8)
    origin = rng.uniform((-5, -5), (shape[1] + 5, shape[0] + 5))
    if generator.random() < 0.3:
        origin = np.round(origin * 2.0) / 2.0
    origin *= generator.choice((1.0, 1.0, 1.0, 1e3))
    angles = rng.uniform(-7, 7, generator.choice((1, 20)))
    angles[rng.random(angles.shape) < 0.3] = generator.choice((0.0, math.pi / 4, math.pi / 2, math.pi, -math.pi / 2))
    reach = generator.choice((0.0, 3.0, 50.0, 1e5))
    arguments = (blocked, *origin.tolist(), angles, reach)
    if generator.random() < 0.3:
        attempt(cast_grid_rays, spoil(generator, arguments))
        return
    found = cast_grid_rays(*arguments)
    corners = np.argwhere(blocked)[:, ::-1].astype(np.float64)
    close = CLOSE * max(1.0, float(np.abs(origin).max()) * 0.01)
    outer = meet_boxes(corners - close, corners + 1.0 + close, origin, angles)
    inner = meet_boxes(corners + close, corners + 1.0 - close, origin, angles)
    assert (found >= np.where(outer > reach, np.inf, outer - 10.0 * close)).all()
    assert (found[inner <= reach - 10.0 * close] <= inner[inner <= reach - 10.0 * close]).all()


def check_jumps(generator: random.Random) -> None:
    """Rays that jump against those that walk, bit for bit; many of them along lines and through corners of cells."""
    rng = rng_of(generator)
    shape = generator.choice((1, 3, 20, 300)), generator.choice((1, 7, 31, 280))
    blocked = (rng.random(shape) < generator.choice((0.0, 0.0005, 0.005, 0.05, 0.3, 1.0))).astype(np.uint8)
    origin = rng.uniform((-1, -1), (shape[1] + 1, shape[0] + 1))
    if generator.random() < 0.4:
        origin = np.round(origin * 2.0) / 2.0
    angles = rng.uniform(-7, 7, generator.choice((1, 40, 100)))
    some = rng.random(angles.shape)
    angles = np.where(some < 0.2, rng.integers(-16, 17, angles.shape) * (math.pi / 8.0), angles)
    to_corners = rng.integers((0, 0), (shape[1] + 1, shape[0] + 1), (len(angles), 2)) - origin
    angles = np.where(some > 0.8, np.arctan2(to_corners[:, 1], to_corners[:, 0]), angles)
    reach = generator.choice((0.0, 3.0, 50.0, 240.0, 1e5))
    field = chebyshev_field(blocked)
    if generator.random() < 0.2:
        attempt(cast_jumping_rays, spoil(generator, (field, *origin.tolist(), angles, reach)))
        attempt(chebyshev_field, spoil(generator, (blocked,)))
        return
    cells, (row, col) = np.argwhere(blocked), rng.integers((0, 0), shape)
    apart = np.abs(cells - (row, col)).max(axis=1).min(initial=255)
    assert field[row, col] == apart
    walked = cast_grid_rays(blocked, *origin.tolist(), angles, reach)
    assert walked.tobytes() == cast_jumping_rays(field, *origin.tolist(), angles, reach).tobytes()


def meet_outline(segments: FloatArray, discs: FloatArray, angles: FloatArray, grown: float) -> FloatArray:
    """Where rays from (0, 0) first meet segments made longer at both ends, or discs made larger, outside and in."""
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    nearest = np.full(len(angles), np.inf)
    for a, b in segments.reshape(-1, 2, 2):
        length = max(float(np.hypot(*(b - a))), 1e-300)
        across = along[:, 0] * (b - a)[1] - along[:, 1] * (b - a)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (a[0] * (b - a)[1] - a[1] * (b - a)[0]) / across
            share = (a[0] * along[:, 1] - a[1] * along[:, 0]) / across
        met = (across != 0.0) & (distance >= 0.0) & (share >= -grown / length) & (share <= 1.0 + grown / length)
        nearest = np.where(met & (distance < nearest), distance, nearest)
    for x, y, radius in discs:
        middle = along @ np.array([x, y])
        root = middle**2 - (x * x + y * y - (radius + grown) ** 2)
        half = np.sqrt(np.maximum(root, 0.0))
        distance = middle + half if x * x + y * y <= radius**2 else middle - half
        nearest = np.where((root >= 0.0) & (distance >= 0.0) & (distance < nearest), distance, nearest)
    return nearest


def check_outlines(generator: random.Random) -> None:
    rng = rng_of(generator)
    segments = rng.uniform(-5, 5, (generator.choice((0, 1, 6)), 4))
    if generator.random() < 0.3:
        segments = np.round(segments)
    discs = rng.uniform((-5, -5, 0.1), (5, 5, 2.0), (generator.choice((0, 1, 4)), 3))
    x, y = rng.uniform(-3, 3, 2).tolist()
    count = generator.choice((1, 2, 37, 360))
    step = generator.uniform(0.001, 2.0 * math.pi / max(1, count - 1)) if count > 1 else 1.0
    first, reach = generator.choice((0.0, -math.pi, generator.uniform(-50, 50))), generator.choice((0.0, 3.0, 40.0))
    arguments = (segments, discs, x, y, first, step, count, reach)
    if generator.random() < 0.3:
        attempt(cast_outline_rays, spoil(generator, arguments))
        return
    found = cast_outline_rays(*arguments)
    assert ((found >= 0.0) & ((found <= reach) | np.isinf(found))).all()
    angles = first + np.arange(count) * step
    # Beams nearly along a segment and on its line, or just past a rim, may go either way.
    moved, shifted = segments - np.array([x, y, x, y]), discs - np.array([x, y, 0.0])
    candidates = [
        meet_outline(moved, shifted, turned, grown)
        for turned in (angles - 1e-8, angles, angles + 1e-8)
        for grown in (-1e-7, 1e-7)
    ]
    low, high = np.min(candidates, axis=0), np.max(candidates, axis=0)
    steady = (high - low < 1e-3) & (np.abs(low - reach) > 1e-3)
    steady |= np.isinf(low)
    expected = np.where(low <= reach, low, np.inf)
    near = np.isclose(found, expected, rtol=1e-3, atol=2e-3) | (np.isinf(found) & np.isinf(expected))
    assert near[steady].all()


def _beams(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles, ascending, and how far each beam saw."""
    through = rng.choice([-np.inf, np.inf, 1.0, 5.0], count) + rng.uniform(0.0, 1.0, count)
    return np.sort(rng.uniform(-math.pi, math.pi, count)), through


def check_moved(generator: random.Random) -> None:
    """Clusters that have moved since an earlier scan, among others that have not, and points everywhere."""
    rng = rng_of(generator)
    seconds = generator.uniform(0.2, 0.5)
    beams = [_beams(rng, generator.choice((0, 1, 2, 37, 360))) for _ in range(2)]
    middles = rng.uniform(-6.0, 6.0, (generator.choice((0, 1, 8)), 2))
    shape = rng.uniform(-0.2, 0.2, (generator.choice((1, 4, 60)), 2)).cumsum(axis=0) * 0.3
    earlier = (middles[:, None] + shape).reshape(-1, 2)
    points = (middles[:, None] + rng.uniform(-1.0, 1.0, (len(middles), 1, 2)) + shape).reshape(-1, 2)
    if generator.random() < 0.3:
        points = rng.uniform(-6.0, 6.0, (generator.choice((0, 1, 5, 900)), 2))
    sensors = rng.uniform(-2.0, 2.0, (2, 3))
    arguments = (points, sensors[0], *beams[0], earlier, sensors[1], *beams[1], seconds)
    if generator.random() < 0.3:
        attempt(find_moved, spoil(generator, arguments))
        return
    for found, expected in zip(find_moved(*arguments), find_moved_slowly(*arguments), strict=True):
        assert np.shape(found) == np.shape(expected)
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-9)


def check_lone(generator: random.Random) -> None:
    """Scans of a wall all around, with hits and beams without a return in between."""
    rng = rng_of(generator)
    scans = list[np.ndarray]()
    for count in (generator.choice((0, 1, 4, 5, 6, 90, 360)), generator.choice((0, 1, 90, 360))):
        ranges = np.where(rng.random(count) < 0.2, rng.uniform(0.0, 13.0, count), rng.normal(6.0, 0.05, count))
        ranges[rng.random(count) < 0.1] = generator.choice((math.nan, math.inf, -math.inf))
        scans += [ranges, generator.choice((1.0, -1.0)) * np.linspace(-math.pi, math.pi, count, endpoint=False)]
    poses = [rng.uniform(-0.3, 0.3, (generator.choice((1, max(1, len(scans[0])))), 3)), rng.uniform(-0.3, 0.3, (1, 3))]
    arguments = (*scans[:2], poses[0], *scans[2:], poses[1], 0.1, 12.0)
    reach = 0.4
    body = np.array([(1.0, 0.0, reach), (0.0, 1.0, reach), (-1.0, 0.0, reach), (0.0, -1.0, reach)])
    base = rng.uniform(-9.0, 9.0, 3)
    placed = (*scans[:2], rng.uniform(-0.3, 0.3, 3), base, body, 0.1, 12.0, poses[0][0], *scans[2:], poses[1][0])
    if generator.random() < 0.3:
        attempt(find_lone_hits, spoil(generator, arguments))
        attempt(place_scan, spoil(generator, placed))
        return
    assert find_lone_hits(*arguments).tolist() == find_lone_hits_slowly(*arguments)
    for found, expected in zip(place_scan(*placed), place_scan_slowly(*placed), strict=True):
        assert np.shape(found) == np.shape(expected)
        assert np.allclose(found, expected, rtol=0.0, atol=1e-9)


def check_near(generator: random.Random) -> None:
    """Points that stand and move, at poses of a box; those on the rim of what counts are left out."""
    rng = rng_of(generator)
    points = rng.uniform(-3.0, 3.0, (generator.choice((0, 1, 3, 300)), 2))
    velocities = np.where(rng.random((len(points), 1)) < 0.3, rng.uniform(-1.0, 1.0, points.shape), 0.0)
    around = (points, generator.choice((velocities, velocities[:0])), rng.uniform(-2.0, 2.0, 3), 0.3, 1.5, 1.0)
    poses = rng.uniform(-1.0, 1.0, (generator.choice((1, 9)), 3))
    times = np.linspace(0.0, 1.0, len(poses)) if generator.random() < 0.5 else np.zeros(0)
    ahead, behind, aside = rng.uniform(0.1, 0.6, 3).tolist()
    outline = np.array([(ahead, -aside), (ahead, aside), (-behind, aside), (-behind, -aside)])
    sides = np.array([(1.0, 0.0, ahead), (0.0, 1.0, aside), (-1.0, 0.0, behind), (0.0, -1.0, aside)])
    clear = (points, velocities, poses, times, outline, sides, generator.choice((0.0, 0.3)), generator.choice((1, 3)))
    if generator.random() < 0.3:
        attempt(points_around, spoil(generator, around))
        attempt(outline_clearances, spoil(generator, clear))
        return
    for found, expected in zip(points_around(*around), points_around_slowly(*around), strict=True):
        assert np.shape(found) == np.shape(expected)
        assert np.allclose(found, expected, rtol=0.0, atol=1e-9)
    assert np.allclose(outline_clearances(*clear), outline_clearances_slowly(*clear), rtol=0.0, atol=1e-9)


def check_ranges(generator: random.Random) -> None:
    """Distances within and beyond a lidar's ranges, with and without noise."""
    rng = rng_of(generator)
    distances = np.where(rng.random(count := generator.choice((0, 1, 90))) < 0.1, np.inf, rng.uniform(0.0, 13.0, count))
    noise = rng.standard_normal(generator.choice((0, count)))
    if generator.random() < 0.3:
        attempt(measure_ranges, spoil(generator, (distances, noise, 0.5, 0.1, 12.0)))
        return
    expected = np.clip(distances + 0.5 * noise if len(noise) else distances, 0.1, 12.0)
    expected[distances > 12.0] = np.inf
    assert np.array_equal(measure_ranges(distances, noise, 0.5, 0.1, 12.0), expected)


def one_round(generator: random.Random) -> None:
    checks = check_cells, check_jumps, check_outlines, check_moved, check_lone, check_near, check_ranges
    generator.choice(checks)(generator)
