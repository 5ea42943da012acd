"""What is around the robot at one step, and what it believes: scans, movers, tracks, particles, its map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.cells import round_trinary
from trundle.mission.observers import Step
from trundle.navigation import NavigationStatus
from trundle.observation import Estimate, Scan, pick_particles
from trundle.page.encoding import grid_png, pack_array, rounded

if TYPE_CHECKING:
    from trundle.mission.own_map import MapTrack


MOST_PARTICLES = 500
"""Particles that are drawn: more would overlap, and cost time in every frame."""

_MOST_PLACES = 40

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


_APART_M = 0.04
"""Points of a scan nearer to the one before are left out: their marks would overlap."""

_MOST_CM = 32_000
"""Points and particles are sent as 16-bit centimetres: those farther away are drawn at 320 m."""

_MOST_ROLLOUTS, _ROLLOUT_POINTS = 30, 12
"""Samples of the controller that are drawn, and points of each: more would hide the path and the scans."""

_MONITORED = {
    "slow": "slowed by the collision monitor",
    "approach": "slowed by the collision monitor, which sees something ahead",
    "stop": "stopped by the collision monitor",
}


def frame_of(
    step: Step, *, scans: tuple[Scan, ...] | None = None, most_particles: int = MOST_PARTICLES
) -> dict[str, Any]:
    """Return what the page draws around the robot at a step.

    Args:
        step: The step.
        scans: The scans to show. If None, those of the step are shown.
        most_particles: How many particles of a localizer are kept.
    """
    state, estimate = step.state, step.estimate
    believes = estimate is not None and estimate.pose is not state.pose  # without a localizer it knows the truth
    return {
        "t": round(state.time, 4),
        "scans": [scan_of(scan, state.pose @ _moved(step, scan)) for scan in (step.scans if scans is None else scans)],
        "movers": movers_of(step),
        "tracks": [rounded((track.x, track.y, track.vx, track.vy, track.radius), 3) for track in step.tracks],
        "rollouts": _rollouts_of(step),
        "contacts": [rounded((contact.x, contact.y, 0.0), 3) for contact in state.contacts],
        "monitor": "none" if step.monitor is None else step.monitor.action,
        "doing": doing(step),
        "belief": belief_of(estimate, most_particles=most_particles) if estimate is not None and believes else None,
    }


def scan_of(scan: Scan, base: Pose2D) -> dict[str, Any]:
    """Return what a lidar saw: its pose [x, y, z, yaw], map frame, and its points relative to that [cm], thinned."""
    pose = base @ scan.mount
    hit = (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
    angles, ranges = scan.angles[hit], scan.ranges[hit]
    points = _thinned(np.c_[ranges * np.cos(angles), ranges * np.sin(angles)])
    centimetres = np.clip(np.rint(100.0 * points), -_MOST_CM, _MOST_CM)
    return {
        "name": scan.lidar,
        "pose": rounded((pose.x, pose.y, scan.height, pose.yaw), 3),
        "points": pack_array(centimetres, "i2"),
    }


def movers_of(step: Step) -> list[list[Any]]:
    """Return [name, x, y, yaw] of each mover."""
    return [[mover.name, *rounded(mover.pose.as_tuple(), 3)] for mover in step.movers]


def doing(step: Step) -> str:
    """Describe what the navigator does and why."""
    if step.behaviors and (ran := step.behaviors[-1]).result == "running":
        return f"{ran.behavior}: {ran.reason}"
    if step.message:
        return step.message
    if step.monitor is not None and step.monitor.action in _MONITORED:
        return _MONITORED[step.monitor.action]
    if step.status is NavigationStatus.DRIVING:
        return "driving to the goal" if step.path is not None else "planning"
    return str(step.status).replace("_", " ")


def _moved(step: Step, scan: Scan) -> Pose2D:
    """Return the pose that the robot had when a scan was measured, relative to its pose now."""
    return step.state.twist.integrate(Pose2D(0.0, 0.0), min(0.0, scan.time - step.state.time))


def _thinned(points: FloatArray) -> FloatArray:
    """Return points in the order of their beams, without those in the same small cell as the one before."""
    if len(points) < 2:
        return points
    cells = np.floor(points / _APART_M)
    kept = np.ones(len(points), dtype=np.bool_)
    kept[1:] = (cells[1:] != cells[:-1]).any(axis=1)
    return points[kept]


def _rollouts_of(step: Step) -> list[list[list[float]]]:
    if step.rollouts is None:
        return []
    poses = step.rollouts.poses[:_MOST_ROLLOUTS]
    if poses.size == 0:
        return []
    picked = np.linspace(0, poses.shape[1] - 1, min(_ROLLOUT_POINTS, poses.shape[1])).round().astype(int)
    return np.round(poses[:, picked, :2], 2).tolist()
