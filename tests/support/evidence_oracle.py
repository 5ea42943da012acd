"""Marking, clearing and painting of evidence, cell by cell: the slow and plain version of the kernels.

Where a number lies so near the border of a cell that rounding decides, a cell is uncertain, and either answer is right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

CLOSE = 1e-6
MARKED, LEVEL = 128, 127


@dataclass
class Grid:
    """Evidence with its place; `uncertain` are cells in which rounding decides."""

    evidence: np.ndarray
    points: np.ndarray
    times: np.ndarray
    row: int
    col: int
    resolution: float
    uncertain: set = field(default_factory=set)

    def copy(self):
        return Grid(
            self.evidence.copy(), self.points.copy(), self.times.copy(), self.row, self.col, self.resolution, set()
        )

    def arrays(self):
        return self.evidence, self.points, self.times, self.row, self.col, self.resolution

    def holds(self, row, col):
        return 0 <= row < self.evidence.shape[0] and 0 <= col < self.evidence.shape[1]


def after_hit(byte, hit, miss):
    neutral = 1 + hit * miss
    level = min(max(byte & LEVEL, neutral) + hit, neutral + hit * miss)
    return level | (MARKED if level == neutral + hit * miss else byte & MARKED)


def after_miss(byte, hit, miss):
    neutral = 1 + hit * miss
    level = max((byte & LEVEL or neutral) - miss, 1)
    return level | (0 if level <= neutral else byte & MARKED)


def after_shorter(byte, hit, miss):
    """Behind a hit: what a cell had gathered on the way to a mark grows less."""
    neutral = 1 + hit * miss
    return byte if byte & MARKED or byte <= neutral else max(byte - miss, neutral)


def kind(byte):
    """What others can see of a cell: whether it is marked, unseen, surely free, or something between."""
    return byte & MARKED, min(byte & LEVEL, 2)


def is_inside(outline, x, y):
    edges = zip(outline, np.roll(outline, -1, axis=0), strict=True)
    return len(outline) > 0 and all((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0 for a, b in edges)


def floors(value):
    """The whole numbers below a value, both of them where it is close to one."""
    return {math.floor(value - CLOSE), math.floor(value + CLOSE)}


def passed_cells(x0, y0, x1, y1):
    """Cells (row, col) that a beam passes, and those that it may pass: one for each step along its longer axis."""
    if abs(x1 - x0) < abs(y1 - y0):
        sure, either = passed_cells(y0, x0, y1, x1)
        return {(c, r) for r, c in sure}, {(c, r) for r, c in either}
    if x1 == x0:
        return set(), set()
    firsts, lasts = floors(x0), floors(x1)
    sure, either = set(), set()
    if abs(abs(x1 - x0) - abs(y1 - y0)) < CLOSE:  # a beam along a diagonal: either axis may be the longer one
        around = [(x0, y0), (x1, y1)]
        low, high = np.floor(np.min(around, axis=0)).astype(int) - 1, np.floor(np.max(around, axis=0)).astype(int) + 1
        either = {(r, c) for r in range(low[1], high[1] + 1) for c in range(low[0], high[0] + 1)}
    first, last = math.floor(x0), math.floor(x1)
    step = 1 if last > first else -1
    for c in range(first, last, step):
        y = y0 + (c + 0.5 - x0) * (y1 - y0) / (x1 - x0)
        cells = {(r, c) for r in floors(y)}
        sure |= cells
        either |= cells if len(cells) > 1 else set()
    for c in (firsts if len(firsts) > 1 else set()) | (lasts if len(lasts) > 1 else set()):
        y = y0 + (c + 0.5 - x0) * (y1 - y0) / (x1 - x0)
        either |= {(r, c) for r in floors(y)}
    return sure, either


def mark_scan(grid, poses, angles, ranges, outline, limits, infinite_is_free, hit, miss, time):
    """What `_core.mark_scan` does to a grid, in place."""
    range_min, range_max, obstacle_min, obstacle_max, raytrace_min, raytrace_max = limits
    passed, behind, hits = set(), set(), {}
    for i, (angle, reading) in enumerate(zip(angles.tolist(), ranges.tolist(), strict=True)):
        endless = reading == math.inf
        if (endless and not infinite_is_free) or (not endless and not range_min <= reading <= range_max):
            continue
        if not endless and is_inside(outline, reading * math.cos(angle), reading * math.sin(angle)):
            continue
        x, y, yaw = poses[i if len(poses) > 1 else 0]
        dx, dy = math.cos(yaw + angle), math.sin(yaw + angle)
        x, y = x / grid.resolution - grid.col, y / grid.resolution - grid.row
        start, end = raytrace_min / grid.resolution, min(reading, range_max, raytrace_max) / grid.resolution
        if end > start:
            sure, either = passed_cells(x + start * dx, y + start * dy, x + end * dx, y + end * dy)
            passed |= sure
            grid.uncertain |= either
        if not endless and obstacle_min <= reading <= obstacle_max:
            at = x + reading / grid.resolution * dx, y + reading / grid.resolution * dy
            cells = {(r, c) for r in floors(at[1]) for c in floors(at[0])}
            grid.uncertain |= cells if len(cells) > 1 else set()
            hits[math.floor(at[1]), math.floor(at[0])] = at
            cells = {(r, c) for r in floors(at[1] + dy) for c in floors(at[0] + dx)}
            grid.uncertain |= cells if len(cells) > 1 else set()
            behind |= cells
    for (row, col), (x, y) in hits.items():
        if not grid.holds(row, col):
            continue
        if grid.times.size:
            grid.times[row, col] = time
        if not grid.evidence[row, col] & MARKED:
            grid.points[row, col] = int((x - col) * 256), int((y - row) * 256)
        grid.evidence[row, col] = after_hit(int(grid.evidence[row, col]), hit, miss)
    for cells, change in ((passed - set(hits), after_miss), (behind - passed - set(hits), after_shorter)):
        for row, col in cells:
            if grid.holds(row, col):
                grid.evidence[row, col] = change(int(grid.evidence[row, col]), hit, miss)


def unmark_before(grid, before, hit, miss):
    """What `_core.unmark_before` does to a grid, in place."""
    for row, col in np.argwhere(grid.evidence & MARKED):
        if grid.times[row, col] < before:
            grid.evidence[row, col] = 1 + hit * miss


def unmark_within(grid, outline, hit, miss):
    """What `_core.unmark_within` does to a grid, in place."""
    wider = outline + (outline - outline.mean(axis=0)) * 1e-9
    narrower = outline - (outline - outline.mean(axis=0)) * 1e-9
    for row, col in np.ndindex(grid.evidence.shape):
        marked = grid.evidence[row, col] & MARKED
        inside = (grid.points[row, col] + 0.5) / 256 if marked else np.array([0.5, 0.5])
        x, y = (inside + np.array([grid.col + col, grid.row + row])) * grid.resolution
        if is_inside(wider, x, y) != is_inside(narrower, x, y):
            grid.uncertain.add((row, col))
        if (marked or grid.evidence[row, col] == 0) and is_inside(outline, x, y):
            grid.evidence[row, col] = 1 + hit * miss


def paint_marks(grid, cells, kept, x, y, yaw, cell_size, clear_occupied):
    """What `_core.paint_marks` does to cells, in place; returns the uncertain ones."""
    cos, sin, uncertain = math.cos(yaw), math.sin(yaw), set()
    free = []
    for row, col in np.ndindex(cells.shape):
        along, across = (col + 0.5) * cell_size, (row + 0.5) * cell_size
        at = (
            (x + cos * along - sin * across) / grid.resolution - grid.col,
            (y + sin * along + cos * across) / grid.resolution - grid.row,
        )
        if len(floors(at[0])) > 1 or len(floors(at[1])) > 1:
            uncertain.add((row, col))
        seen = math.floor(at[1]), math.floor(at[0])
        level = int(grid.evidence[seen]) & LEVEL if grid.holds(*seen) else 0
        if (cells[row, col] == -1 and level) or (cells[row, col] == 100 and clear_occupied and level == 1):
            free.append((row, col))
    for cell in free:
        cells[cell] = 0
    for row, col in np.argwhere(grid.evidence & MARKED):
        at = ((grid.points[row, col] + 0.5) / 256 + (grid.col + col, grid.row + row)) * grid.resolution - (x, y)
        to = (cos * at[0] + sin * at[1]) / cell_size, (cos * at[1] - sin * at[0]) / cell_size
        found = [(r, c) for r in floors(to[1]) for c in floors(to[0])]
        uncertain |= set(found) if len(found) > 1 else set()
        cell = math.floor(to[1]), math.floor(to[0])
        if 0 <= cell[0] < cells.shape[0] and 0 <= cell[1] < cells.shape[1] and not kept[cell]:
            cells[cell] = 100
    return uncertain
