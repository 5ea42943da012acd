"""What an earlier scan says about points, in NumPy."""

import math

import numpy as np


def compare_scan(bearings, through, ends, x, y, zero, spacing, points, margin, aside):
    """As the kernel of that name."""
    seen = np.zeros(len(points), dtype=np.uint8)
    if len(bearings) == 0:
        return seen
    dx, dy = points[:, 0] - x, points[:, 1] - y
    distances = np.hypot(dx, dy)
    there = (np.arctan2(dy, dx) - zero + 1e-9) % math.tau
    index = np.minimum(np.searchsorted(bearings, there - 0.5 * spacing), len(bearings) - 1)
    index = np.where(_apart(there, bearings[index]) > 1.01 * spacing, 0, index)
    within = _apart(there, bearings[index]) <= 1.01 * spacing
    past = through[index] > distances + margin
    near = np.where(past, 0.7, 1.0) * margin + 0.5 * spacing * distances
    with np.errstate(divide="ignore", invalid="ignore"):
        # As many beams as the margin is wide there, where the beams see past a point; half of all at most.
        across = np.ceil(near / (spacing * distances))
    across = np.where(across < 0.5 * len(bearings), across, 0.5 * len(bearings)).astype(int)
    width = np.where(past, np.maximum(across, aside), aside)
    least = np.full(len(points), np.inf)
    for shift in range(-int(width.max(initial=0)), int(width.max(initial=0)) + 1):
        end = ends[(index + shift) % len(bearings)]
        square = (end[:, 0] - points[:, 0]) ** 2 + (end[:, 1] - points[:, 1]) ** 2
        least = np.where(np.abs(shift) <= width, np.minimum(least, square), least)
    seen[within & past] = 1
    seen[within & (least < near**2)] = 2
    return seen


def _apart(a, b):
    return np.abs((a - b + math.pi) % math.tau - math.pi)
