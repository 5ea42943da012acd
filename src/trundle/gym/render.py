"""Pictures of an episode: as an array, and on the page in a browser."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray, Pose2D
from trundle.gym.episodes import Episodes
from trundle.maps.cells import FREE, OCCUPIED
from trundle.observation import Scan
from trundle.sim.lidar import beam_angles

SIDE = 480
"""Pixels along the longer side of a picture."""

_WALL, _FREE, _UNKNOWN = (54, 60, 72), (250, 250, 248), (196, 198, 202)
_ROBOT, _GOAL, _BEAM, _MOVER = (33, 108, 196), (34, 150, 92), (214, 92, 60), (190, 120, 30)


def draw_robot(episodes: Episodes, robot: int) -> npt.NDArray[np.uint8]:
    """Draw a robot on its map with its scan, its goal and the movers; uint8, shape (rows, cols, 3), north up."""
    sim, arena = episodes.sim, episodes.arena
    number = int(sim.places[robot, 0])
    grid = arena.grids[number]
    rows, cols = grid.shape
    scale = SIDE / max(rows, cols)
    colors = np.array([_UNKNOWN, _FREE, _WALL], dtype=np.uint8)
    kinds = np.where(grid.data == OCCUPIED, 2, np.where(grid.data >= FREE, 1, 0))[::-1]
    size = max(1, round(cols * scale)), max(1, round(rows * scale))
    picture = Image.fromarray(colors[kinds]).resize(size, Image.Resampling.BOX)
    draw = ImageDraw.Draw(picture)
    inverse = grid.origin.inverse()

    def pixels(points: FloatArray) -> list[tuple[float, float]]:
        local = inverse.transform_points(points) / grid.resolution * scale
        return [(float(x), float(size[1] - y)) for x, y in local]

    pose = Pose2D(*sim.poses[robot].tolist())
    for outline in mover_outlines(episodes, robot):
        draw.polygon(pixels(outline), fill=_MOVER)
    ends = np.concatenate([np.zeros((0, 2)), *(scan.points() for scan in scans_of(episodes, robot))])
    for x, y in pixels(pose.transform_points(ends)):
        draw.ellipse((x - 1.5, y - 1.5, x + 1.5, y + 1.5), fill=_BEAM)
    (x, y), radius = (
        pixels(episodes.arrays.host(episodes.goals[robot : robot + 1]))[0],
        episodes.settings.goal_tolerance,
    )
    ring = max(4.0, radius / grid.resolution * scale)
    draw.ellipse((x - ring, y - ring, x + ring, y + ring), outline=_GOAL, width=3)
    draw.polygon(pixels(pose.transform_points(arena.robot.planar.outline)), fill=_ROBOT)
    nose = np.array([(0.0, 0.0), (arena.robot.planar.circumscribed_radius, 0.0)])
    draw.line(pixels(pose.transform_points(nose)), fill=(255, 255, 255), width=2)
    return np.asarray(picture)


def scans_of(episodes: Episodes, robot: int) -> list[Scan]:
    """Return the last scans of a robot."""
    sim = episodes.sim
    now = float(sim.times[robot])
    return [
        Scan(
            name,
            now,
            Pose2D(lidar.x, lidar.y, lidar.yaw),
            lidar.z,
            beam_angles(lidar),
            episodes.arrays.host(sim.ranges[robot, columns]).astype(np.float64),
            lidar.range_min,
            lidar.range_max,
        )
        for name, lidar, columns in (
            (name, episodes.arena.robot.lidars[name], columns) for name, columns in sim.columns.items()
        )
    ]


def mover_outlines(episodes: Episodes, robot: int) -> list[FloatArray]:
    """Return the outlines of the movers around a robot, map frame [m]."""
    number = int(episodes.sim.places[robot, 1])
    if number < 0:
        return []
    recording = episodes.arena.recordings[number]
    ring = np.linspace(0.0, math.tau, 16, endpoint=False)
    disc = np.column_stack([np.cos(ring), np.sin(ring)])
    return [
        Pose2D(*pose).transform_points(disc * shape if isinstance(shape, float) else shape)
        for shape, pose in zip(recording.outlines, episodes.sim.movers(robot), strict=True)
    ]


class PagePicture:
    """The page in a browser, for one robot.

    Args:
        episodes: Its episodes.
    """

    def __init__(self, episodes: Episodes) -> None:
        from trundle.serve import show

        self._episodes = episodes
        self._map = int(episodes.sim.places[0, 0])
        self._show = show
        self._view = show(episodes.arena.grids[self._map], episodes.arena.robot)

    def update(self) -> None:
        """Show where the robot is; another page for another map."""
        number = int(self._episodes.sim.places[0, 0])
        if number != self._map:
            self._view.close()
            self._map, self._view = number, self._show(self._episodes.arena.grids[number], self._episodes.arena.robot)
        x, y = self._episodes.goals[0]
        self._view.goal = Pose2D(float(x), float(y))
        self._view.update(Pose2D(*self._episodes.sim.poses[0]), scan=scans_of(self._episodes, 0))

    def close(self) -> None:
        """Close the page."""
        self._view.close()
