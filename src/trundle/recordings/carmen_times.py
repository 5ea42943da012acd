"""Times of logs that lost theirs: rounded to six digits, equal, or going back."""

from __future__ import annotations

import numpy as np

from trundle.geometry import FloatArray, wrap_angles

_SLOW_MPS, _SLOW_RADPS = 0.4, 0.6  # how fast robots of such logs usually drive
_LEAST_S = 0.1
_BROKEN_SHARE = 0.2
_LONGEST_S = 3600.0  # between two scans; a longer one is a rounded clock


def mend_times(times: FloatArray, poses: FloatArray) -> tuple[FloatArray, int]:
    """Return times that increase, and how many steps between two of them were estimated.

    The order of the lines counts. A step that does not lead forward takes as long as the motion at a usual speed; if
    more than a fifth of all steps are so, all of them are estimated.

    Args:
        times: Times of the lines [s], shape (N,).
        poses: (x, y, yaw) [m, rad] of the robot, shape (N, 3).
    """
    steps = np.diff(times)
    drove = np.hypot(np.diff(poses[:, 0]), np.diff(poses[:, 1])) / _SLOW_MPS
    turned = np.abs(wrap_angles(np.diff(poses[:, 2]))) / _SLOW_RADPS
    likely = np.maximum(np.maximum(drove, turned), _LEAST_S)
    bad = ~((steps > 0.0) & (steps < _LONGEST_S))
    if len(bad) and bad.mean() > _BROKEN_SHARE:
        bad[:] = True
    steps = np.where(bad, likely, steps)
    return np.concatenate([[times[0]], times[0] + np.cumsum(steps)]), int(bad.sum())
