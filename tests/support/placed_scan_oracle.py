"""What one scan shows, step by step in NumPy."""

import numpy as np

from support.lone_hits_oracle import find_lone_hits


def place_scan(
    ranges, angles, mount, base, body, range_min, range_max, sensor, earlier_ranges, earlier_angles, earlier_sensor
):
    """As the kernel of that name."""
    earlier = earlier_ranges, earlier_angles, earlier_sensor[None, :]
    ranges = np.array(ranges)
    ranges[find_lone_hits(ranges, angles, sensor[None, :], *earlier, range_min, range_max)] = np.inf
    hit = (ranges >= range_min) & (ranges <= range_max)
    directions = angles[hit] + mount[2]
    points = mount[:2] + ranges[hit, None] * np.column_stack([np.cos(directions), np.sin(directions)])
    within = (points @ body[:, :2].T <= body[:, 2]).all(axis=1) & (len(body) > 0)
    cos, sin = np.cos(base[2]), np.sin(base[2])
    points = base[:2] + points[~within] @ np.array([(cos, sin), (-sin, cos)])
    seen = np.where(ranges >= range_min, ranges, -np.inf)
    if len(angles) and angles[0] > angles[-1]:
        angles, seen = angles[::-1], seen[::-1]
    beside = [np.roll(seen, by) for by in range(-3, 4)] if len(seen) >= 3 else seen[:, None] + np.zeros_like(seen)
    return points, angles, np.min(beside, axis=0, initial=np.inf)
