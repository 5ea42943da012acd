"""The map of the built-in office as a world: from above, and as a run's video shows it.

    python docs/pictures/map_world.py docs/images/map_world.png

It needs an OpenGL driver: without one the frame of the video has no paths.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import trundle
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim.mover_history import ShownMovers
from trundle.viewer.scene import SceneFrames, render

SIZE = (800, 450)
GAP = 8
WHEN = 0.45  # share of the run at which the frame is taken


def main(path: str) -> None:
    robot = Robot.load("nova_carter")
    office = trundle.World.generate("office")
    grid = OccupancyGrid.from_world(office, resolution=0.05, z_range=robot.z_range)
    with tempfile.TemporaryDirectory() as folder:
        grid.save(Path(folder) / "map.yaml")
        scenario = trundle.Scenario(world=str(Path(folder) / "map.yaml"), robot="nova_carter")
        mission = scenario.build()
    with mission:
        above = render(mission.world, robot, mission.start, size=SIZE, camera="overview").pixels
        episode = mission.run()
        rows = np.linspace(0, len(episode.trajectory) - 1, 300).round().astype(np.intp)
        with SceneFrames(mission, episode, rows) as frames:
            poses = episode.trajectory.poses[rows[: round(WHEN * len(rows))]]
            for pose in poses.tolist():
                frame = frames.render(trundle.Pose2D(*pose), ShownMovers())
    picture = Image.new("RGB", (2 * SIZE[0] + GAP, SIZE[1]), "white")
    picture.paste(Image.fromarray(above), (0, 0))
    picture.paste(Image.fromarray(frame).resize(SIZE, Image.Resampling.LANCZOS), (SIZE[0] + GAP, 0))
    picture.quantize(128).save(path, optimize=True)


if __name__ == "__main__":
    main(sys.argv[1])
