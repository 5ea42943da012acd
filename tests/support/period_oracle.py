"""An ideal robot's control period, step by step in Python."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, arc_shares


def drive_period(
    state: FloatArray, v: float, w: float, limits: FloatArray, steps: int
) -> tuple[FloatArray, tuple[float, float, float, float], bool]:
    """As the kernel."""
    forward, reverse, turning, linear, angular, radius, track, most, timestep = limits.tolist()
    x, y, yaw, left, right, ramp_v, ramp_w, now_v, now_w, left_speed, right_speed = state.tolist()
    target_v, target_w = min(forward, max(-reverse, v)), min(turning, max(-turning, w))
    is_cut = (target_v, target_w) != (v, w)
    rows = []
    for _ in range(steps):
        if (ramp_v, ramp_w) != (target_v, target_w):
            ramp_v += min(linear, max(-linear, target_v - ramp_v))
            ramp_w += min(angular, max(-angular, target_w - ramp_w))
            now_v, now_w, across = ramp_v, ramp_w, ramp_w * track / 2.0
            left_speed, right_speed = (now_v - across) / radius, (now_v + across) / radius
            if abs(left_speed) > most or abs(right_speed) > most:
                is_cut = True
                left_speed, right_speed = min(most, max(-most, left_speed)), min(most, max(-most, right_speed))
                now_v, now_w = radius * (left_speed + right_speed) / 2.0, radius * (right_speed - left_speed) / track
        length, (along, aside) = now_v * timestep, arc_shares(now_w * timestep)
        cos, sin = math.cos(yaw), math.sin(yaw)
        x += length * (cos * along - sin * aside)
        y += length * (sin * along + cos * aside)
        yaw += now_w * timestep
        left += left_speed * timestep
        right += right_speed * timestep
        rows.append((x, y, yaw, left, right, ramp_v, ramp_w, now_v, now_w, left_speed, right_speed))
    driven = np.array(rows)
    bounds = driven[:, 0].min(), driven[:, 0].max(), driven[:, 1].min(), driven[:, 1].max()
    return driven, bounds, is_cut
