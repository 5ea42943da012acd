"""What is around the robot at one step: scans, movers, tracks, samples, contacts, and what the navigator does."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.mission.observers import Step
from trundle.navigation import NavigationStatus
from trundle.observation import Scan
from trundle.page.belief import MOST_PARTICLES, belief_of
from trundle.page.encoding import pack_array, rounded

_APART_M = 0.04
"""Points of a scan nearer to the one before are left out: their marks would overlap."""

_MOST_CM = 32_000
"""Points are sent as 16-bit centimetres: those farther away are drawn at 320 m."""

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
