"""One robot of a batch in plain Python: the same model, a robot at a time, with the C library's sine and cosine."""

from __future__ import annotations

import math
from typing import Any


def drive(pose: Any, motion: Any, command: Any, limits: Any, substeps: int) -> tuple[list[float], list[float]]:
    """The pose and the motion (ramp v, ramp w, v, w, left, right) after some substeps."""
    forward, reverse, turning, linear, angular, radius, track, most, dt = limits
    x, y, yaw = pose
    ramp_v, ramp_w, v, w, left, right = motion
    to_v, to_w = min(forward, max(-reverse, command[0])), min(turning, max(-turning, command[1]))
    for _ in range(substeps):
        if (ramp_v, ramp_w) != (to_v, to_w):
            ramp_v += min(linear, max(-linear, to_v - ramp_v))
            ramp_w += min(angular, max(-angular, to_w - ramp_w))
            left, right = (min(most, max(-most, (ramp_v + side * ramp_w * track / 2) / radius)) for side in (-1, 1))
            v, w = radius * (left + right) / 2, radius * (right - left) / track
        turn = w * dt
        # The chord of an arc, at half of its turn.
        chord = v * dt * (math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0)
        x, y, yaw = x + chord * math.cos(yaw + turn / 2), y + chord * math.sin(yaw + turn / 2), yaw + turn
    return [x, y, yaw], [ramp_v, ramp_w, v, w, left, right]
