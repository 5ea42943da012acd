"""What has moved between two scans, in NumPy."""

import itertools
import math

import numpy as np


def find_moved(points, sensor, earlier, earlier_sensor, angles, through, seconds):
    """As the kernel of that name."""
    appeared = _appeared(points, earlier_sensor, angles, through)
    velocities, moves = _velocities(points, earlier, appeared, seconds)
    return velocities, moves, _edges(points, sensor, earlier, appeared, seconds)


def _appeared(points, sensor, angles, through):
    if len(angles) == 0:
        return np.zeros(len(points), dtype=bool)
    dx, dy = points[:, 0] - sensor[0], points[:, 1] - sensor[1]
    # The nearest beam; the ends of a full turn are one direction.
    bearings = (np.arctan2(dy, dx) - sensor[2] - angles[0]) % math.tau + angles[0]
    after = np.searchsorted(angles, bearings)
    beyond = bearings - angles[-1] > 2.0 * (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    return (np.hypot(dx, dy) + 0.1 < through[np.minimum(after, len(angles) - 1)]) & ~beyond


def _velocities(points, earlier, appeared, seconds):
    velocities, moves = np.zeros_like(points), False
    old = [_extent(earlier[part]) for part in _things(earlier)]
    middles = np.array([0.5 * (low + high) for low, high in old if math.dist(low, high) <= 3.0])
    for part in _things(points):
        count = int(appeared[part].sum())
        if count < 3 or count < 0.3 * (part.stop - part.start) or len(middles) == 0:
            continue
        low, high = _extent(points[part])
        offsets = 0.5 * (low + high) - middles
        velocity = offsets[int(np.hypot(offsets[:, 0], offsets[:, 1]).argmin())] / seconds
        if math.dist(low, high) <= 3.0 and math.hypot(*velocity) <= 4.0:
            velocities[part] = velocity
            moves = True
    return velocities, moves


def _edges(points, sensor, earlier, appeared, seconds):
    nothing = np.zeros((0, 4))
    runs = appeared.copy()
    for shift in (1, -1):
        runs &= np.roll(appeared, shift) | np.roll(appeared, 2 * shift) & np.roll(appeared, -shift)
    runs &= np.hypot(points[:, 0] - sensor[0], points[:, 1] - sensor[1]) <= 5.0
    index = np.flatnonzero(runs)
    if len(index) < 3 or len(earlier) == 0:
        return nothing
    points = points[index[:: max(1, math.ceil(len(index) / 200))]]
    offset = points[:, None] - earlier
    nearest = (offset**2).sum(axis=2).argmin(axis=1)
    velocities = offset[np.arange(len(points)), nearest] / seconds
    credible = np.hypot(velocities[:, 0], velocities[:, 1]) <= 4.0
    edges = np.column_stack([points, velocities])[credible]
    return edges if len(edges) >= 3 else nothing


def _things(points):
    """Runs of neighbouring points without a gap."""
    if len(points) == 0:
        return []
    steps = np.diff(points, axis=0)
    ends = [0, *(np.flatnonzero(np.hypot(steps[:, 0], steps[:, 1]) > 0.3) + 1).tolist(), len(points)]
    return [slice(begin, end) for begin, end in itertools.pairwise(ends)]


def _extent(points):
    return points.min(axis=0), points.max(axis=0)
