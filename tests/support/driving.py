"""Where pieces of a drive lead, each along its exact arc."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np


def drive(pose: Any, pieces: Iterable[Any]) -> tuple[Any, Any, Any]:
    """Where (length, curvature) pieces lead from (x, y, yaw), numbers or arrays."""
    x, y, yaw = pose
    for length, curvature in pieces:
        turn = length * curvature
        # A straight line is the limit of an arc; sinc and its like keep it exact.
        along = length * np.sinc(turn / np.pi)
        across = length * np.sin(turn / 2) * np.sinc(turn / 2 / np.pi)
        x = x + np.cos(yaw) * along - np.sin(yaw) * across
        y = y + np.sin(yaw) * along + np.cos(yaw) * across
        yaw = yaw + turn
    return x, y, yaw


def off_by(reached: Any, wanted: Any) -> Any:
    """The largest difference in x, y and yaw, the last one modulo a turn."""
    x, y, yaw = reached
    turn = np.remainder(yaw - wanted[2] + np.pi, 2 * np.pi) - np.pi
    return np.maximum(np.maximum(np.abs(x - wanted[0]), np.abs(y - wanted[1])), np.abs(turn))
