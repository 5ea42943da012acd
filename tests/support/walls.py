"""Scans of walls and discs by formula, and the estimates that go with them."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import Pose2D
from trundle.observation import Estimate, Scan
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
BEAMS = 720
ANGLES = np.linspace(-math.pi, math.pi, BEAMS, endpoint=False)


class Surroundings:
    """Segments and discs in the map frame that a lidar sees.

    Args:
        segments: (x0, y0, x1, y1) [m].
        discs: (x, y, radius) [m].
        noise: Standard deviation of a range [m].
        reach: Of the lidar [m].
    """

    def __init__(self, segments=(), discs=(), *, noise=0.0, reach=12.0, seed=0):
        self.segments = np.array(segments, float).reshape(-1, 4)
        self.discs = list(discs)
        self.noise, self.reach = noise, reach
        self._rng = np.random.default_rng(seed)

    def ranges(self, sensor: Pose2D) -> np.ndarray:
        along = np.stack([np.cos(ANGLES + sensor.yaw), np.sin(ANGLES + sensor.yaw)], axis=1)
        nearest = np.full(BEAMS, np.inf)
        for x0, y0, x1, y1 in self.segments:
            a, edge = np.array([x0 - sensor.x, y0 - sensor.y]), np.array([x1 - x0, y1 - y0])
            across = along[:, 0] * edge[1] - along[:, 1] * edge[0]
            with np.errstate(divide="ignore", invalid="ignore"):
                distance = (a[0] * edge[1] - a[1] * edge[0]) / across
                share = (a[0] * along[:, 1] - a[1] * along[:, 0]) / across
            met = (distance > 0) & (share >= 0) & (share <= 1)
            nearest = np.where(met, np.minimum(nearest, distance), nearest)
        for x, y, radius in self.discs:
            middle = along @ np.array([x - sensor.x, y - sensor.y])
            root = middle**2 - ((x - sensor.x) ** 2 + (y - sensor.y) ** 2 - radius**2)
            distance = middle - np.sqrt(np.maximum(root, 0))
            nearest = np.where((root > 0) & (distance > 0), np.minimum(nearest, distance), nearest)
        hit = nearest <= self.reach
        return np.where(hit, nearest + self._rng.normal(0, self.noise, BEAMS) if self.noise else nearest, np.inf)

    def scan(self, time: float, robot: Pose2D, lidar: str = "front") -> Scan:
        of_robot = CARTER.lidars[lidar]
        mount = Pose2D(of_robot.x, of_robot.y, of_robot.yaw)
        return Scan(lidar, time, mount, of_robot.z, ANGLES, self.ranges(robot @ mount), 0.05, self.reach)


def make_scan(time: float, ranges, lidar: str = "front", mount: Pose2D | None = None, **options) -> Scan:
    """A scan whose beams are spread over a full turn."""
    ranges = np.asarray(ranges, float)
    angles = np.linspace(-math.pi, math.pi, len(ranges), endpoint=False)
    return Scan(lidar, time, mount or Pose2D(0, 0), 0.4, angles, ranges, 0.05, 12.0, **options)


def estimate(time: float, pose: Pose2D, T_map_odom: Pose2D | None = None) -> Estimate:
    """An estimate of a pose in the map frame."""
    return Estimate(time, pose, None, T_map_odom or Pose2D(0, 0))
