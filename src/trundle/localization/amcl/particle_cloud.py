"""`ParticleCloud`: the particles of the filter, which look for better poses round the tracks."""

from __future__ import annotations

import numpy as np

from trundle._core import move_particles, peak_particle, resample_particles, weigh_particles
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.localization.amcl.motion import LEAST, Motion
from trundle.localization.amcl.tracks import MOST_INFORMATIVE

_BINS = np.array((0.5, np.pi / 18.0))  # as in Nav2
_EXPLORERS = 0.1  # share of the particles that are drawn widely round the main track at each update
_EXPLORE = np.array((0.2, 0.1))  # [m, rad]: a slip of wheels
_NEAR_M, _NEAR_RAD = 0.3, 0.2  # of one cluster
_BEAMS = 30  # that weigh particles: scan matching makes the estimate accurate
_STANDING = np.zeros(3)


class ParticleCloud:
    """Particles (x, y, yaw) in the grid's frame, and their weights.

    Args:
        field: The map.
        settings: Of the localizer.

    Attributes:
        poses: Shape (N, 3).
        weights: Shape (N,); they sum to 1.
    """

    def __init__(self, field: MapField, settings: AmclSettings) -> None:
        self._field, self._settings = field, settings
        self._alphas = np.array((settings.alpha1, settings.alpha2, settings.alpha3, settings.alpha4))
        self._bound = np.array((settings.min_particles, settings.max_particles, settings.pf_err, settings.pf_z))
        self.seed(0)
        self.poses = np.zeros((0, 3))
        self.weights = np.zeros(0)

    def seed(self, seed: int) -> None:
        """Start the random numbers over."""
        self._rng = np.random.default_rng(seed)
        self._base = int(self._rng.integers(1 << 62))
        self._draws = 0

    def _next(self) -> int:
        self._draws += 1
        return self._base + 7919 * self._draws

    def spread(self, poses: list[Pose2D], covariances: list[FloatArray], shares: list[float]) -> None:
        """Draw new particles round poses, with their covariances and shares."""
        count = self._settings.min_particles if len(poses) == 1 else self._settings.max_particles
        parts = []
        for pose, covariance, share in zip(poses, covariances, shares, strict=True):
            drawn = self._rng.standard_normal((max(1, round(share * count)), 3))
            values, vectors = np.linalg.eigh(covariance)
            parts.append(drawn @ (vectors * np.sqrt(np.maximum(values, 0.0))).T + pose.as_tuple())
        self._take(np.concatenate(parts))

    def spread_everywhere(self, free: np.ndarray, resolution: float) -> None:
        """Draw the particles from all free cells, at any yaw."""
        count = self._settings.max_particles
        cells = np.flatnonzero(free)
        rows, cols = np.divmod(cells[self._rng.integers(0, len(cells), count)], free.shape[1])
        within = self._rng.random((count, 3))
        x, y = (cols + within[:, 0]) * resolution, (rows + within[:, 1]) * resolution
        self._take(np.column_stack([x, y, (2.0 * within[:, 2] - 1.0) * np.pi]))

    def _take(self, poses: FloatArray) -> None:
        self.poses = np.ascontiguousarray(poses)
        self.weights = np.full(len(poses), 1.0 / len(poses))

    def move(self, motion: Motion) -> None:
        """Move each particle as the odometry says, each with different noise."""
        self.poses = move_particles(self.poses, motion.numbers, self._alphas, LEAST, self._next())

    def weigh(self, beams: Beams) -> None:
        """Weigh the particles by a scan. Beams count as information of at most thirty together."""
        points = beams.points
        if len(points) > _BEAMS:
            points = np.ascontiguousarray(points[:: -(-len(points) // _BEAMS)])
        field = self._field
        logs = weigh_particles(field.log_weights, field.resolution, field.neutral_weight, self.poses, points)
        scale = min(1.0, MOST_INFORMATIVE / len(points))
        weights = np.exp(scale * (logs - logs.max()))
        self.weights = weights / weights.sum()

    def best(self) -> Pose2D:
        """Return the mean of the particles round the heaviest one."""
        return Pose2D(*peak_particle(self.poses, self.weights, _NEAR_M, _NEAR_RAD).tolist())

    def resample(self, around: Pose2D) -> None:
        """Draw as many particles as their spread needs, by weight; a share of them widely round a pose."""
        poses = resample_particles(self.poses, self.weights, _BINS, self._bound, self._next())
        count = int(_EXPLORERS * len(poses))
        if count:
            near = np.empty((count, 3))
            near[:] = around.as_tuple()
            poses[:: len(poses) // count][:count] = move_particles(
                near, _STANDING, self._alphas, _EXPLORE, self._next()
            )
        self._take(poses)
