"""Two rooms with things in them, exact scans of them, and a drive round them with odometry that drifts."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from trundle import Observation, Pose2D, Scan, Twist2D

ANGLES = np.linspace(-math.pi, math.pi, 360, endpoint=False)
SEGMENTS = np.array(
    [
        (0, 0, 20, 0), (20, 0, 20, 12), (20, 12, 0, 12), (0, 12, 0, 0),
        (8, 4, 12, 4), (12, 4, 12, 8), (12, 8, 8, 8), (8, 8, 8, 4),
        (3, 3.2, 4, 3), (4, 3, 4.4, 2.2), (16, 8.6, 17, 10), (17, 10, 16.2, 10.4), (13, 10.5, 13.6, 12), (0, 7, 1.2, 7.4),
        (20, 4, 18.8, 4.6), (10, 0, 10.3, 1.1),
    ],
    dtype=np.float64,
)  # fmt: skip
MIDDLE = (10.0, 6.0)


def cast(pose: Pose2D, rng: np.random.Generator | None = None, segments: np.ndarray = SEGMENTS) -> np.ndarray:
    """Ranges from a pose."""
    angles = ANGLES + pose.yaw
    direction = np.column_stack((np.cos(angles), np.sin(angles)))[:, None, :]
    start, along = segments[None, :, :2], (segments[:, 2:] - segments[:, :2])[None]
    gap = start - (pose.x, pose.y)
    cross = direction[..., 0] * along[..., 1] - direction[..., 1] * along[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (gap[..., 0] * along[..., 1] - gap[..., 1] * along[..., 0]) / cross
        share = (gap[..., 0] * direction[..., 1] - gap[..., 1] * direction[..., 0]) / cross
    ranges = np.where((far > 0) & (share >= 0) & (share <= 1), far, np.inf).min(axis=1)
    return ranges if rng is None else ranges + rng.normal(0.0, 0.01, len(ranges))


def ring(share: float) -> Pose2D:
    """A pose on the way round the block in the middle; once round is a share of 1."""
    corners = np.array([(5.0, 2.0), (15.0, 2.0), (15.0, 10.0), (5.0, 10.0), (5.0, 2.0)])
    lengths = np.cumsum([0.0, *np.hypot(*np.diff(corners, axis=0).T)])
    at = (share % 1.0) * lengths[-1]
    side = min(3, int(np.searchsorted(lengths, at, side="right")) - 1)
    part = (at - lengths[side]) / (lengths[side + 1] - lengths[side])
    x, y = corners[side] + part * (corners[side + 1] - corners[side])
    left = lengths[side + 1] - at
    yaw = side * math.pi / 2 + max(0.0, 1.0 - left) * math.pi / 2
    return Pose2D(float(x), float(y), yaw)


def drive(
    poses: list[Pose2D], *, drift: float = 0.03, bend: float = 0.03, seed: int = 0, begin_s: float = 0.0
) -> Iterator[tuple[Pose2D, Observation]]:
    """Observations along poses, each with the truth; the odometry is off by a share and by radians per metre."""
    rng = np.random.default_rng(seed)
    odometry, last = Pose2D(0.0, 0.0), poses[0]
    for i, pose in enumerate(poses):
        step = last.inverse() @ pose
        odometry = odometry @ Pose2D(
            (1.0 + drift) * step.x, (1.0 + drift) * step.y, step.yaw + bend * math.hypot(step.x, step.y)
        )
        last = pose
        time = begin_s + 0.5 * i
        scan = Scan("lidar", time, Pose2D(0.0, 0.0), 0.3, ANGLES, cast(pose, rng), 0.1, 30.0)
        yield pose, Observation(time, Twist2D(0.0, 0.0), odometry, (scan,))
