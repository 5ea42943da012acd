"""What has moved between two scans, in NumPy."""

import itertools
import math

import numpy as np


def find_moved(points, sensor, angles, through, earlier, earlier_sensor, earlier_angles, earlier_through, seconds):
    """As the kernel of that name."""
    appeared = _seen_through(points, earlier_sensor, earlier_angles, earlier_through)
    came = _runs(appeared, points, sensor)
    left = _runs(_seen_through(earlier, sensor, angles, through), earlier, earlier_sensor)
    velocities, moves = _velocities(points, earlier, appeared, came, left, seconds)
    return velocities, moves, _edges(points, earlier, came, seconds)


def _seen_through(points, sensor, angles, through):
    if len(angles) == 0:
        return np.zeros(len(points), dtype=bool)
    dx, dy = points[:, 0] - sensor[0], points[:, 1] - sensor[1]
    # The nearest beam; the ends of a full turn are one direction.
    bearings = (np.arctan2(dy, dx) - sensor[2] - angles[0]) % math.tau + angles[0]
    after = np.searchsorted(angles, bearings)
    beyond = bearings - angles[-1] > 2.0 * (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    return (np.hypot(dx, dy) + 0.1 < through[np.minimum(after, len(angles) - 1)]) & ~beyond


def _runs(some, points, sensor):
    runs = some.copy()
    for shift in (1, -1):
        runs &= np.roll(some, shift) | np.roll(some, 2 * shift) & np.roll(some, -shift)
    return runs & (np.hypot(points[:, 0] - sensor[0], points[:, 1] - sensor[1]) <= 5.0)


def _velocities(points, earlier, appeared, came, left, seconds):
    velocities, moves = np.zeros_like(points), False
    old = [(part, _extent(earlier[part])) for part in _things(earlier)]
    old = [(part, 0.5 * (low + high)) for part, (low, high) in old if math.dist(low, high) <= 3.0]
    for part in _things(points):
        low, high = _extent(points[part])
        length = part.stop - part.start
        if length < 3 or math.dist(low, high) > 3.0 or not old:
            continue
        offsets = 0.5 * (low + high) - np.array([middle for _, middle in old])
        nearest = int((offsets**2).sum(axis=1).argmin())
        count = int(appeared[part].sum())
        has_moved = count >= 3 and count >= 0.3 * length
        has_moved = has_moved or came[part].sum() >= 3 or left[old[nearest][0]].sum() >= 3
        velocity = offsets[nearest] / seconds
        if has_moved and math.hypot(*velocity) <= 4.0:
            velocities[part] = velocity
            moves = True
    return velocities, moves


def _edges(points, earlier, came, seconds):
    nothing = np.zeros((0, 4))
    index = np.flatnonzero(came)
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
