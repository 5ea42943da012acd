"""Make driving.webp, the moving picture of the README: step 5 of the post, seen from ahead of the robot, with its map.

It is the run of `trundle run warehouse --start -13,0,0 --goal 13,4 -o first`, played faster. Rendering needs an OpenGL
driver, but no screen, and takes some minutes.

    python docs/pictures/driving.py docs/images
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageOps

from trundle.geometry import FloatArray, Pose2D
from trundle.mission import Episode, RunInfo, Scenario
from trundle.record.map_view import view_run
from trundle.viewer.cameras import Camera
from trundle.viewer.painters import open_painter
from trundle.viewer.scene_model import SceneModel

SIZE = (800, 450)
FRAME_S = 0.1  # between two pictures as they are shown [s]
FASTER = 4.0
HOLD = 10  # more pictures of the end
AHEAD_M, ASIDE_M, UP_M = 2.9, 0.55, 1.75  # the camera from the robot: ahead on the driven path, where nothing is
SMOOTH_M = 1.6  # over which the camera's path is averaged
MAP_WIDTH, MARGIN = 264, 12
ENLARGED = 2.0  # the robot on the map
PATH, DRIVEN, ROBOT, GOAL, EDGE = (90, 170, 240), (230, 110, 40), (20, 110, 100), (26, 160, 80), (255, 255, 255)
MAX_BYTES = 1_500_000


class Watch:
    """Keeps what a run says about itself at its start."""

    info: RunInfo

    def on_start(self, run: RunInfo) -> None:
        """Keep it."""
        self.info = run

    def on_step(self, step: Any) -> None:
        """Do nothing."""

    def on_end(self, episode: Episode) -> None:
        """Do nothing."""


def camera_track(poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places of the camera on the smoothed path [m], shape (N, 2), and their distances along it [m], shape (N,)."""
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    end = float(along[-1])
    places = np.arange(-SMOOTH_M, end + AHEAD_M + SMOOTH_M, 0.02)
    track: FloatArray = np.column_stack([np.interp(places, along, poses[:, axis]) for axis in (0, 1)])
    last = track[places < end][-1] - track[places < end - 1.0][-1]
    beyond = places > end
    track[beyond] += np.outer(places[beyond] - end, last / np.hypot(*last))
    half = round(SMOOTH_M / 0.02 / 2)
    kernel = np.hanning(2 * half + 1)
    kernel /= kernel.sum()
    smooth: FloatArray = np.column_stack(
        [np.convolve(np.pad(track[:, axis], half, mode="edge"), kernel, mode="valid").real for axis in (0, 1)]
    )
    return smooth, places


def aim(robot: Pose2D, driven: float, track: FloatArray, places: FloatArray) -> Camera:
    """The camera ahead of a robot that has driven so far [m], a little to its left, looking back at it."""
    x, y = (float(np.interp(driven + AHEAD_M, places, track[:, axis])) for axis in (0, 1))
    heading = math.atan2(y - robot.y, x - robot.x)
    eye = (x - ASIDE_M * math.sin(heading), y + ASIDE_M * math.cos(heading), UP_M)
    back = 0.35  # the middle of the picture is behind the robot, so that more of the aisle is seen
    target = (robot.x - back * math.cos(heading), robot.y - back * math.sin(heading), 0.35)
    return Camera(eye, target, 46.0)


class SmallMap:
    """The map with the planned path, the driven one, and a robot that is large enough to be seen."""

    def __init__(self, run: RunInfo, episode: Episode) -> None:
        view = view_run(run.costmap, run.robot, episode, None, long_side=840, max_side=1280)
        view.line(episode.paths[0].poses[:, :2], PATH, 9)
        view.disc(episode.goals[-1][:2], 14, GOAL)
        self._view, self._picture = view, view.finish()
        self._outline = ENLARGED * run.robot.outline
        self._last: tuple[float, float] | None = None

    def draw(self, pose: Pose2D) -> Image.Image:
        """Draw the robot at its next pose, framed."""
        if self._last is not None:
            step = [self._last, (pose.x, pose.y)]
            self._view.line(step, DRIVEN, 9)
            self._view.refresh(self._picture, step, 12.0)
        self._last = (pose.x, pose.y)
        frame = self._picture.copy()
        self._view.stamp(frame, pose, self._outline, ROBOT)
        small = frame.resize((MAP_WIDTH, round(MAP_WIDTH * frame.height / frame.width)), Image.Resampling.LANCZOS)
        return ImageOps.expand(small, 2, EDGE)


def main() -> None:
    scenario = Scenario.make(world={"name": "warehouse"}, start=(-13.0, 0.0, 0.0), goal=(13.0, 4.0))
    mission, watch = scenario.build(), Watch()
    episode = mission.run(observers=[watch])
    print(episode.message)
    trajectory = episode.trajectory
    track, places = camera_track(trajectory.poses)
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(trajectory.poses[:, :2], axis=0).T))])
    model = SceneModel(
        mission.world,
        mission.robot,
        size=SIZE,
        path=episode.paths[0].poses,
        goal=episode.goals[-1].pose,
        samples=4,
        shadow_size=4096,
    )
    painter = open_painter(model.model, SIZE)
    small = SmallMap(watch.info, episode)
    times = np.arange(0.0, trajectory.time[-1], FRAME_S * FASTER)
    frames = []
    for time in times:
        row = int(np.searchsorted(trajectory.time, time))
        pose = Pose2D(*trajectory.poses[row].tolist())
        model.place(pose)
        camera = model.aim(aim(pose, float(driven[row]), track, places), pose)
        frame = Image.fromarray(painter.paint(model.data, camera))
        frame.paste(small.draw(pose), (MARGIN, MARGIN))
        frames.append(frame)
    painter.close()
    frames += frames[-1:] * HOLD
    file = Path(sys.argv[1]) / "driving.webp"
    for quality in (60, 50, 40, 30):
        more = {"append_images": frames[1:], "duration": round(1000 * FRAME_S), "loop": 0}
        frames[0].save(file, save_all=True, quality=quality, method=4, **more)
        if file.stat().st_size <= MAX_BYTES:
            break
    print(f"{file}: {len(frames)} pictures, {file.stat().st_size / 1000:.0f} kB, quality {quality}")


if __name__ == "__main__":
    main()
