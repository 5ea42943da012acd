"""Curves through points with times: straight from one to the next, or Catmull-Rom splines."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np

from trundle.geometry import FloatArray

Interpolation: TypeAlias = Literal["linear", "catmull_rom"]


class Curve:
    """A curve through points at times; before the first it stays there, and after the last, too.

    A Catmull-Rom spline (Catmull and Rom, A Class of Local Interpolating Splines, 1974) as cubic Hermite pieces: the
    velocity at a point is that from the one before to the one after. At the ends of an open curve it is that of the
    only piece there; a closed one goes on as it began.

    Args:
        times: [s], ascending.
        points: Shape (N, D).
        interpolation: Between the points.
        closed: Whether the last point is the first again, and the spline is smooth there.
    """

    def __init__(
        self, times: Sequence[float], points: FloatArray, interpolation: Interpolation, *, closed: bool
    ) -> None:
        self._times = [float(time) for time in times]
        self._points: list[list[float]] = points.tolist()
        self._slopes: list[list[float]] | None = None
        if interpolation == "catmull_rom" and len(points) > 2:
            self._slopes = _slopes(np.asarray(times, dtype=np.float64), points, closed=closed).tolist()

    def at(self, time: float) -> tuple[list[float], list[float]]:
        """Position and velocity at a time [s]."""
        times, points = self._times, self._points
        if time < times[0] or len(times) == 1:
            return points[0], [0.0] * len(points[0])
        if time >= times[-1]:
            return points[-1], [0.0] * len(points[0])
        index = bisect.bisect_right(times, time) - 1
        span = times[index + 1] - times[index]
        s = (time - times[index]) / span
        first, last = points[index], points[index + 1]
        if self._slopes is None:
            place = [a + s * (b - a) for a, b in zip(first, last, strict=True)]
            return place, [(b - a) / span for a, b in zip(first, last, strict=True)]
        starting, ending = self._slopes[index], self._slopes[index + 1]
        s2, s3 = s * s, s * s * s
        place, velocity = [], []
        for a, b, m, n in zip(first, last, starting, ending, strict=True):
            place.append(
                (2.0 * s3 - 3.0 * s2 + 1.0) * a
                + (s3 - 2.0 * s2 + s) * span * m
                + (3.0 * s2 - 2.0 * s3) * b
                + (s3 - s2) * span * n
            )
            velocity.append(6.0 * (s2 - s) * (a - b) / span + (3.0 * s2 - 4.0 * s + 1.0) * m + (3.0 * s2 - 2.0 * s) * n)
        return place, velocity


def _slopes(times: FloatArray, points: FloatArray, *, closed: bool) -> FloatArray:
    """Velocities of a Catmull-Rom spline at its points, shape (N, D)."""
    slopes = np.empty_like(points)
    slopes[1:-1] = (points[2:] - points[:-2]) / (times[2:] - times[:-2])[:, None]
    if closed:
        span = (times[1] - times[0]) + (times[-1] - times[-2])
        slopes[0] = slopes[-1] = (points[1] - points[-2]) / span
    else:
        slopes[0] = (points[1] - points[0]) / (times[1] - times[0])
        slopes[-1] = (points[-1] - points[-2]) / (times[-1] - times[-2])
    return slopes
