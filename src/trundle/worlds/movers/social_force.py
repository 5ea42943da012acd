"""The social force model: Helbing and Molnár, Social Force Model for Pedestrian Dynamics, Phys. Rev. E 51 (1995)."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray

TAU_S = 0.5  # relaxation time
_SOCIAL, _SOCIAL_M = 2.1, 0.3  # V0 [m²/s²] and sigma
_BORDER, _BORDER_M = 10.0, 0.2  # U0 [m²/s²] and R
_STEP_S = 2.0  # of another's step, delta t
_SEEN = math.cos(math.radians(100.0))  # half of the angle of sight of 200°
_UNSEEN = 0.5  # c: share of a force from behind
_PEDESTRIAN_M = 0.3
"""Radius of the model's pedestrians; distances to what is wider are shortened by how much it is."""


def driving(velocities: FloatArray, directions: FloatArray, speeds: FloatArray) -> FloatArray:
    """Towards the preferred velocity (equation 2) [m/s²], shape (N, 2)."""
    return (speeds[:, None] * directions - velocities) / TAU_S


def repulsion(
    points: FloatArray,
    radii: FloatArray,
    directions: FloatArray,
    others: FloatArray,
    other_velocities: FloatArray,
    other_radii: FloatArray,
) -> FloatArray:
    """Away from others, by the elliptical potential that lies ahead of each (equations 3, 4 and 7).

    Args:
        points: Where they are [m], shape (N, 2).
        radii: [m], shape (N,).
        directions: Where they want to go, unit vectors, shape (N, 2).
        others: [m], shape (M, 2); one at the same point has no effect.
        other_velocities: [m/s], shape (M, 2).
        other_radii: [m], shape (M,).

    Returns:
        The forces of each on each [m/s²], shape (N, M, 2).
    """
    apart = points[:, None] - others
    distance = np.sqrt((apart**2).sum(axis=2))
    step = other_velocities * _STEP_S
    beyond = apart - step
    reached = np.sqrt((beyond**2).sum(axis=2))
    whole = distance + reached
    minor = np.sqrt(np.maximum(whole**2 - (step**2).sum(axis=1), 1e-6)) / 2.0
    wide = np.maximum(0.0, radii[:, None] + other_radii - 2.0 * _PEDESTRIAN_M)
    strength = _SOCIAL / _SOCIAL_M * np.exp(-np.maximum(0.0, minor - wide) / _SOCIAL_M)
    strength *= whole / (4.0 * minor)
    away = apart / np.maximum(distance, 1e-9)[..., None] + beyond / np.maximum(reached, 1e-9)[..., None]
    forces = np.minimum(strength, 1e3)[..., None] * away
    forces[distance < 1e-9] = 0.0
    # A force from behind counts less: the one who makes it is not seen.
    ahead = -(forces * directions[:, None]).sum(axis=2) >= _SEEN * np.sqrt((forces**2).sum(axis=2))
    return forces * np.where(ahead, 1.0, _UNSEEN)[..., None]


def border_force(distances: FloatArray, away: FloatArray, radii: FloatArray) -> FloatArray:
    """Away from the nearest solid (equation 5) [m/s²], shape (N, 2).

    Args:
        distances: To it [m], shape (N,).
        away: Directions from it, unit vectors, shape (N, 2).
        radii: [m], shape (N,).
    """
    gap = np.maximum(0.0, distances - (radii - _PEDESTRIAN_M))
    return (_BORDER / _BORDER_M * np.exp(-gap / _BORDER_M))[:, None] * away
