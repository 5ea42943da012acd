"""A localizer for tests of what is shown: it has particles and hypotheses, and says what it is told to say."""

import numpy as np

from trundle import Pose2D
from trundle.observation import Estimate, Hypothesis

COVARIANCE = np.array([[0.04, 0.01, 0.0], [0.01, 0.02, 0.0], [0.0, 0.0, 0.03]])


class DoubtfulLocalizer:
    """Follows the odometry from where it is put; ambiguous for two seconds after that, lost for one, then localized.

    Attributes:
        covariance: What it was told of the last pose.
        searches: How often it was told to search.
    """

    def __init__(self, count=600, shift=0.1):
        self.count, self.shift = count, shift
        self.covariance, self.searches = None, 0
        self._pose, self._anchor, self._began = Pose2D(0.0, 0.0), None, None

    def reset(self, pose, *, covariance=None, seed=0):
        self._pose = Pose2D(0.0, 0.0) if pose is None else pose
        self._anchor = self._began = None
        self.covariance = covariance
        self._random = np.random.default_rng(seed)

    def reinitialize_global(self):
        self.searches += 1
        self._began = None

    def update(self, observation):
        if self._anchor is None:
            self._anchor = self._pose @ observation.odometry.inverse()
        if self._began is None:
            self._began = observation.time
        at = self._anchor @ observation.odometry
        at = Pose2D(at.x + self.shift, at.y, at.yaw)
        T_map_odom = at @ observation.odometry.inverse()
        passed = observation.time - self._began
        particles = np.empty((self.count, 4))
        particles[:, :3] = self._random.multivariate_normal(at.as_tuple(), COVARIANCE, self.count)
        particles[:, 3] = 1.0 / self.count
        particles.flags.writeable = False
        if passed < 2.0:
            places = (at, Pose2D(at.x, at.y + 2.0, at.yaw + 1.5), Pose2D(at.x + 3.0, at.y + 1.0, at.yaw - 1.5))
            hypotheses = tuple(
                Hypothesis(place, weight, COVARIANCE) for place, weight in zip(places, (0.5, 0.3, 0.2), strict=True)
            )
            state = "ambiguous"
        else:
            hypotheses, state = (Hypothesis(at, 1.0, COVARIANCE),), "lost" if passed < 3.0 else "localized"
        return Estimate(observation.time, at, COVARIANCE, T_map_odom, state, hypotheses, particles)
