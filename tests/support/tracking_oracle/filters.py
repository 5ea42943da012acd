"""`Filters`: Kalman filters of constant velocity for many discs at once, each corrected by points of its rim."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

IndexArray = npt.NDArray[np.intp]

_START_SPEED = 1.0  # standard deviation of the velocity of something new [m/s]
_START_M = 0.1
_RIM_M = 0.03  # of a point from the disc that stands for any shape: standard deviation
_MOST_POINTS = 12.0  # the errors of neighbouring points are alike: more points tell no more than these
_ROUNDS = 2
_DRIFT_SHARE, _DRIFTING, _TURNING = 0.3, 1.0, 30.0


class Filters:
    """States (x, y, vx, vy) with covariances, and radii; all of shape (K, …).

    Args:
        acceleration: How much a velocity may change in a second, one standard deviation [m/s²].

    Attributes:
        states: shape (K, 4).
        covariances: shape (K, 4, 4).
        radii: [m], shape (K,).
    """

    def __init__(self, acceleration: float) -> None:
        self._density = acceleration * acceleration
        self.states: FloatArray = np.zeros((0, 4))
        self.covariances: FloatArray = np.zeros((0, 4, 4))
        self.radii: FloatArray = np.zeros(0)
        self._drifts: FloatArray = np.zeros((0, 2))

    def __len__(self) -> int:
        return len(self.radii)

    def add(self, centres: FloatArray, radii: FloatArray) -> None:
        """Begin with discs of unknown velocity: centres of shape (N, 2), radii of shape (N,)."""
        count = len(radii)
        start = np.diag([_START_M**2, _START_M**2, _START_SPEED**2, _START_SPEED**2])
        self.states = np.concatenate([self.states, np.column_stack([centres, np.zeros((count, 2))])])
        self.covariances = np.concatenate([self.covariances, np.broadcast_to(start, (count, 4, 4))])
        self.radii = np.concatenate([self.radii, radii])
        self._drifts = np.concatenate([self._drifts, np.zeros((count, 2))])

    def keep(self, kept: npt.NDArray[np.bool_]) -> None:
        """Forget all others; shape (K,)."""
        self.states, self.covariances, self.radii = self.states[kept], self.covariances[kept], self.radii[kept]
        self._drifts = self._drifts[kept]

    def predicted(self, seconds: float) -> Filters:
        """A copy that has gone on at constant velocity."""
        copy = Filters(math.sqrt(self._density))
        copy.states, copy.covariances, copy.radii = self.states.copy(), self.covariances.copy(), self.radii
        copy._drifts = self._drifts
        copy.predict(seconds)
        return copy

    def predict(self, seconds: float) -> None:
        """Go on at constant velocity."""
        if seconds <= 0.0 or len(self.radii) == 0:
            return
        self.states[:, :2] += seconds * self.states[:, 2:]
        cov = self.covariances
        cross = cov[:, :2, 2:]
        cov[:, :2, :2] += seconds * (cross + cross.transpose(0, 2, 1)) + seconds**2 * cov[:, 2:, 2:]
        cov[:, :2, 2:] += seconds * cov[:, 2:, 2:]
        drifts = np.hypot(self._drifts[:, 0], self._drifts[:, 1])
        densities = self._density * (1.0 + _TURNING * np.clip(drifts - _DRIFTING, 0.0, 1.0))
        for axis in (0, 1):
            cov[:, axis, axis] += densities * (seconds**3 / 3.0)
            cov[:, axis, axis + 2] += densities * (seconds**2 / 2.0)
            cov[:, axis + 2, axis + 2] += densities * seconds
        cov[:, 2:, :2] = cov[:, :2, 2:].transpose(0, 2, 1)

    def correct(self, points: FloatArray, owners: IndexArray) -> IndexArray:
        """Correct by points of rims: an iterated extended filter, in which each point is one radius from the centre.

        Args:
            points: [m], shape (N, 2).
            owners: The disc that each belongs to, shape (N,).

        Returns:
            Number of points of each disc, shape (K,).
        """
        count = len(self.radii)
        counts: IndexArray = np.bincount(owners, minlength=count)
        weight = np.minimum(1.0, _MOST_POINTS / np.maximum(counts, 1)) / _RIM_M**2
        before, cov = self.states[:, :2].copy(), self.covariances
        centres = before.copy()
        share, change = np.zeros((count, 4, 2)), np.zeros((count, 4))
        info = np.zeros((count, 2, 2))
        for _ in range(_ROUNDS):
            offset = points - centres[owners]
            distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1e-6)
            x, y = offset[:, 0] / distance, offset[:, 1] / distance
            beyond = distance - self.radii[owners]
            sums = [
                np.bincount(owners, values, minlength=count) for values in (x * x, x * y, y * y, x * beyond, y * beyond)
            ]
            info[:, 0, 0], info[:, 0, 1], info[:, 1, 1] = sums[0] * weight, sums[1] * weight, sums[2] * weight
            info[:, 1, 0] = info[:, 0, 1]
            pull = np.column_stack(sums[3:]) * weight[:, None] + _times(info, centres - before)
            share = cov[:, :, :2] @ _inverse(np.eye(2) + info @ cov[:, :2, :2])
            change = _times(share, pull)
            centres = before + change[:, :2]
        self.states += change
        variance = cov[:, (0, 1), (0, 1)]
        cov -= share @ info @ cov[:, :2, :]
        self.covariances = 0.5 * (cov + cov.transpose(0, 2, 1))
        # Corrections of one sign, scan after scan: it speeds up or turns.
        expected = np.sqrt(np.maximum(variance - self.covariances[:, (0, 1), (0, 1)], 1e-9))
        seen = counts > 0
        self._drifts[seen] += _DRIFT_SHARE * (change[seen, :2] / expected[seen] - self._drifts[seen])
        return counts

    def resize(self, which: IndexArray, radii: FloatArray, sensor: FloatArray) -> None:
        """Change radii [m]; the side of each that faces a sensor at (x, y) stays where it is."""
        offset = self.states[which, :2] - sensor
        distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1e-6)
        grown = radii - self.radii[which]
        self.states[which, :2] += offset * (grown / distance)[:, None]
        self.radii[which] = radii

    def speed_deviations(self) -> FloatArray:
        """Standard deviation of each velocity in its own direction [m/s], shape (K,)."""
        velocities = self.states[:, 2:]
        speed = np.maximum(np.hypot(velocities[:, 0], velocities[:, 1]), 1e-9)
        along = velocities / speed[:, None]
        variance = (along * _times(self.covariances[:, 2:, 2:], along)).sum(axis=1)
        return np.sqrt(np.maximum(variance, 0.0))


def _times(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    return (matrices @ vectors[:, :, None])[:, :, 0]


def _inverse(matrices: FloatArray) -> FloatArray:
    """Of 2 × 2 matrices with a positive determinant."""
    a, b, c, d = matrices[:, 0, 0], matrices[:, 0, 1], matrices[:, 1, 0], matrices[:, 1, 1]
    inverse = np.empty_like(matrices)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 1, 0], inverse[:, 1, 1] = d, -b, -c, a
    return inverse / (a * d - b * c)[:, None, None]
