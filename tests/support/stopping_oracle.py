"""How a robot drives a command and then brakes, step by step."""

import math

from trundle.geometry import integrate_twist


def stopping_poses(
    x, y, yaw, v, w, goal_v, goal_w, forward, reverse, turning, acceleration, angular_acceleration, dt, turn_step
):
    """As the kernel of that name."""
    goal_v, goal_w = min(forward, max(-reverse, goal_v)), min(turning, max(-turning, goal_w))
    v, w = (max(-1e6, min(1e6, speed)) for speed in (v, w))
    longest = max(dt, (abs(v) + abs(goal_v)) / acceleration, (abs(w) + abs(goal_w)) / angular_acceleration)
    substep, driven, poses = max(0.05, longest / 1000), 0.0, [(x, y, yaw)]
    for _ in range(2000):
        step = substep if driven >= dt else min(substep, dt - driven)
        change_v = min(acceleration * step, max(-acceleration * step, goal_v - v))
        change_w = min(angular_acceleration * step, max(-angular_acceleration * step, goal_w - w))
        mean_v, mean_w = v + 0.5 * change_v, w + 0.5 * change_w
        parts = max(1, math.ceil(min(abs(mean_w) * step / turn_step, 180)))
        for _ in range(parts):
            poses.append(integrate_twist(*poses[-1], mean_v, mean_w, step / parts))
        v, w, driven = v + change_v, w + change_w, driven + step
        if driven >= dt - 1e-12:
            if abs(v) < 1e-9 and abs(w) < 1e-9:
                break
            goal_v = goal_w = 0.0
    return poses
