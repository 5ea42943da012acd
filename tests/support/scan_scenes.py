"""Scans of scenes of discs and line segments, computed beam by beam."""

import math

import numpy as np

from trundle.geometry import Pose2D
from trundle.observation import Scan


def scan_scene(
    discs=(),
    segments=(),
    *,
    base=(0.0, 0.0, 0.0),
    mount=(0.0, 0.0, 0.0),
    time=0.0,
    name="front",
    beams=720,
    reach=15.0,
    fov=2.0 * math.pi,
    noise=0.0,
    seed=0,
):
    """What a lidar sees of discs (x, y, radius) and segments (x0, y0, x1, y1) in the odom frame."""
    sensor = Pose2D(*base) @ Pose2D(*mount)
    x, y, yaw = sensor.as_tuple()
    angles = np.linspace(-fov / 2.0, fov / 2.0, beams, endpoint=False)
    dx, dy = np.cos(angles + yaw), np.sin(angles + yaw)
    ranges = np.full(beams, np.inf)
    for cx, cy, radius in discs:
        along = (cx - x) * dx + (cy - y) * dy
        aside = (cx - x) ** 2 + (cy - y) ** 2 - along**2
        hit = (aside < radius**2) & (along > 0.0)
        ranges = np.where(hit, np.minimum(ranges, along - np.sqrt(np.maximum(radius**2 - aside, 0.0))), ranges)
    for x0, y0, x1, y1 in segments:
        ex, ey = x1 - x0, y1 - y0
        det = dx * ey - dy * ex
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            along = ((x0 - x) * ey - (y0 - y) * ex) / det
            share = ((x0 - x) * dy - (y0 - y) * dx) / det
        hit = (np.abs(det) > 1e-12) & (along > 0.0) & (share >= 0.0) & (share <= 1.0)
        ranges = np.where(hit, np.minimum(ranges, along), ranges)
    if noise:
        rng = np.random.default_rng([seed, round(time * 1000)])
        ranges = np.abs(ranges + rng.normal(0.0, noise, beams))
    ranges = np.where(ranges <= reach, ranges, np.inf)
    return Scan(name, time, Pose2D(*mount), 0.4, angles, ranges, 0.0, reach)
