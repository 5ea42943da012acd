"""What a robot believes, as the page draws it: particles, ellipse, other places, the state, and its own map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.maps.cells import round_trinary
from trundle.observation import Estimate, pick_particles
from trundle.page.encoding import grid_png, pack_array, rounded

if TYPE_CHECKING:
    from trundle.mission.own_map import MapTrack

MOST_PARTICLES = 500
"""Particles that are drawn: more would overlap, and cost time in every frame."""

_MOST_PLACES = 40
_MOST_CM = 32_000
"""Particles are sent as 16-bit centimetres, relative to the estimate."""

_CHI2_95 = 5.991
"""95 % quantile of the chi-squared distribution with two degrees of freedom: of a position in the plane."""


def belief_of(estimate: Estimate, *, most_particles: int = MOST_PARTICLES) -> dict[str, Any]:
    """Return what the page draws of an estimate.

    Args:
        estimate: The estimate.
        most_particles: How many particles are kept; they are picked by their weights.

    Returns:
        "pose" [x, y, yaw]; "state"; "ellipse" [semi-axis, semi-axis, angle of the first] that holds 95 % of positions,
        None without a covariance; "places" [[x, y, yaw, weight]] of the hypotheses; "particles" [cm, cm, mrad],
        relative to the position, packed, None without any.
    """
    pose = estimate.pose
    particles = estimate.particles
    return {
        "pose": rounded(pose.as_tuple()),
        "state": estimate.state,
        "ellipse": None if estimate.covariance is None else ellipse_of(estimate.covariance),
        "places": [rounded((*one.pose.as_tuple(), one.weight), 3) for one in estimate.hypotheses[:_MOST_PLACES]],
        "particles": None if particles is None else _pack(pick_particles(particles, most_particles), pose.x, pose.y),
    }


def ellipse_of(covariance: FloatArray) -> list[float] | None:
    """Return the ellipse around a position that holds 95 % [m, m, rad]: both semi-axes, and the angle of the first.

    Args:
        covariance: Covariance of (x, y, yaw), shape (3, 3). None is returned where it has a number that is not finite.
    """
    if not np.isfinite(covariance).all():
        return None
    variances, axes = np.linalg.eigh(covariance[:2, :2])
    long, short = np.sqrt(_CHI2_95 * np.clip(variances[::-1], 0.0, 1e8)).tolist()
    return rounded((long, short, math.atan2(axes[1, 1], axes[0, 1])))


def _pack(particles: FloatArray, x: float, y: float) -> dict[str, Any]:
    sound = particles[np.isfinite(particles[:, :3]).all(axis=1)]
    scaled = np.c_[100.0 * (sound[:, :2] - (x, y)), 1000.0 * np.remainder(sound[:, 2] + math.pi, 2.0 * math.pi)]
    scaled[:, 2] -= 1000.0 * math.pi
    return pack_array(np.clip(np.rint(scaled), -_MOST_CM, _MOST_CM), "i2")


_MOST_POSES, _MOST_LOOPS = 20_000, 5_000
"""More would hide the map, and take longer to send than its picture."""


def own_map_of(grid: OccupancyGrid, track: MapTrack | None) -> dict[str, Any]:
    """Return a map as `grid_png` does, with occupied, free and unknown cells alone, and what it comes from.

    Args:
        grid: The map.
        track: Poses, loops and corrections; None where they are not known.

    Returns:
        As `grid_png`, and "poses" (N, 2) [m] and "loops" (M, 4) [m], both ends of each, packed; "corrections" [[x, y,
        metres]].
    """
    # Shares of beams differ from cell to cell, and would make the picture four times as large.
    plain = OccupancyGrid(round_trinary(grid.data), grid.resolution, grid.origin)
    shown: dict[str, Any] = {**grid_png(plain), "poses": None, "loops": None, "corrections": []}
    if track is None:
        return shown
    places = track.poses[:, :2]
    step = -(-len(places) // _MOST_POSES) or 1
    return shown | {
        "poses": pack_array(places[::step], "f4"),
        "loops": pack_array(places[track.loops[-_MOST_LOOPS:]].reshape(-1, 4), "f4"),
        "corrections": [rounded((one.x, one.y, one.moved_m), 3) for one in track.corrections],
    }
