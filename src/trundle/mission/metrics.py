"""The metrics of a trajectory."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, path_length, wrap_angles
from trundle.mission.episode import Metrics
from trundle.mission.trajectory import Trajectory
from trundle.mission.truth import CLEARANCE_CAP, Truth
from trundle.path import Path

_LEAST_DISTANCE = 0.01  # [m]: below it, turning per distance is meaningless
_CHUNK = 1_000_000  # distances at a time


def compute_metrics(
    trajectory: Trajectory,
    paths: Sequence[Path],
    costmap: Costmap | None,
    *,
    arrived: bool,
    path_length_m: float,
    planning_s: float,
    replans: int,
    wall_s: float,
    contacts: Sequence[str],
    standing_contacts: Sequence[str] = (),
    unseen_contacts: Sequence[str] = (),
    monitor_stops: int | None = None,
    recoveries: int = 0,
    standing_reasons: Mapping[str, int] | None = None,
    truth: Truth | None = None,
) -> Metrics:
    """Compute the metrics of a run; see `Metrics` for their definitions.

    Args:
        trajectory: The run.
        paths: What its column `path` counts.
        costmap: What the clearance is measured on where the truth is not known; none where there is none.
        arrived: Whether it was a success.
        path_length_m: Length [m] of the first plans to all goals.
        planning_s: Wall time spent on planning [s].
        replans: Plans beyond the first ones.
        wall_s: Wall time of the loop [s].
        contacts: What was touched.
        standing_contacts: What ran into the robot while it stood.
        unseen_contacts: What was touched and no lidar could see.
        monitor_stops: How often a collision monitor stopped the robot; none without one.
        recoveries: Number of steps of recovery that ran.
        standing_reasons: In how many control periods the controller made no progress, by reason; none means never.
        truth: What was measured around the robot; none means that nothing is known but the costmap and the plans, and
            `path_length_m` stands for the shortest path.
    """
    if truth is None:
        shortest_m = path_length_m if arrived else None
        truth = Truth(None, shortest_m, "nothing")
        if costmap is not None:
            clearance = float(costmap.clearance(trajectory.poses, CLEARANCE_CAP).min())
            truth = Truth(clearance, shortest_m, "map")
    distance = path_length(np.column_stack([trajectory.x, trajectory.y]))
    turning = float(np.abs(wrap_angles(np.diff(trajectory.yaw))).sum())
    errors = cross_track_errors(trajectory, paths)
    simulated = float(trajectory.time[-1])
    shortest = truth.shortest_path_m or 0.0
    longest = max(distance, shortest)
    return Metrics(
        time_s=simulated,
        distance_m=distance,
        path_length_m=path_length_m,
        spl=(shortest / longest if longest > 0.0 else 1.0) if arrived else 0.0,
        min_clearance_m=truth.min_clearance_m,
        mean_cross_track_error_m=float(errors.mean()) if len(errors) else None,
        max_cross_track_error_m=float(errors.max()) if len(errors) else None,
        smoothness_rad_per_m=turning / distance if distance >= _LEAST_DISTANCE else None,
        planning_ms=planning_s * 1e3,
        replans=replans,
        real_time_factor=simulated / wall_s if wall_s > 0.0 else 0.0,
        contacts=tuple(contacts),
        shortest_path_m=truth.shortest_path_m,
        measured_on=truth.measured_on,
        standing_contacts=tuple(standing_contacts),
        unseen_contacts=tuple(unseen_contacts),
        position_error_m=math.dist(trajectory.poses[-1, :2], trajectory.estimates[-1, :2]),
        monitor_stops=monitor_stops,
        recoveries=recoveries,
        standing_reasons=dict(sorted((standing_reasons or {}).items(), key=lambda item: -item[1])),
    )


def cross_track_errors(trajectory: Trajectory, paths: Sequence[Path]) -> FloatArray:
    """Distance [m] from base_link to the path followed, for every row that has one; shape (M,), M ≤ N."""
    parts: list[FloatArray] = []
    for index, path in enumerate(paths):
        rows = trajectory.path == index
        if rows.any():
            parts.append(distances_to_polyline(trajectory.poses[rows, :2], path.poses[:, :2]))
    return np.concatenate(parts) if parts else np.zeros(0)


def distances_to_polyline(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Distance [m] of each of `points` (N, 2) to the nearest place on a polyline with `corners` (M, 2), M ≥ 1."""
    starts = corners[:-1] if len(corners) > 1 else corners
    along = np.diff(corners, axis=0) if len(corners) > 1 else np.zeros_like(corners)
    squared = (along * along).sum(axis=1)
    nearest = np.empty(len(points))
    rows = max(1, _CHUNK // len(starts))
    for first in range(0, len(points), rows):
        offsets = points[first : first + rows, None, :] - starts[None, :, :]
        projected = (offsets * along).sum(axis=2)
        fraction = np.clip(projected / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
        gaps = offsets - fraction[:, :, None] * along
        nearest[first : first + rows] = np.sqrt((gaps * gaps).sum(axis=2).min(axis=1))
    return nearest
