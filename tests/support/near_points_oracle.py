"""Points near a robot, and their distances from its outline, in NumPy."""

import math

import numpy as np


def points_around(points, velocities, pose, seconds, reach, horizon):
    """As the kernel of that name."""
    moved = velocities if len(velocities) else np.zeros_like(points)
    apart = points - pose[:2] + seconds * moved
    near = np.hypot(*apart.T) <= reach + horizon * np.hypot(*moved.T)
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    rotation = np.array([[cos, -sin], [sin, cos]])
    return apart[near] @ rotation, moved[near] @ rotation


def outline_clearances(points, velocities, poses, times, outline, sides, padding, rank):
    """As the kernel of that name."""
    found = np.full(len(poses), math.inf)
    turns = np.array([[(math.cos(yaw), -math.sin(yaw)), (math.sin(yaw), math.cos(yaw))] for yaw in poses[:, 2]])
    corners = (outline @ turns.transpose(0, 2, 1) + poses[:, np.newaxis, :2]).reshape(-1, 2)
    low, high = corners.min(axis=0) - padding, corners.max(axis=0) + padding
    kept = ((points >= low) & (points <= high)).all(axis=1) | (velocities != 0.0).any(axis=1)
    for index, (pose, turn) in enumerate(zip(poses, turns, strict=True)):
        at = points[kept] + (times[index] if len(times) else 0.0) * velocities[kept]
        distances = ((at - pose[:2]) @ turn @ sides[:, :2].T - sides[:, 2]).max(axis=1)
        if len(distances) >= rank:
            found[index] = np.sort(distances)[rank - 1]
    return found
