"""The divergence of two runs of the same commands, as numbers and as a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from trundle.errors import InputError
from trundle.geometry import FloatArray, wrap_angle, wrap_angles
from trundle.pictures.colors import BAD, FAINT, GOAL, INK, PAGE, START
from trundle.pictures.figure import font, plain
from trundle.record.chart import Chart, Curve, draw_chart
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
