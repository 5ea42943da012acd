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
    least = np.full(len(points), np.inf)
    for shift in range(-aside, aside + 1):
        end = ends[(index + shift) % len(bearings)]
        least = np.minimum(least, (end[:, 0] - points[:, 0]) ** 2 + (end[:, 1] - points[:, 1]) ** 2)
    seen[within & (least < (margin + 0.5 * spacing * distances) ** 2)] = 2
    seen[within & (through[index] > distances + margin)] = 1
    return seen


def _apart(a, b):
    return np.abs((a - b + math.pi) % math.tau - math.pi)
