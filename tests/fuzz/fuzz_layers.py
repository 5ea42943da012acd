"""Scans into evidence and evidence into maps, against the same cell by cell."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support import evidence_oracle as oracle
from trundle._core import mark_scan, paint_marks, repaint_marks, unmark_before, unmark_within
from trundle.geometry import FloatArray


def make_grid(generator: random.Random) -> oracle.Grid:
    """An empty grid near or far from the origin."""
    shape = generator.choice(((1, 1), (7, 30), (25, 25), (6, 200)))
    far = generator.choice((0, 0, 1000, -123_456_789))
    row, col = far + generator.randrange(-20, 5), far + generator.randrange(-20, 5)
    timed = shape if generator.random() < 0.7 else (0, 0)
    resolution = generator.choice((1.0, 0.5, 0.05, 0.3))
    return oracle.Grid(
        np.zeros(shape, np.uint8), np.zeros((*shape, 2), np.uint8), np.zeros(timed), row, col, resolution
    )


def middle_of(grid: oracle.Grid) -> FloatArray:
    rows, cols = grid.evidence.shape
    return np.array([grid.col + cols / 2.0, grid.row + rows / 2.0]) * grid.resolution


def scan_of(generator: random.Random, grid: oracle.Grid, time: float) -> tuple[Any, ...]:
    """Arguments of `mark_scan` after those of the grid."""
    rng, edge = rng_of(generator), grid.resolution
    count = generator.choice((0, 1, 2, 9, 40))
    poses = np.zeros((count if generator.random() < 0.3 and count else 1, 3))
    poses[:, :2] = middle_of(grid) + rng.uniform(-8, 8, 2) * edge + rng.uniform(-1, 1, (len(poses), 2)) * edge
    poses[:, 2] = rng.uniform(-4, 4)
    if generator.random() < 0.3:
        poses = np.round(poses / (edge / 2)) * (edge / 2)
    angles = rng.uniform(-7, 7, count)
    angles[rng.random(count) < 0.3] = generator.choice((0.0, math.pi / 4, math.pi / 2, -math.pi))
    longer = generator.choice((1.0, 1.0, 7.0)) * edge
    ranges = rng.uniform(0, 25, count) * longer
    ranges[rng.random(count) < 0.3] = generator.choice((math.nan, math.inf, -math.inf, 0.0, 10.0 * edge, 1e300))
    low = generator.choice((0.0, 2.0)) * edge
    nearest, farthest = generator.choice((0.0, 1.0)) * edge, generator.choice((12.0, 30.0)) * longer
    clears = 0.5 * low, generator.choice((5.0, 18.0)) * longer
    limits = np.array([nearest, farthest, low, 15.0 * longer, *clears])
    half = generator.uniform(0.5, 4.0) * edge
    outline = np.array([(half, half), (-half, half), (-half, -half), (half, -half)])
    outline = outline if generator.random() < 0.5 else np.zeros((0, 2))
    return poses, angles, ranges, outline, limits, generator.random() < 0.7, *rule_of(generator), time


def rule_of(generator: random.Random) -> tuple[int, int]:
    return generator.choice(((5, 2), (1, 1), (10, 5), (9, 7)))


def compare(grid: oracle.Grid, expected: oracle.Grid, before: oracle.Grid, box: tuple[int, ...]) -> None:
    """That a grid is as expected but for uncertain cells, and the rectangle holds what changed, no more."""
    sure = np.ones(grid.evidence.shape, bool)
    for cell in expected.uncertain:
        if grid.holds(*cell):
            sure[cell] = False
    assert (grid.evidence == expected.evidence)[sure].all()
    assert (np.abs(grid.points.astype(int) - expected.points.astype(int)) <= 1)[sure].all()
    if grid.times.size:
        assert (grid.times == expected.times)[sure].all()
    pairs = zip(grid.evidence.flat, before.evidence.flat, strict=True)
    changed = np.array([oracle.kind(int(now)) != oracle.kind(int(old)) for now, old in pairs])
    cells = np.argwhere(changed.reshape(grid.evidence.shape))
    ends = (0, 0, 0, 0) if not len(cells) else (*np.stack([cells.min(0), cells.max(0) + 1]).T.ravel().tolist(),)
    assert box == ends


def check_scans(generator: random.Random, grid: oracle.Grid) -> None:
    for number in range(generator.choice((1, 4, 9))):
        arguments = scan_of(generator, grid, float(number))
        before = grid.copy()
        if generator.random() < 0.1:
            spoiled = spoil(generator, (*before.copy().arrays(), *arguments))
            attempt(mark_scan, spoiled)
            continue
        expected = grid.copy()
        oracle.mark_scan(expected, *arguments)
        compare(grid, expected, before, mark_scan(*grid.arrays(), *arguments))


def check_unmarking(generator: random.Random, grid: oracle.Grid) -> None:
    rule = rule_of(generator)
    if grid.times.size:
        before, expected, limit = grid.copy(), grid.copy(), generator.uniform(-1, 5)
        oracle.unmark_before(expected, limit, *rule)
        compare(grid, expected, before, unmark_before(grid.evidence, grid.times, limit, *rule))
        attempt(unmark_before, spoil(generator, (before.evidence, before.times, limit, *rule)))
    turn, radius = generator.uniform(-4, 4), generator.uniform(0.1, 6.0) * grid.resolution
    angles = turn + np.arange(5) * (2.0 * math.pi / 5.0)
    outline = middle_of(grid) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    place = grid.row, grid.col, grid.resolution, outline, *rule
    before, expected = grid.copy(), grid.copy()
    oracle.unmark_within(expected, outline, *rule)
    compare(grid, expected, before, unmark_within(grid.evidence, grid.points, *place))
    attempt(unmark_within, spoil(generator, (before.evidence, before.points, *place)))


def check_painting(generator: random.Random, grid: oracle.Grid) -> None:
    rng = rng_of(generator)
    shape = generator.choice(((1, 1), (12, 30), (20, 9)))
    cells = rng.choice(np.array([-1, 0, 50, 100], np.int8), shape)
    kept = (rng.random(shape) < generator.choice((0.0, 0.2))).astype(np.uint8)
    corner = middle_of(grid) + rng.uniform(-20, 10, 2) * grid.resolution
    yaw = generator.choice((0.0, 0.0, math.pi / 2, generator.uniform(-4, 4)))
    if generator.random() < 0.5:
        corner = np.round(corner / grid.resolution) * grid.resolution
    size = grid.resolution * generator.choice((1.0, 1.0, 0.4, 3.0))
    place = *corner.tolist(), yaw, size, generator.random() < 0.5
    evidence = grid.evidence, grid.points, grid.row, grid.col, grid.resolution
    expected = cells.copy()
    uncertain = oracle.paint_marks(grid, expected, kept, *place)
    attempt(paint_marks, spoil(generator, (*evidence, cells.copy(), kept, *place)))
    paint_marks(*evidence, cells, kept, *place)
    sure = np.ones(shape, bool)
    for row, col in uncertain:
        if 0 <= row < shape[0] and 0 <= col < shape[1]:
            sure[row, col] = False
    assert (cells == expected)[sure].all()
    check_repainting(generator, evidence, cells, kept, place)


def check_repainting(
    generator: random.Random, evidence: tuple, painted: np.ndarray, kept: np.ndarray, place: tuple
) -> None:
    """A window of a larger map is painted as a separate map, and the rectangle holds what has changed there."""
    base = rng_of(generator).choice(np.array([-1, 0, 100], np.int8), painted.shape)
    alone = base.copy()
    paint_marks(*evidence, alone, kept, *place)
    row, col = generator.randrange(4), generator.randrange(4)
    window = row, row + painted.shape[0], col, col + painted.shape[1]
    around = ((row, generator.randrange(3)), (col, generator.randrange(3)))
    wide_base, wide_kept, before = (np.pad(one, around, constant_values=1) for one in (base, kept, painted))
    given = wide_base, wide_kept, window, *place
    attempt(repaint_marks, spoil(generator, (*evidence, before.copy(), *given)))
    after = before.copy()
    box = repaint_marks(*evidence, after, *given)
    expected = before.copy()
    expected[row : window[1], col : window[3]] = alone
    assert (after == expected).all()
    rows, cols = np.nonzero(after != before)
    ends = (rows.min(), rows.max() + 1, cols.min(), cols.max() + 1) if len(rows) else (0, 0, 0, 0)
    assert box == tuple(int(end) for end in ends)


def one_round(generator: random.Random) -> None:
    grid = make_grid(generator)
    check_scans(generator, grid)
    check_unmarking(generator, grid)
    check_painting(generator, grid)
