"""Make the pictures of the guide to localization: particles that search, a kidnapping, and errors over a drive.

python docs/pictures/localization.py
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, cast

import numpy as np
from PIL import Image, ImageDraw
from stacked import save_stacked

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.mission import PlaceRobot, Scenario, Steering, Step
from trundle.observation import Estimate
from trundle.pictures.colors import BACKED, BAD, FAINT, GOAL, GOOD, HAIRLINE, INK, LINE, PAGE, SAMPLED, WARNING, Rgb
from trundle.pictures.figure import font
from trundle.record.map_view import MapView

WAREHOUSE: dict[str, Any] = {
    "world": {"name": "warehouse", "seed": 3, "options": {"low_objects": False}},
    "start": (-12.0, 0.0, 0.0),
    "goal": (13.0, 4.0),
    "backend": "kinematic",
    "lidar": True,
    "odometry": {"scale": 0.01, "heading": "1deg"},
    "seed": 1,
}
OFFICE: dict[str, Any] = {
    **{key: WAREHOUSE[key] for key in ("backend", "lidar", "odometry", "seed")},
    "world": {"name": "office", "seed": 1},
    "start_error": "unknown",
}
CARRIED_AT_S, CARRIED_TO = 12.0, (-9.0, -7.0, 1.57)
STATES: dict[str, Rgb] = {"localized": GOOD, "ambiguous": WARNING, "lost": BAD}
TRUE, ESTIMATED, BY_ODOMETRY = LINE, GOAL, BACKED
WIDTH, PLOT_HEIGHT, HEADER = 1400, 420, 64
LEFT, TOP, BOTTOM = 110, 84, 64

Legend = Sequence[tuple[Rgb, str]]


@dataclass(frozen=True)
class Drive:
    """A run: the costmap of its map, the robot's outline [m] in base_link, and its steps."""

    costmap: Costmap
    outline: FloatArray
    steps: tuple[Step, ...]

    @property
    def times(self) -> FloatArray:
        """Of the steps [s]."""
        return np.array([step.state.time for step in self.steps])

    @property
    def errors(self) -> FloatArray:
        """How far the estimates are from the truth [m]."""
        return np.array([estimate_of(step).pose.distance_to(step.state.pose) for step in self.steps])

    def track(self, place: Callable[[Step], Pose2D]) -> FloatArray:
        """Positions [m] of some pose of each step, map frame, shape (N, 2)."""
        return np.array([place(step).as_tuple()[:2] for step in self.steps])


def estimate_of(step: Step) -> Estimate:
    """Return what the localizer said."""
    return cast("Estimate", step.estimate)


def drive(settings: dict[str, Any], localizer: str, *, is_carried: bool = False) -> Drive:
    """Drive to the goal; the robot may be put elsewhere on the way."""
    scenario = Scenario.make(**settings, localizer=localizer)
    setting, steering, steps = scenario.prepare(), Steering(), []
    with scenario.build() as mission:
        session = mission.session(steering=steering)
        while (step := session.step()) is not None and step.status.value != "arrived":
            steps.append(step)
            if is_carried and step.index == round(CARRIED_AT_S / 0.05):
                steering.put(PlaceRobot(*CARRIED_TO))
    return Drive(setting.navigator.costmap, setting.robot.outline, tuple(steps))


# Drawing --------------------------------------------------------------------------------------------------------------


def framed(picture: Image.Image, title: str, legend: Legend = ()) -> Image.Image:
    """Put a title and a legend above a picture, in the width of all."""
    height = round(picture.height * WIDTH / picture.width)
    page = Image.new("RGB", (WIDTH, HEADER + height), PAGE)
    page.paste(picture.resize((WIDTH, height), Image.Resampling.LANCZOS), (0, HEADER))
    write_header(ImageDraw.Draw(page), title, legend)
    return page


