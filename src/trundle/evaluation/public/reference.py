"""BARN's reference paths, and the score of a run against one.

Perille et al., Benchmarking Metric Ground Navigation, SSRR 2020; the score is that of the BARN Challenge (run.py of
Daffan/the-barn-challenge, as of 2026).
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import numpy as np

from trundle.errors import InputError
from trundle.files.opening import describe_unreadable, open_file, parser_reason
from trundle.geometry import FloatArray, Goal, Pose2D, path_length
from trundle.robots.parts import Limits

_CELL = 0.15  # edge of a cell [m]
_CORNER = (-4.575, 5.075)  # centre of cell (0, 0) [m]
_MOST_CELLS = 100_000
_SPEED = 2.0
"""The score's optimal time is the path's length over this speed [m/s], whatever the robot's limit is."""

_FASTEST, _SLOWEST = 2.0, 8.0
"""Bounds of a run's time, in optimal times: a shorter or longer run counts as if it took so long."""


@dataclass(frozen=True, slots=True, eq=False)
class ReferencePath:
    """A path through one of BARN's worlds, which the length of a run is measured against.

    Attributes:
        points: Its corners [m], map frame, shape (N, 2), N ≥ 2.
    """

    points: FloatArray

    def between(self, start: Pose2D, goal: Goal) -> ReferencePath:
        """Return the path with the ends of a mission added, as BARN measures it."""
        return ReferencePath(np.vstack([(start.x, start.y), self.points, goal[:2]]))

    @property
    def length(self) -> float:
        """Its length [m]."""
        return path_length(self.points)

    def score(self, time_s: float) -> float:
        """BARN's score of a run that arrived after this time [s]: at most 0.5, at least 0.125."""
        best = self.length / _SPEED
        return best / min(max(time_s, _FASTEST * best), _SLOWEST * best)

    def shortest_time(self, limits: Limits, arrival_radius: float) -> float:
        """Return the shortest time [s] along the path from rest, by the limits of speed and acceleration.

        The turns cost nothing in it. A run may be faster where it cuts the corners of the path's cells.

        Args:
            limits: Limits of the robot.
            arrival_radius: The run ends, at any speed, where the path comes this close to its end [m].
        """
        distance = self._length_to_within(arrival_radius)
        speed, acceleration = limits.linear_speed, limits.linear_acceleration
        ramp = speed * speed / (2.0 * acceleration)
        if distance <= ramp:
            return math.sqrt(2.0 * distance / acceleration)
        return speed / acceleration + (distance - ramp) / speed

    def _length_to_within(self, radius: float) -> float:
        """Return the length [m] up to where the path first comes within a distance of its end."""
        driven, end = 0.0, self.points[-1]
        for first, last in zip(self.points[:-1], self.points[1:], strict=True):
            step, off = last - first, first - end
            # |off + s step| = radius for the smallest s of 0 to 1
            a, b, c = float(step @ step), 2.0 * float(off @ step), float(off @ off) - radius * radius
            if c <= 0.0:
                return driven
            inside = b * b - 4.0 * a * c
            if a > 0.0 and inside >= 0.0:
                s = (-b - math.sqrt(inside)) / (2.0 * a)
                if 0.0 <= s <= 1.0:
                    return driven + s * math.sqrt(a)
            driven += math.sqrt(a)
        return driven


def load_reference(path: str | os.PathLike[str]) -> ReferencePath:
    """Read `path_N.npy`: the cells of a path, integers of shape (N, 2).

    Raises:
        InputError: If it cannot be read, or is no such path.
    """
    try:
        with open_file(path) as stream:
            cells = np.lib.format.read_array(stream, allow_pickle=False)
    except OSError as error:
        raise InputError(describe_unreadable(path, error)) from error
    except Exception as error:  # numpy raises any exception on a damaged file
        raise InputError(f"{path}: no path of BARN's, a .npy file of cells: {parser_reason(error)}") from error
    if cells.ndim != 2 or cells.shape[1] != 2 or not 2 <= len(cells) <= _MOST_CELLS or cells.dtype.kind not in "iuf":
        raise InputError(
            f"{path}: a path of BARN's is the cells (a, b) on it, numbers of shape (N, 2); this is {cells.dtype} of "
            f"shape {cells.shape}"
        )
    points = cells.astype(np.float64) * _CELL + _CORNER
    if not np.isfinite(points).all():
        raise InputError(f"{path}: a cell of the path is not finite")
    return ReferencePath(points)
