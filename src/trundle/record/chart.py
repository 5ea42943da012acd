"""Line charts: a few curves over one axis, with round marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray
from trundle.pictures.colors import FAINT, HAIRLINE, INK, PAGE, Rgb
from trundle.pictures.figure import font, plain

_SMOOTH = 2
_LEFT, _RIGHT, _TOP, _BOTTOM = 66, 20, 34, 30
_LEAST_X = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Points to join by a line.

    Attributes:
        x, y: Shape (N,) each.
        color: Colour of the line.
        name: For the legend; empty for none.
        width: Width of the line [px].
    """

    x: FloatArray
    y: FloatArray
    color: Rgb
    name: str
    width: float = 3


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """Curves over one pair of axes.

    Attributes:
        title: Title, with the unit of y.
        curves: At least one, drawn in order.
        square: Whether both axes have the same scale.
        zero: Whether 0 is always visible.
        least: Minimum span of the y axis, in its unit, so that rounding does not look like a difference; with
            `square` of both axes.
    """

    title: str
    curves: Sequence[Curve]
    square: bool = False
    zero: bool = False
    least: float = 1e-3


@dataclass(frozen=True, slots=True)
class _Axes:
    """The data range of the frame, and its position [px]."""

    x: tuple[float, float]
    y: tuple[float, float]
    size: tuple[int, int]

    def to_pixels(self, x: FloatArray, y: FloatArray) -> FloatArray:
        wide, high = self.size[0] - _LEFT - _RIGHT, self.size[1] - _TOP - _BOTTOM
        across = _LEFT + (np.asarray(x) - self.x[0]) / (self.x[1] - self.x[0]) * wide
        down = _TOP + (self.y[1] - np.asarray(y)) / (self.y[1] - self.y[0]) * high
        return np.column_stack([across, down])


def draw_chart(chart: Chart, size: tuple[int, int]) -> Image.Image:
    """Draw a chart in a picture of `size` (width, height) [px]."""
    axes = _frame(chart, size)
    image = Image.new("RGB", (size[0] * _SMOOTH, size[1] * _SMOOTH), PAGE)
    draw = ImageDraw.Draw(image)
    for span, across in ((axes.x, True), (axes.y, False)):
        for mark in round_marks(*span):
            ends = np.array([mark, mark]), np.array(axes.y if across else axes.x)
            points = axes.to_pixels(*(ends if across else ends[::-1]))
            draw.line((points * _SMOOTH).ravel().tolist(), fill=HAIRLINE, width=_SMOOTH)
    for curve in chart.curves:
        points = axes.to_pixels(curve.x, curve.y) * _SMOOTH
        draw.line(points.ravel().tolist(), fill=curve.color, width=round(curve.width * _SMOOTH), joint="curve")
    picture = image.reduce(_SMOOTH)
    _letter(picture, chart, axes)
    return picture


def round_marks(low: float, high: float, about: int = 5) -> list[float]:
    """About `count` round numbers from `low` to `high`."""
    raw = (high - low) / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * 0.999)
    first = math.ceil(low / step - 1e-9)
    # Rounded, and 0.0 added, so that no mark reads -0.
    return [round(index * step, 12) + 0.0 for index in range(first, math.floor(high / step + 1e-9) + 1)]


def _letter(picture: Image.Image, chart: Chart, axes: _Axes) -> None:
    draw, small = ImageDraw.Draw(picture), font(14)
    for mark in round_marks(*axes.x):
        x, _ = axes.to_pixels(np.array([mark]), np.array([axes.y[0]]))[0]
        draw.text((x, picture.height - _BOTTOM + 6), f"{mark:g}", font=small, fill=FAINT, anchor="mt")
    for mark in round_marks(*axes.y):
        _, y = axes.to_pixels(np.array([axes.x[0]]), np.array([mark]))[0]
        draw.text((_LEFT - 8, y), f"{mark:g}", font=small, fill=FAINT, anchor="rm")
    draw.text((_LEFT, 8), plain(chart.title), font=font(17), fill=INK)
    right = picture.width - _RIGHT
    for curve in reversed(chart.curves):
        if curve.name:
            name = plain(curve.name)
            right -= round(draw.textlength(name, font=small))
            draw.text((right, 10), name, font=small, fill=INK)
            draw.line((right - 28, 18, right - 8, 18), fill=curve.color, width=max(2, round(curve.width)))
            right -= 44


def _frame(chart: Chart, size: tuple[int, int]) -> _Axes:
    xs = np.concatenate([curve.x for curve in chart.curves])
    ys = np.concatenate([curve.y for curve in chart.curves])
    x, y = (float(xs.min()), float(xs.max())), (float(ys.min()), float(ys.max()))
    if chart.zero:
        y = (min(0.0, y[0]), max(0.0, y[1]))
    if chart.square:
        wide, high = size[0] - _LEFT - _RIGHT, size[1] - _TOP - _BOTTOM
        scale = 1.1 * max((x[1] - x[0]) / wide, (y[1] - y[0]) / high, chart.least / min(wide, high))
        return _Axes(_around(x, scale * wide), _around(y, scale * high), size)
    tall = y[1] - y[0]
    if chart.zero and tall < chart.least and y[0] == 0.0:
        return _Axes(_around(x, max(x[1] - x[0], _LEAST_X)), (-0.04 * chart.least, 1.04 * chart.least), size)
    return _Axes(_around(x, max(x[1] - x[0], _LEAST_X)), _around(y, 1.08 * max(tall, chart.least)), size)


def _around(span: tuple[float, float], length: float) -> tuple[float, float]:
    middle = (span[0] + span[1]) / 2.0
    return middle - length / 2.0, middle + length / 2.0
