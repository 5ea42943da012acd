"""Hits that neither a beam beside them nor the scan before has seen, beam by beam in plain Python."""

import math

import numpy as np


def find_lone_hits(ranges, angles, sensor, earlier_ranges, earlier_angles, earlier_sensor, range_min, range_max):
    """As the kernel of that name."""
    count = len(ranges)
    if count < 5:
        return []
    spacing = abs(angles[-1] - angles[0]) / (count - 1)
    x0, y0, yaw0 = earlier_sensor[len(earlier_sensor) // 2]
    found = []
    for beam, range_m in enumerate(ranges):
        if not range_min <= range_m <= range_max:
            continue
        apart = spacing * range_m
        beside = [ranges[(beam + aside) % count] for aside in (-2, -1, 1, 2)]
        if any(other <= range_m + 0.15 + 3.0 * apart for other in beside):
            continue
        x, y, yaw = sensor[beam if len(sensor) > 1 else 0]
        dx, dy = x + range_m * math.cos(yaw + angles[beam]) - x0, y + range_m * math.sin(yaw + angles[beam]) - y0
        distance, bearing, across = math.hypot(dx, dy), math.atan2(dy, dx) - yaw0, 0.03 + 2.0 * apart
        off = np.abs(np.angle(np.exp(1j * (np.asarray(earlier_angles) - bearing)))) * distance
        near = np.abs(np.asarray(earlier_ranges) - distance) <= 0.1
        inside = (np.asarray(earlier_ranges) >= range_min) & (np.asarray(earlier_ranges) <= range_max)
        if not (near & inside & (off <= across)).any():
            found.append(beam)
    return found
