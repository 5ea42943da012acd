"""Conditions of a recorded drive: odometry errors, slips, beams that fail, a start that is off, and a changed map.

A: odometry 1 % and 1°/m off, exact start. B: 5 % and 5°/m, start off by 1 m and 20°. D: as B, with six slips of 0.3 m
and 10°, a quarter of the smaller objects missing from the map and twelve ghosts on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from benchmarks.localization.drives import Drive, Moment
from scipy import ndimage

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.observation import Observation, Scan

DROPOUTS, SHORTS = 0.01, 0.01
_SLIP_S = 0.5
_SMALL_M = 2.5


@dataclass(frozen=True)
class Condition:
    """How a drive is made harder; see the module."""

    name: str
    scale: float
    heading_deg: float
    off_m: float = 0.0
    off_deg: float = 0.0
    slips: int = 0
    changed: bool = False


CONDITIONS = {
    "A": Condition("A", 0.01, 1.0),
    "B": Condition("B", 0.05, 5.0, 1.0, 20.0),
    "D": Condition("D", 0.05, 5.0, 1.0, 20.0, 6, True),
}


def change_map(grid: OccupancyGrid, moments: Sequence[Moment], rng: np.random.Generator) -> OccupancyGrid:
    """Take a quarter of the smaller objects off a map, and put twelve ghosts on it, where the robot does not drive."""
    data = grid.data.copy()
    labels, _ = ndimage.label(data >= 65, np.ones((3, 3)))
    for index, part in enumerate(ndimage.find_objects(labels), start=1):
        size = max(s.stop - s.start for s in part) * grid.resolution
        if size <= _SMALL_M and rng.random() < 0.25:
            data[labels == index] = 0
    inverse = grid.origin.inverse()
    driven = np.array([(inverse @ m.pose).as_tuple()[:2] for m in moments[::10]]) / grid.resolution
    free = np.argwhere(grid.data == 0)
    made = 0
    for _ in range(1000):
        if made == 12:
            break
        row, col = free[rng.integers(len(free))]
        if (np.hypot(driven[:, 0] - col, driven[:, 1] - row) * grid.resolution).min() < 1.2:
            continue
        half = (rng.uniform(0.15, 0.5, 2) / grid.resolution).astype(int)
        part = data[max(0, row - half[0]) : row + half[0] + 1, max(0, col - half[1]) : col + half[1] + 1]
        part[part == 0] = 100
        made += 1
    return replace(grid, data=data)


def spoil_scan(scan: Scan, rng: np.random.Generator) -> Scan:
    """One beam in a hundred without a return, one in a hundred cut short."""
    ranges = scan.ranges.copy()
    draw = rng.random(len(ranges))
    ranges[draw < DROPOUTS] = math.inf
    short = (draw > 1.0 - SHORTS) & np.isfinite(ranges)
    ranges[short] = scan.range_min + rng.random(int(short.sum())) * (ranges[short] - scan.range_min)
    return replace(scan, ranges=ranges)


def observe(drive: Drive, condition: Condition, rng: np.random.Generator) -> Iterator[tuple[Moment, Observation]]:
    """Yield each moment with what the robot observes in it."""
    scale = 1.0 + condition.scale * rng.choice((-1.0, 1.0))
    heading = math.radians(condition.heading_deg) * rng.choice((-1.0, 1.0))
    end = drive.moments[-1].time
    slips = [(t, *rng.choice((-1.0, 1.0), 2)) for t in rng.uniform(5.0, max(6.0, end - 5.0), condition.slips)]
    odometry, last = Pose2D(0.0, 0.0), drive.moments[0].pose
    for moment in drive.moments:
        step = last.inverse() @ moment.pose
        seconds = 0.05
        last = moment.pose
        distance = math.hypot(step.x, step.y)
        x, y, yaw = step.x * scale, step.y * scale, step.yaw + heading * distance
        for start, along, around in slips:
            if start <= moment.time < start + _SLIP_S:
                x += along * 0.3 * seconds / _SLIP_S
                yaw += around * math.radians(10.0) * seconds / _SLIP_S
        odometry = odometry @ Pose2D(x, y, yaw)
        scans = tuple(spoil_scan(scan, rng) for scan in moment.scans)
        twist = Twist2D(moment.twist.v * scale, moment.twist.w)
        yield moment, Observation(moment.time, twist, odometry, scans)


def start_of(drive: Drive, condition: Condition, rng: np.random.Generator) -> Pose2D:
    """The start that the localizer is told."""
    truth = drive.moments[0].pose
    for _ in range(200):
        angle = rng.uniform(-math.pi, math.pi)
        off = Pose2D(
            truth.x + condition.off_m * math.cos(angle),
            truth.y + condition.off_m * math.sin(angle),
            truth.yaw + math.radians(condition.off_deg) * rng.choice((-1.0, 1.0)),
        )
        place = drive.grid.origin.inverse() @ off
        col, row = (math.floor(value / drive.grid.resolution) for value in (place.x, place.y))
        if 0 <= row < drive.grid.shape[0] and 0 <= col < drive.grid.shape[1] and drive.grid.data[row, col] == 0:
            return off
    return truth
