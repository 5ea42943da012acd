"""A path as a picture."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import BACKED, GOAL, LINE, START
from trundle.pictures.figure import make_figure
from trundle.pictures.plan import Plan


def draw_path(poses: FloatArray, backward: npt.NDArray[np.bool_], title: str, lines: Sequence[str]) -> Image.Image:
    """Draw poses (x, y, yaw), shape (N, 3), and in another colour the legs that are driven backwards."""
    plan = Plan(poses[:, :2])
    draw_legs(plan, poses, backward)
    start, goal = Pose2D(*poses[0].tolist()), Pose2D(*poses[-1].tolist())
    plan.marker(goal, GOAL)
    plan.marker(start, START)
    return make_figure(plan.finish(), plan.pixels_per_metre, title, lines)


def draw_legs(plan: Plan, poses: FloatArray, backward: npt.NDArray[np.bool_], *, width: float = 5.0) -> None:
    """Draw the legs of a path, shape (N, 3): forward ones in `LINE`, backward ones in `BACKED`."""
    turns = np.flatnonzero(np.diff(backward.astype(np.int8))) + 1
    for first, last in itertools.pairwise([0, *turns.tolist(), len(poses) - 1]):
        color = BACKED if len(backward) and backward[first] else LINE
        plan.line(poses[first : last + 1, :2], color, width)
