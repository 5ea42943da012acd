"""A picture of a robot from above."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import BAD, FAINT, INK, LINE, Rgb
from trundle.pictures.figure import make_figure
from trundle.pictures.plan import Plan

_LONG_SIDE = 480  # [pixels]


@dataclass(frozen=True, slots=True)
class DrawnWheel:
    """A drive wheel as seen from above: its centre (x, y), its diameter and its width [m] in base_link."""

    x: float
    y: float
    diameter: float
    width: float


def draw_robot(
    outline: FloatArray,
    wheels: Sequence[DrawnWheel],
    casters: Sequence[tuple[float, float, float]],
    lidars: Sequence[tuple[float, float, float]],
    color: Rgb,
    title: str,
    lines: Sequence[str],
) -> Image.Image:
    """Draw a robot that faces right.

    Args:
        outline: Corners of the footprint in base_link [m], shape (N, 2).
        wheels: Its drive wheels.
        casters: (x, y, radius) of each [m].
        lidars: (x, y, yaw) of each [m, m, rad].
        color: Colour of the chassis.
        title: Title of the picture.
        lines: Lines of the caption.
    """
    reach = float(np.ptp(outline, axis=0).max())
    tips = [(wheel.x + side * wheel.diameter / 2.0, wheel.y) for wheel in wheels for side in (-1.0, 1.0)]
    seen = np.concatenate([outline, np.array(tips).reshape(-1, 2)])
    plan = Plan(seen, least_m=0.05, long_side=_LONG_SIDE, margin_m=0.12 * reach)
    plan.polygon(outline, color, fill=70, width=2.5)
    for wheel in wheels:
        plan.polygon(_rectangle(wheel), INK, fill=220, width=1.0)
    for x, y, radius in casters:
        plan.circle((x, y), radius, FAINT, fill=120, width=1.5)
    for x, y, yaw in lidars:
        plan.circle((x, y), 0.05 * reach, BAD, fill=110, width=2.0)
        tip = (x + 0.09 * reach * math.cos(yaw), y + 0.09 * reach * math.sin(yaw))
        plan.line([(x, y), tip], BAD, 2.0)
    plan.line([(0.0, 0.0), (0.18 * reach, 0.0)], LINE, 3.0)
    plan.arrow(Pose2D(0.2 * reach, 0.0), 16.0, LINE)
    plan.disc((0.0, 0.0), 5.0, LINE)
    return make_figure(plan.finish(), plan.pixels_per_metre, title, lines)


def _rectangle(wheel: DrawnWheel) -> FloatArray:
    half = np.array([wheel.diameter, wheel.width]) / 2.0
    return np.array([wheel.x, wheel.y]) + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
