"""The log of a run from the files of its folder: of one that was driven before there were reports, or elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode
from trundle.mission.metrics import CLEARANCE_CAP, distances_to_polyline
from trundle.page.encoding import finite, rounded
from trundle.page.rows import goal_of
from trundle.page.run_data import dropped_boxes
from trundle.page.run_lines import path_of
from trundle.robots import Robot
from trundle.sim.clearance import map_world
from trundle.worlds import World

_RESOLUTION_M = 0.05


def run_of(episode: Episode, robot: Robot, world: World | None, grid: OccupancyGrid | None) -> dict[str, Any]:
    """What `RunData.run_dict` gives, without what only an observer sees: scans, movers and wall times."""
    time = episode.trajectory.time
    return {
        "info": {
            "name": episode.name,
            "robot": episode.robot,
            "planner": episode.planner,
            "controller": episode.controller,
            "seed": episode.seed,
            "start": rounded(episode.start.as_tuple()),
            "goals": [goal_of(goal) for goal in episode.goals],
            "dt": float(time[1] - time[0]) if len(time) > 1 else 0.05,
            "time_limit_s": finite(episode.time_limit_s),
        },
        "rows": _rows(episode, robot, _clearances(episode, robot, world, grid)),
        "paths": [
            path_of(episode.paths[index], float(time[first]))
            for index in range(len(episode.paths))
            if (first := _first(episode.trajectory.path == index)) is not None
        ],
        "events": _events(episode),
        "frames": [],
        "costmaps": [],
        "contacts": [],
        "solids": dropped_boxes(episode),
    }


def _rows(episode: Episode, robot: Robot, clearances: FloatArray | None) -> list[list[Any]]:
    driven = episode.trajectory
    spent = np.diff(driven.time, prepend=driven.time[0])
    across = driven.w * robot.drive.track_width / 2.0
    left, right = (np.cumsum((driven.v + side * across) * spent) / robot.drive.wheel_radius for side in (-1.0, 1.0))
    off = np.full(len(driven), np.nan)
    for index, path in enumerate(episode.paths):
        follows = driven.path == index
        if follows.any():
            off[follows] = distances_to_polyline(driven.poses[follows, :2], path.poses[:, :2])
    apart = np.abs(driven.estimates - driven.poses).max(axis=1) > 0.0
    sent = np.c_[driven.commanded_v, driven.commanded_w]
    numbers = np.c_[driven.time, driven.poses, driven.v, driven.w, sent, sent].round(4).tolist()
    last = len(driven) - 1
    return [
        [
            *numbers[row],
            None if clearances is None else finite(float(clearances[row])),
            finite(float(off[row])),
            int(driven.goal[row]),
            episode.outcome.value if row == last else "driving",
            None,
            None,
            round(float(left[row]), 3),
            round(float(right[row]), 3),
            *(rounded(driven.estimates[row].tolist()) if apart[row] else (None, None, None)),
        ]
        for row in range(len(driven))
    ]


def _clearances(episode: Episode, robot: Robot, world: World | None, grid: OccupancyGrid | None) -> FloatArray | None:
    """Distance [m] from the footprint to solids at each row, to within a cell; none where nothing is known."""
    poses = episode.trajectory.poses
    if world is not None and world.solids:
        margin = CLEARANCE_CAP + robot.circumscribed_radius
        true_map = map_world(world, robot, poses[:, :2], resolution=_RESOLUTION_M, margin=margin)
    elif grid is not None:
        true_map = Costmap.from_grid(grid, robot)
    else:
        return None
    return true_map.clearance(poses, CLEARANCE_CAP)


def _events(episode: Episode) -> list[dict[str, Any]]:
    driven = episode.trajectory
    found = [(0.0, "start", f"{episode.robot} at ({episode.start.x:.2f}, {episode.start.y:.2f})")]
    for index, path in enumerate(episode.paths):
        if (row := _first(driven.path == index)) is not None:
            found.append((float(driven.time[row]), "replan" if index else "plan", f"path of {path.length:.2f} m"))
    changes = np.flatnonzero(np.diff(driven.goal)) + 1
    found += [(float(driven.time[row]), "goal", f"goal {int(driven.goal[row])} reached") for row in changes]
    found += [(ran.begin_s, "recovery", f"{ran.behavior}: {ran.reason}") for ran in episode.behaviors]
    ended = f"{episode.outcome.value.replace('_', ' ')}: {episode.message}"
    found = [*sorted(found, key=lambda one: one[0]), (float(driven.time[-1]), "end", ended)]
    return [{"t": round(time, 4), "kind": kind, "text": text} for time, kind, text in found]


def _first(rows: Any) -> int | None:
    """The first row that holds; none where none does."""
    return int(rows.argmax()) if rows.any() else None
