"""A run as a picture: its paths and its drive, on the costmap where there is one."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path as FilePath

import numpy as np
from PIL import Image

from trundle.costmap import Costmap
from trundle.files.opening import is_file
from trundle.geometry import Goal, Pose2D
from trundle.mission.trajectory import Trajectory
from trundle.path import Path
from trundle.pictures.cells import lay_cells
from trundle.pictures.colors import COST_ORDER, GOAL, PLANNED, START, cost_palette, speed_color
from trundle.pictures.figure import make_figure
from trundle.pictures.plan import Plan

_MOST = 1000  # largest width and height [px]
_LEVELS = 16


def draw_drive(
    trajectory: Trajectory,
    paths: Sequence[Path],
    start: Pose2D,
    goals: Sequence[Goal],
    title: str,
    lines: Sequence[str],
    costmap: Costmap | None = None,
) -> Image.Image:
    """Draw the paths, where the robot drove, brighter where it was faster, and the start and the goals."""
    seen = [trajectory.poses[:, :2], *(path.poses[:, :2] for path in paths)]
    plan = Plan(np.concatenate([*seen, [(end.x, end.y) for end in (start, *goals)]]))
    if costmap is not None:
        lay_cells(plan, costmap.data, cost_palette(), COST_ORDER, costmap.resolution, costmap.origin)
    for path in paths:
        plan.line(path.poses[:, :2], PLANNED, 9.0)
    top = max(float(np.abs(trajectory.v).max()), 1e-6)
    levels = (np.abs(trajectory.v) / top * _LEVELS).round().astype(int)
    edges = [0, *(np.flatnonzero(np.diff(levels)) + 1).tolist(), len(trajectory) - 1]
    for first, last in itertools.pairwise(edges):
        plan.line(trajectory.poses[first : last + 1, :2], speed_color(levels[first] / _LEVELS), 3.5)
    for goal in goals:
        if goal.yaw_free:
            plan.target(goal, GOAL)
        else:
            plan.marker(goal.pose, GOAL)
    plan.marker(start, START)
    return make_figure(plan.finish(), plan.pixels_per_metre, title, lines)


def read_overlay(folder: FilePath) -> Image.Image | None:
    """Return the overlay of a run's folder, reduced to a notebook's width; None if it cannot be read."""
    file = folder / "overlay.png"
    if not is_file(file):
        return None
    try:
        with Image.open(file) as image:
            image.thumbnail((_MOST, _MOST))
            return image.convert("RGB")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
