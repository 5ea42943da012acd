"""Make barn.png, barn.gif, dynabarn.png and dynabarn.gif: mppi in one world of BARN, and in one of DynaBARN.

Give the folder of BARN's worlds and the file of DynaBARN's, which trundle does not ship, and the folder to write into:

    python docs/pictures/public.py BARN worlds.json docs/images
"""

from __future__ import annotations

import argparse
import math
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import cast

import numpy as np
from PIL import Image, ImageDraw

from trundle.control.mppi import MppiController
from trundle.evaluation import Suite
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.public.barn import barn_suite
from trundle.evaluation.public.conditions import Conditions, benchmark_robot, write_robot
from trundle.evaluation.public.dynabarn import dynabarn_suite
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Cylinder
from trundle.mission import Episode, Mission, RunInfo, Step

SCALE = 2  # of the drawing, which is then reduced
PAGE, INK, SOLID, MOVER = (250, 250, 248), (60, 64, 70), (126, 130, 136), (205, 96, 78)
ROBOT, TRAIL, SAMPLES, TRACK, SCAN, GOAL = (
    (214, 168, 26),
    (30, 110, 160),
    (120, 190, 200),
    (60, 60, 160),
    (240, 140, 60),
    (60, 150, 80),
)
FRAME_S = 0.1
COVERING = Image.Quantize.MAXCOVERAGE  # keeps the colours of small things


@dataclass
class View:
    """A part of a world in pixels.

    Attributes:
        low: Lower left corner [m].
        high: Upper right corner [m].
        pixels: For a metre.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    pixels: float
    image: Image.Image = field(init=False)
    draw: ImageDraw.ImageDraw = field(init=False)

    def start(self) -> None:
        """Begin a new picture."""
        size = [round((high - low) * self.pixels * SCALE) for low, high in zip(self.low, self.high, strict=True)]
        self.image = Image.new("RGB", (size[0], size[1]), PAGE)
        self.draw = ImageDraw.Draw(self.image)

    def at(self, points: FloatArray) -> list[tuple[float, float]]:
        """Points [m] in pixels."""
        places = (np.atleast_2d(points) - self.low) * self.pixels * SCALE
        return [(float(x), self.image.height - float(y)) for x, y in places]

    def line(self, points: FloatArray, color: tuple[int, int, int], width: float) -> None:
        """Draw a line of a width in pixels."""
        if len(points) > 1:
            self.draw.line(self.at(points), color, round(width * SCALE), joint="curve")

    def disc(self, x: float, y: float, radius: float, color: tuple[int, int, int], *, outline: bool = False) -> None:
        """Draw a disc, or its outline."""
        ((u, v),) = self.at(np.array([x, y]))
        r = radius * self.pixels * SCALE
        box = (u - r, v - r, u + r, v + r)
        self.draw.ellipse(box, None if outline else color, color if outline else None, 2 * SCALE)

    def polygon(self, points: FloatArray, color: tuple[int, int, int]) -> None:
        """Draw a filled polygon."""
        self.draw.polygon(self.at(points), color, INK)

    def finish(self) -> Image.Image:
        """The picture."""
        size = (self.image.width // SCALE, self.image.height // SCALE)
        return self.image.resize(size, Image.Resampling.LANCZOS)


def placed(pose: Pose2D, points: FloatArray) -> FloatArray:
    """Points of the robot [m] in the map."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return np.asarray(points) @ np.array([[cos, sin], [-sin, cos]]) + (pose.x, pose.y)


