"""A stand-in for a mapper: it takes odometry for the truth, and draws its map by marking scans in a layer."""

import numpy as np

from trundle.costmap.layers import ObstacleLayer
from trundle.costmap.layers.layer import MapPart
from trundle.geometry import Pose2D
from trundle.localization import Localizer
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate

EDGE = 0.05


class MarkingLocalizer(Localizer):
    """Believes its odometry, and makes a map. `jump` shifts the estimate and the map, as a closed loop does."""

    def __init__(self, robot):
        self._robot = robot
        self.finished = 0
        self.reset(Pose2D(0.0, 0.0))

    def reset(self, pose, *, covariance=None, seed=0):
        self._start, self._map_odom = pose, None
        self._shift = Pose2D(0.0, 0.0)
        self._layer = ObstacleLayer(self._robot)
        self._low, self._high = np.array([np.inf] * 2), np.array([-np.inf] * 2)
        self._revision = 0

    @property
    def corrections(self):
        return self._revision

    def jump(self, dx, dy):
        """Move estimate and map from now on."""
        self._shift = Pose2D(dx, dy) @ self._shift
        self._revision += 1

    def update(self, observation):
        if self._map_odom is None:
            self._map_odom = self._start @ observation.odometry.inverse()
        seen = Estimate(observation.time, self._map_odom @ observation.odometry, None, self._map_odom)
        self._layer.update(observation.scans, seen)
        for scan in observation.scans:
            points = seen.pose.transform_points(scan.points())
            self._low = np.minimum(self._low, points.min(axis=0, initial=np.inf))
            self._high = np.maximum(self._high, points.max(axis=0, initial=-np.inf))
        moved = self._shift @ self._map_odom
        return Estimate(observation.time, moved @ observation.odometry, None, moved)

    def map(self):
        if not np.isfinite(self._low).all():
            return None
        col, row = (np.floor(self._low / EDGE).astype(int) - 2).tolist()
        col_end, row_end = (np.ceil(self._high / EDGE).astype(int) + 2).tolist()
        cells = np.full((row_end - row, col_end - col), -1, np.int8)
        corner = Pose2D(col * EDGE, row * EDGE)
        self._layer.paint(MapPart(cells, np.zeros(cells.shape, np.uint8), EDGE, corner))
        x, y = self._shift.x + corner.x, self._shift.y + corner.y
        return OccupancyGrid(cells, EDGE, Pose2D(x, y))

    def finish(self):
        self.finished += 1
