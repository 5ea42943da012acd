"""The divergence of two runs of the same commands, as numbers and as a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from trundle.errors import InputError
from trundle.geometry import FloatArray, wrap_angle, wrap_angles
from trundle.pictures.colors import BAD, FAINT, GOAL, HAIRLINE, INK, PAGE, START, Rgb
from trundle.pictures.figure import font, plain
from trundle.record.motion import Motion

# Starts this close are the same; runs that start farther apart are compared only with `align`.
_SAME_START_M = 0.01
_SAME_START_RAD = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Two motions at the same times.

    Attributes:
        time: Times of the first motion [s] that both motions cover, shape (N,).
        position_error: Distance between the two positions [m], shape (N,).
        yaw_error: Second yaw minus the first, wrapped [rad], shape (N,).
        max_position_error_m: Largest distance [m].
        max_yaw_error_rad: Largest difference in yaw, as a positive number [rad].
        final_position_error_m: Distance at the end [m].
        final_yaw_error_rad: Difference in yaw at the end, as a positive number [rad].
        rms_position_error_m: Root mean square distance [m].
        max_command_difference: Largest difference between the commands, in v [m/s] or w [rad/s]; above 0 their
            commands differ.
        first, second: The two motions, the second at the times of the first.
    """

    time: FloatArray
    position_error: FloatArray
    yaw_error: FloatArray
    max_position_error_m: float
    max_yaw_error_rad: float
    final_position_error_m: float
    final_yaw_error_rad: float
    rms_position_error_m: float
    max_command_difference: float
    first: Motion
    second: Motion


def compare_motions(first: Motion, second: Motion, *, align: bool = False) -> Comparison:
    """Compare two motions over their common time span.

    The second is interpolated linearly to the times of the first; its commands are those in force at that time.

    Args:
        first: The reference.
        second: The motion to compare with it.
        align: Move and rotate the second so that both start at the same pose.

    Raises:
        InputError: If they share no time, or start at different poses without `align`.
    """
    second = _aligned(first, second) if align else second
    apart = float(np.hypot(second.x[0] - first.x[0], second.y[0] - first.y[0]))
    turned = abs(wrap_angle(float(second.yaw[0] - first.yaw[0])))
    if apart > _SAME_START_M or turned > _SAME_START_RAD:
        raise InputError(
            f"the runs start {apart:.3f} m and {turned:.3f} rad apart: drive both from the same start, or move the "
            "second onto the first with --align"
        )
    begin, end = max(first.time[0], second.time[0]), min(first.time[-1], second.time[-1])
    rows = (first.time >= begin - 1e-9) & (first.time <= end + 1e-9)
    if rows.sum() < 2:
        raise InputError("the runs have no time in common")
    one = Motion(*(getattr(first, name)[rows] for name in Motion.__slots__))
    other = _at(second, one.time)
    position = np.hypot(other.x - one.x, other.y - one.y)
    yaw = wrap_angles(other.yaw - one.yaw)
    commands = np.concatenate([other.commanded_v - one.commanded_v, other.commanded_w - one.commanded_w])
    return Comparison(
        time=one.time,
        position_error=position,
        yaw_error=yaw,
        max_position_error_m=float(position.max()),
        max_yaw_error_rad=float(np.abs(yaw).max()),
        final_position_error_m=float(position[-1]),
        final_yaw_error_rad=float(abs(yaw[-1])),
        rms_position_error_m=float(np.sqrt((position**2).mean())),
        max_command_difference=float(np.abs(commands).max()),
        first=one,
        second=other,
    )


def draw_comparison(comparison: Comparison, names: tuple[str, str]) -> Image.Image:
    """Draw both trajectories from above, their distance over time, and their speeds beside the commands."""
    one, other, time = comparison.first, comparison.second, comparison.time
    distance = [Curve(time, 1000.0 * comparison.position_error, BAD, "")]
    yaw = [Curve(time, np.degrees(comparison.yaw_error), BAD, "")]
    charts = [
        Chart(
            "from above [m]",
            [Curve(one.x, one.y, START, names[0], 5), Curve(other.x, other.y, GOAL, names[1], 2)],
            square=True,
            least=0.1,
        ),
        Chart("distance [mm] over time [s]", distance, zero=True, least=1.0),
        Chart("yaw difference [°] over time [s]", yaw, zero=True, least=0.1),
        Chart("v [m/s]", _speed_curves(time, one.commanded_v, one.v, other.v, names), zero=True, least=0.1),
        Chart("w [rad/s]", _speed_curves(time, one.commanded_w, one.w, other.w, names), zero=True, least=0.1),
    ]
    head, high, wide, side = 84, 210, 620, 620
    page = Image.new("RGB", (side + wide, head + 4 * high + 16), PAGE)
    draw = ImageDraw.Draw(page)
    draw.text((28, 16), plain(f"{names[0]} and {names[1]}"), font=font(28), fill=INK)
    line = (
        f"maximum distance {1000.0 * comparison.max_position_error_m:.1f} mm and "
        f"{np.degrees(comparison.max_yaw_error_rad):.2f}° in {time[-1] - time[0]:.1f} s"
    )
    draw.text((28, 54), line, font=font(17), fill=FAINT)
    page.paste(draw_chart(charts[0], (side, 4 * high)), (0, head))
    for row, chart in enumerate(charts[1:]):
        page.paste(draw_chart(chart, (wide, high)), (side, head + row * high))
    return page


def _speed_curves(
    time: FloatArray, commanded: FloatArray, one: FloatArray, other: FloatArray, names: tuple[str, str]
) -> list[Curve]:
    return [
        Curve(time, commanded, FAINT, "commanded", 2),
        Curve(time, one, START, names[0], 4),
        Curve(time, other, GOAL, names[1], 2),
    ]


def _at(motion: Motion, time: FloatArray) -> Motion:
    """Return the motion at other times; commands are those of the control period that contains each time."""
    yaw = np.interp(time, motion.time, np.unwrap(motion.yaw))
    held = np.minimum(np.searchsorted(motion.time, time - 1e-9), len(motion.time) - 1)
    linear = {name: np.interp(time, motion.time, getattr(motion, name)) for name in ("x", "y", "v", "w")}
    return Motion(
        time=time, yaw=yaw, commanded_v=motion.commanded_v[held], commanded_w=motion.commanded_w[held], **linear
    )


def _aligned(first: Motion, second: Motion) -> Motion:
    """Return the second motion, moved to the start of the first."""
    turn = float(first.yaw[0] - second.yaw[0])
    cos, sin = np.cos(turn), np.sin(turn)
    x, y = second.x - second.x[0], second.y - second.y[0]
    moved = {
        "x": first.x[0] + cos * x - sin * y,
        "y": first.y[0] + sin * x + cos * y,
        "yaw": second.yaw + turn,
    }
    return Motion(**{name: moved.get(name, getattr(second, name)) for name in Motion.__slots__})


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
