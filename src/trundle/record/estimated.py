"""Where a localizer believed the robot to be, in pictures of a run, and where it did not know."""

from __future__ import annotations

import numpy as np

from trundle.mission import Trajectory
from trundle.observation import LOCALIZATION_STATES, LocalizationState
from trundle.pictures.colors import BAD, ESTIMATED, WARNING, Rgb
from trundle.record.map_view import MapView
from trundle.record.page import Mark

STATE_COLORS: dict[LocalizationState, Rgb] = {"ambiguous": WARNING, "lost": BAD}

_JUMP_M = 0.5
"""Where an estimate moves by more between two rows, it was corrected: a line there would look like a path."""


def draw_doubts(view: MapView, trajectory: Trajectory, *, width: float = 12.0) -> list[Mark]:
    """Mark on the true trajectory where the localizer was not sure, and return the marks of the legend."""
    marks: list[Mark] = []
    for state, color in STATE_COLORS.items():
        rows = np.flatnonzero(trajectory.localization == LOCALIZATION_STATES.index(state))
        if not len(rows):
            continue
        marks.append(Mark("line", color, state))
        for part in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
            points = trajectory.poses[part, :2]
            view.disc(points[0].tolist(), 0.5 * width, color)  # it often stands then
            if len(points) > 1:
                view.line(points, color, width)
    return marks


def draw_estimated(view: MapView, trajectory: Trajectory, *, width: float = 3.0) -> list[Mark]:
    """Draw the estimated trajectory, and return the mark of the legend; nothing where it is the true one."""
    if not has_estimates(trajectory):
        return []
    points = trajectory.estimates[:, :2]
    jumps = np.flatnonzero(np.hypot(*np.diff(points, axis=0).T) > _JUMP_M) + 1
    for part in np.split(points, jumps):
        if len(part) > 1:
            view.line(part, ESTIMATED, width)
    return [Mark("line", ESTIMATED, "estimated")]


def has_estimates(trajectory: Trajectory) -> bool:
    """Return whether a localizer estimated the poses: they are not the true ones."""
    return bool((trajectory.estimates != trajectory.poses).any())
