"""`Sweep`: one scan in the odom frame, by the directions of its beams, and what it says about points elsewhere."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from support.scan_compare_oracle import compare_scan
from trundle.geometry import FloatArray
from trundle.observation import Scan

BoolArray = npt.NDArray[np.bool_]
IndexArray = npt.NDArray[np.intp]

_BEAMS_ASIDE = 2
_THROUGH, _THERE = 1, 2  # of compare_scan
_GRAZING_RAD = math.radians(10.0)
_LEAST_GAP_M = 0.12
_PAST_M = 0.15


class Sweep:
    """One scan, sorted by direction as seen from one place: where the sensor was in the middle of it.

    Args:
        scan: The scan.
        poses: Of the sensor in the odom frame, shape (1, 3), or (beams, 3) where it was measured beam by beam.
        max_range: Hits farther away are left out [m].
        body: Outline of the robot, counter-clockwise, base_link [m]; hits inside are its own body.

    Attributes:
        time: Of the scan [s].
        sensor: (x, y) of the sensor [m].
        points: Its hits by direction, odom frame [m], shape (N, 2).
        beams: Of each hit, the index of its beam, shape (N,).
        ranges: Of each hit [m], shape (N,).
        sight: How far each beam saw [m], minus infinity where it measured nothing, shape (beams,).
        spacing: Angle between two beams [rad].
    """

    def __init__(self, scan: Scan, poses: FloatArray, max_range: float, body: FloatArray) -> None:
        self.time = scan.time
        middle = poses[len(poses) // 2]
        self.sensor = middle[:2]
        measured = np.isfinite(scan.ranges) & (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
        reach = np.where(measured, scan.ranges, scan.range_max)
        directions = scan.angles + poses[:, 2]
        ends = poses[:, :2] + reach[:, None] * np.column_stack([np.cos(directions), np.sin(directions)])
        if len(poses) == 1:
            bearings, ranges = directions, reach
        else:
            offset = ends - self.sensor
            bearings, ranges = np.arctan2(offset[:, 1], offset[:, 0]), np.hypot(offset[:, 0], offset[:, 1])
        count = len(bearings)
        self.spacing = math.tau / max(count, 1)
        self._zero = float(bearings[0]) if count else 0.0
        if count > 1 and bearings[1] < bearings[0]:
            self._zero = float(bearings[-1])
        bearings = (bearings - self._zero + 1e-9) % math.tau
        order: slice | IndexArray = slice(None)
        if count > 1:
            if (bearings[1:] < bearings[:-1]).any():
                order = np.argsort(bearings, kind="stable")
                bearings = bearings[order]
            self.spacing = float(bearings[-1] - bearings[0]) / (count - 1)
        self._bearings, measured = bearings, measured[order]
        given = scan.ranges[order]
        # Infinity is a measurement: nothing up to the longest range.
        self.sight: FloatArray = np.where(measured | (given == math.inf), ranges[order], -np.inf)
        self._through = _least_around(self.sight, np.isnan(given))
        self._ends = np.where(measured[:, None], ends[order], np.inf)
        taken = measured & (ranges[order] <= max_range)
        taken &= ~_hits_body(scan, body)[order]
        self.beams: IndexArray = np.flatnonzero(taken)
        self.points: FloatArray = self._ends[self.beams]
        self.ranges: FloatArray = ranges[order][self.beams]

    def saw_through(self, points: FloatArray, margin: float) -> BoolArray:
        """Whether it saw farther than to a point, with a margin [m], in all beams beside it; shape (N,)."""
        return self._judge(points, margin) == _THROUGH

    def faces(self, points: FloatArray) -> BoolArray:
        """Whether a beam goes past points, or would if it went on; shape (N,)."""
        if len(self._bearings) == 0:
            return np.zeros(len(points), dtype=bool)
        x, y = (points - self.sensor).T
        bearings = (np.arctan2(y, x) - self._zero + 1e-9) % math.tau
        beside = 1.01 * self.spacing
        return (bearings <= self._bearings[-1] + beside) | (bearings >= math.tau - beside)

    def compare(self, points: FloatArray, margin: float) -> tuple[BoolArray, BoolArray]:
        """Whether it saw through points, and whether it saw a surface there, both within a margin [m]; shape (N,)."""
        seen = self._judge(points, margin)
        return seen == _THROUGH, seen == _THERE

    def _judge(self, points: FloatArray, margin: float) -> npt.NDArray[np.uint8]:
        x, y = self.sensor.tolist()
        points = np.ascontiguousarray(points)
        return compare_scan(
            self._bearings, self._through, self._ends, x, y, self._zero, self.spacing, points, margin, _BEAMS_ASIDE
        )

    def split(self) -> IndexArray:
        """Order the hits so that each thing is a run of them, and return where things begin, and their end.

        Things are apart where neighbouring hits have a gap: that of Borges and Aldon, Line Extraction in 2D Range
        Images for Mobile Robotics (2004), what a surface that the beams graze at 10 degrees leaves between two of them.
        """
        count = len(self.points)
        if count == 0:
            return np.zeros(1, dtype=np.intp)
        steps = self.points - self.points[np.arange(-1, count - 1)]
        allowed = self.ranges * (math.sin(self.spacing) / math.sin(max(_GRAZING_RAD - self.spacing, 0.05)))
        starts = np.flatnonzero(np.hypot(steps[:, 0], steps[:, 1]) > _LEAST_GAP_M + allowed)
        if len(starts) == 0:
            return np.array([0, count])
        if starts[0] > 0:  # the ends of a full turn are one thing
            order = np.roll(np.arange(count), -int(starts[0]))
            self.beams, self.points, self.ranges = self.beams[order], self.points[order], self.ranges[order]
        return np.append(starts - starts[0], count)

    def sees_past(self, hits: IndexArray, side: int) -> BoolArray:
        """Whether the beams on one side (−1 or 1) of some hits see farther: nothing hides what is there.

        What lies beyond the ends of the field of view is hidden.
        """
        beams = self.beams[hits]
        count = len(self.sight)
        beside = np.minimum(self.sight[(beams + side) % count], self.sight[(beams + 2 * side) % count])
        past = beside > self.ranges[hits] + _PAST_M
        if count * self.spacing < math.tau - 0.5 * self.spacing:
            past &= (beams + 2 * side >= 0) & (beams + 2 * side < count)
        return past


def _least_around(ranges: FloatArray, missing: BoolArray) -> FloatArray:
    """The least of each beam's range and those beside it, minus infinity where half of them are missing."""
    if len(ranges) == 0:
        return ranges
    holes = bool(missing.any())
    least = ranges = np.where(missing, np.inf, ranges) if holes else ranges
    around = np.concatenate([ranges[-_BEAMS_ASIDE:], ranges, ranges[:_BEAMS_ASIDE]])
    count = len(ranges)
    for shift in range(len(around) - count + 1):
        least = np.minimum(least, around[shift : shift + count])
    if not holes:
        return least
    gaps = sum(np.roll(missing, shift).astype(np.intp) for shift in range(-_BEAMS_ASIDE, _BEAMS_ASIDE + 1))
    return np.where(gaps > _BEAMS_ASIDE, -np.inf, least)


def _hits_body(scan: Scan, body: FloatArray) -> BoolArray:
    """Which beams end inside the robot, shape (beams,)."""
    inside = np.zeros(len(scan.ranges), dtype=bool)
    reach = float(np.hypot(body[:, 0] - scan.mount.x, body[:, 1] - scan.mount.y).max())
    near = np.flatnonzero((scan.ranges <= reach) & (scan.ranges >= 0.0))
    if len(near):
        angles, ranges = scan.angles[near] + scan.mount.yaw, scan.ranges[near]
        x, y = scan.mount.x + ranges * np.cos(angles), scan.mount.y + ranges * np.sin(angles)
        along = np.roll(body, -1, axis=0) - body
        sides = along[:, 0, None] * (y - body[:, 1, None]) - along[:, 1, None] * (x - body[:, 0, None])
        inside[near] = (sides >= 0.0).all(axis=0)
    return inside