class Film:
    """Draws a mission while it runs."""

    def __init__(self, mission: Mission, view: View) -> None:
        self.frames: list[Image.Image] = []
        self._mission, self._view = mission, view
        self._controller = cast("MppiController", mission.navigator.controller)
        self._trail: list[tuple[float, float]] = []
        self._outline = np.array(mission.robot.footprint)
        self._scan: FloatArray = np.zeros((0, 2))
        self._next = 0.0

    def on_start(self, run: RunInfo) -> None:
        """Wait for the first step."""

    def on_end(self, episode: Episode) -> None:
        """Say how it ended."""
        print(f"{self._mission.scenario.title}: {episode.message}")

    def on_step(self, step: Step) -> None:
        """Draw a frame where one is due."""
        pose = step.state.pose
        self._trail.append((pose.x, pose.y))
        for scan in step.state.scans:
            hit = np.isfinite(scan.ranges)
            angles = scan.angles[hit]
            points = np.column_stack([np.cos(angles), np.sin(angles)]) * scan.ranges[hit, None]
            self._scan = placed(pose @ scan.mount, points)
        if step.state.time >= self._next - 1e-9:
            self._next += FRAME_S
            self.frames.append(self._draw(step))

    def _draw(self, step: Step) -> Image.Image:
        view, pose = self._view, step.state.pose
        view.start()
        for solid in self._mission.world.solids:
            if isinstance(solid.shape, Cylinder):
                view.disc(*solid.pose.position[:2], solid.shape.radius, SOLID)
            else:
                low, high = (np.asarray(end)[:2] for end in solid.bounds())
                view.polygon(np.array([low, (high[0], low[1]), high, (low[0], high[1])]), SOLID)
        goal = self._mission.goals[-1]
        view.disc(goal[0], goal[1], self._mission.navigator.settings.goal_tolerance, GOAL, outline=True)
        for mover in step.state.movers:
            view.polygon(mover.pose.transform_points(mover.outline), MOVER)
        for point in self._scan[::4]:
            view.disc(point[0], point[1], 0.035, SCAN)
        sampled = self._controller.rollouts(40)
        for poses in () if sampled is None else sampled.poses:
            view.line(poses[:, :2], SAMPLES, 1.0)
        for track in step.tracks:
            if track.moving:
                view.disc(track.x, track.y, track.radius, TRACK, outline=True)
                view.line(np.array([(track.x, track.y), (track.x + track.vx, track.y + track.vy)]), TRACK, 2.0)
        view.line(np.array(self._trail), TRAIL, 2.5)
        view.polygon(placed(pose, self._outline), ROBOT)
        view.line(placed(pose, np.array([(0.0, 0.0), (0.25, 0.0)])), INK, 2.0)
        view.draw.rectangle((0, 0, 60 * SCALE, 26 * SCALE), PAGE)
        view.draw.text((8 * SCALE, 6 * SCALE), f"{step.state.time:.1f} s", INK, font_size=13 * SCALE)
        return view.finish()


def first_of(suite: Suite) -> Mission:
    """The first episode of a suite."""
    return EpisodeTask(suite).scenario_of(0).build()


def film(mission: Mission, view: View, name: str, folder: Path, still_s: float, *, every: int = 1) -> None:
    """Drive a mission, and write its animation, of every so many frames, and one of its frames."""
    watcher = Film(mission, view)
    with mission:
        mission.run(observers=[watcher])
    still = watcher.frames[min(len(watcher.frames) - 1, round(still_s / FRAME_S))]
    still.quantize(64, COVERING).save(folder / f"{name}.png", optimize=True)
    small = [
        frame.resize((frame.width * 2 // 3, frame.height * 2 // 3), Image.Resampling.LANCZOS)
        for frame in watcher.frames[::every]
    ]
    colors = still.quantize(32, COVERING)
    first, *rest = [frame.quantize(palette=colors, dither=Image.Dither.NONE) for frame in small]
    lasts = round(1000 * FRAME_S * every)
    first.save(folder / f"{name}.gif", save_all=True, append_images=rest, duration=lasts, loop=0, optimize=True)


def main() -> None:
    """Drive and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("barn", type=Path)
    parser.add_argument("dynabarn", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--barn-world", type=int, default=0)
    parser.add_argument("--dynabarn-world", type=int, default=10)
    parser.add_argument("--phase", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        robot = write_robot(place, benchmark_robot("jackal", speed=2.0, noise=0.01))
        drifting = Conditions(robots=[robot], controllers=["mppi"], seeds=1)
        barn = barn_suite(options.barn, drifting, numbers=[options.barn_world])
        film(first_of(barn), View((-4.9, 2.4), (0.4, 14.2), 60.0), "barn", options.folder, 3.5)
        moving = replace(drifting, seeds=[options.phase], drift=False, collision_monitor=False)
        suite = dynabarn_suite(options.dynabarn, moving, numbers=[options.dynabarn_world])
        film(first_of(suite), View((-10.6, -10.6), (12.2, 10.6), 32.0), "dynabarn", options.folder, 4.0)


if __name__ == "__main__":
    main()