def write_header(draw: ImageDraw.ImageDraw, title: str, legend: Legend) -> None:
    """Write a title at the left, and what the colours mean at the right."""
    draw.text((20, HEADER // 2), title, font=font(28), fill=INK, anchor="lm")
    right = WIDTH - 20
    for color, text in reversed(legend):
        draw.text((right, HEADER // 2), text, font=font(24), fill=INK, anchor="rm")
        right -= round(draw.textlength(text, font=font(24))) + 12
        draw.rectangle((right - 30, HEADER // 2 - 4, right, HEADER // 2 + 4), fill=color)
        right -= 58


def plot_errors(
    curves: Sequence[tuple[FloatArray, FloatArray, Rgb]], title: str, legend: Legend, states: Sequence[Step] = ()
) -> Image.Image:
    """Draw errors [m] over the time [s], on a logarithmic scale, with the localizer's state behind them."""
    page = Image.new("RGB", (WIDTH, PLOT_HEIGHT), PAGE)
    draw = ImageDraw.Draw(page)
    write_header(draw, title, legend)
    end = max(float(times[-1]) for times, _, _ in curves)
    low, high = -3.0, 1.5

    def at(time: float, error: float) -> tuple[float, float]:
        share = (np.log10(max(error, 10**low)) - low) / (high - low)
        return LEFT + (WIDTH - LEFT - 40) * time / end, PLOT_HEIGHT - BOTTOM - (PLOT_HEIGHT - BOTTOM - TOP) * share

    bottom, top = PLOT_HEIGHT - BOTTOM, at(0.0, 10**high)[1]
    for before, after in pairwise(states):
        tint = tuple(round(255 - 0.22 * (255 - part)) for part in STATES[estimate_of(after).state])
        draw.rectangle((at(before.state.time, 1)[0], top, at(after.state.time, 1)[0], bottom), fill=tint)
    for error in (0.001, 0.01, 0.1, 1.0, 10.0):
        y = at(0.0, error)[1]
        draw.line((LEFT, y, WIDTH - 40, y), fill=HAIRLINE, width=2)
        draw.text((LEFT - 12, y), f"{error:g} m", font=font(22), fill=FAINT, anchor="rm")
    for time in np.arange(0.0, end, 10.0):
        draw.text((at(time, 1)[0], bottom + 10), f"{time:g} s", font=font(22), fill=FAINT, anchor="mt")
    for times, errors, color in curves:
        draw.line([at(t, e) for t, e in zip(times, errors, strict=True)], fill=color, width=4, joint="curve")
    return page


def draw_search(found: Drive) -> None:
    """Particles and the places that fit, at four times."""
    states = [estimate_of(step).state for step in found.steps]
    first = states.index("localized", 10)
    pictures = []
    for index in (1, first // 2, first, first + 40):
        step = found.steps[index]
        estimate, view = estimate_of(step), MapView(found.costmap, long_side=WIDTH)
        for x, y, yaw, _ in [] if estimate.particles is None else estimate.particles:
            view.line([(x, y), (x + 0.3 * np.cos(yaw), y + 0.3 * np.sin(yaw))], SAMPLED, 4)
        places = [(place.pose, ESTIMATED, 10) for place in estimate.hypotheses]
        for pose, color, width in (*places, (step.state.pose, TRUE, 4)):
            corners = pose.transform_points(found.outline)
            view.line(np.vstack([corners, corners[:1]]), color, width)
        count = len(estimate.hypotheses)
        text = f"{step.state.time:.1f} s: {estimate.state}, {count} place{'s' if count != 1 else ''}"
        legend = ((SAMPLED, "particles"), (ESTIMATED, "places that fit"), (TRUE, "true pose"))
        pictures.append(framed(view.finish(), text, legend if index == 1 else ()))
    save_stacked(pictures, "localization_search.png", columns=2)


def draw_kidnapping(carried: Drive) -> None:
    """The paths on the map, and the error and the state over the time."""
    view = MapView(carried.costmap, long_side=WIDTH)
    true = carried.track(lambda step: step.state.pose)
    cut = 1 + int(np.argmax(np.hypot(*np.diff(true, axis=0).T)))
    believed = carried.track(lambda step: estimate_of(step).pose)
    jump = cut + int(np.argmax(np.hypot(*np.diff(believed[cut:], axis=0).T))) + 1
    for part in (true[:cut], true[cut:]):
        view.line(part, TRUE, 7)
    for part in (believed[:cut], believed[cut:jump], believed[jump:]):
        view.line(part, ESTIMATED, 3)
    view.line([true[cut - 1], true[cut]], BAD, 3)
    view.disc(true[cut].tolist(), 9, BAD)
    top = framed(view.finish(), "Carried away after 12 s", ((TRUE, "true"), (ESTIMATED, "estimated"), (BAD, "carried")))
    legend = tuple((color, name) for name, color in STATES.items())
    curves = ((carried.times, carried.errors, INK),)
    save_stacked(
        [top, plot_errors(curves, "Error of the estimate", legend, carried.steps)], "localization_kidnapping.png"
    )


def draw_drive(corrected: Drive, uncorrected: Drive) -> None:
    """Paths and errors of the same mission with `amcl` and with odometry alone."""
    view = MapView(corrected.costmap, long_side=WIDTH)
    first = corrected.steps[0].state
    from_odom = first.pose @ first.odometry.inverse()
    view.line(uncorrected.track(lambda step: step.state.pose), BAD, 5)
    view.line(corrected.track(lambda step: from_odom @ step.state.odometry), BY_ODOMETRY, 5)
    view.line(corrected.track(lambda step: step.state.pose), TRUE, 8)
    view.line(corrected.track(lambda step: estimate_of(step).pose), ESTIMATED, 3)
    view.disc(WAREHOUSE["goal"], 9, GOOD)
    legend = (
        (TRUE, "true, with amcl"),
        (ESTIMATED, "estimated"),
        (BY_ODOMETRY, "its odometry"),
        (BAD, "true, without"),
        (GOOD, "goal"),
    )
    top = framed(view.finish(), "Odometry 1 % and 1°/m off", legend)
    curves = ((uncorrected.times, uncorrected.errors, BAD), (corrected.times, corrected.errors, ESTIMATED))
    plot = plot_errors(curves, "Error of the estimate", ((ESTIMATED, "amcl"), (BAD, "odometry alone")))
    save_stacked([top, plot], "localization_drive.png")


def main() -> None:
    draw_search(drive(OFFICE, "amcl"))
    draw_kidnapping(drive(WAREHOUSE, "amcl", is_carried=True))
    draw_drive(drive(WAREHOUSE, "amcl"), drive(WAREHOUSE, "odometry"))


if __name__ == "__main__":
    main()
