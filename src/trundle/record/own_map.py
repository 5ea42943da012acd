"""Pictures of the map that a robot has made: with its poses and loops, and as it grew."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.costmap import Costmap, CostmapSettings
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, round_trinary
from trundle.mission.observers import Step
from trundle.mission.own_map import OwnMap, describe_corrections
from trundle.pictures.colors import ESTIMATED, GOOD, PAGE, PLANNED, ROBOT, START, WARNING
from trundle.pictures.colors import FREE as FREE_COLOR
from trundle.pictures.colors import OCCUPIED as WALL
from trundle.pictures.colors import UNKNOWN as DARK
from trundle.record.map_view import MapView
from trundle.record.page import Mark, compose_page
from trundle.record.video import FRAMES_PER_SECOND, caption, encode
from trundle.robots import Robot

_MOST_FRAMES = 300
_SIDE = 960  # of a frame of the growing map [px]
_RING = 12


def costmap_of(grid: OccupancyGrid, robot: Robot) -> Costmap:
    """Return the costmap of a map that a robot has made, to draw on."""
    return CostmapSettings().make_costmap(_trinary(grid), robot)


def draw_own_map(own: OwnMap, *, title: str) -> Image.Image:
    """Draw a map with the poses that it was made from, the loops that were closed, and the largest corrections.

    Args:
        own: The map.
        title: Headline.
    """
    view = MapView(_plain(own.grid))
    loops = 0
    graph = own.graph
    if graph is not None:
        for part in np.unique(graph.parts).tolist():
            view.line(graph.poses[graph.parts == part, :2], ESTIMATED, 3)
        pairs = [] if own.track is None else own.track.loops
        loops = len(pairs)
        for pair in pairs:
            view.line(graph.poses[pair, :2], PLANNED, 2)
        for point in graph.poses[:, :2].tolist():
            view.disc(point, 3, ESTIMATED)
        if len(graph.poses):
            view.disc(graph.poses[0, :2].tolist(), 9, START)
    for correction in own.corrections:
        view.ring((correction.x, correction.y), _RING, WARNING, 3)
    rows, cols = own.grid.shape
    edge = own.grid.resolution
    lines = [f"{cols * edge:.1f} x {rows * edge:.1f} m, cells of {edge:g} m"]
    if graph is not None:
        lines[0] += f" · {len(graph.poses)} poses, {len(graph.scan_nodes)} scans, {loops} loops"
    lines.append(f"largest corrections: {describe_corrections(own.corrections)}")
    marks = [Mark("square", WALL, "occupied"), Mark("square", DARK, "unknown")]
    if graph is not None:
        marks += [Mark("line", ESTIMATED, "poses"), Mark("line", PLANNED, "loops")]
    if own.corrections:
        marks.append(Mark("line", WARNING, "largest corrections"))
    return compose_page(
        view.finish(),
        title=title,
        status=("mapped", GOOD),
        lines=lines,
        legend=marks,
        pixels_per_metre=view.pixels_per_metre,
    )


def _plain(grid: OccupancyGrid) -> Costmap:
    """Return a map as a costmap without inflation."""
    point = np.array([(1e-3, 1e-3), (-1e-3, 1e-3), (-1e-3, -1e-3), (1e-3, -1e-3)])
    return Costmap.from_grid(_trinary(grid), point, 0.0)


def _trinary(grid: OccupancyGrid) -> OccupancyGrid:
    return OccupancyGrid(round_trinary(grid.data), grid.resolution, grid.origin)


class MapGrowth:
    """Keeps the map as it grew, for a video: of a long run, every second, every fourth map, and so on.

    A map takes a byte for eight cells and kind; there are 300 at most.
    """

    def __init__(self) -> None:
        self._frames: list[tuple[float, Pose2D, _Packed]] = []
        self._last: OccupancyGrid | None = None
        self._stride = 1
        self._count = 0

    def __len__(self) -> int:
        return len(self._frames)

    def on_step(self, step: Step) -> None:
        """Keep the map of a step if it is another one than before."""
        if step.map is None or step.map is self._last:
            return
        self._last = step.map
        self._count += 1
        if self._count % self._stride:
            return
        pose = step.state.pose if step.estimate is None else step.estimate.pose
        self._frames.append((step.state.time, pose, _Packed(step.map)))
        if len(self._frames) > _MOST_FRAMES:
            self._frames, self._stride = self._frames[1::2], 2 * self._stride

    def write(self, path: str | os.PathLike[str], final: OccupancyGrid, robot: Robot) -> str:
        """Write the video; as an animated GIF if PyAV is missing. The last picture is the map at the end.

        Returns:
            The name of the file that was written.

        Raises:
            OutputError: If it cannot be written.
        """
        return encode(path, self._pictures(final, robot), fps=FRAMES_PER_SECOND // 2)

    def pictures_at(self, times: Sequence[float], final: OccupancyGrid, robot: Robot) -> list[Image.Image]:
        """Return the map as it was at some times [s], with the drive so far, and as it is at the end."""
        shown = list(self._drawn(final, robot, holds=0))
        found = [next((one for time, one in shown if time >= wanted), shown[-1][1]) for wanted in times]
        return [*found, shown[-1][1]]

    def _pictures(self, final: OccupancyGrid, robot: Robot) -> Iterator[npt.NDArray[np.uint8]]:
        rate = self._rate()
        for time, picture in self._drawn(final, robot, holds=FRAMES_PER_SECOND):
            yield caption(np.asarray(picture), time, 0.0, rate)

    def _drawn(self, final: OccupancyGrid, robot: Robot, *, holds: int) -> Iterator[tuple[float, Image.Image]]:
        """Draw the maps, each with its time [s]; the one at the end is shown for so many frames more."""
        last = (*self._frames[-1][:2], _Packed(final)) if self._frames else (0.0, Pose2D(0.0, 0.0), _Packed(final))
        frames = [*self._frames, *[last] * (1 + holds)]
        low = np.min([packed.low for _, _, packed in frames], axis=0)
        high = np.max([packed.high for _, _, packed in frames], axis=0)
        scale = _SIDE / float((high - low).max())
        wide, tall = (max(2, int(side)) for side in np.ceil((high - low) * scale).tolist())
        trail: list[tuple[float, float]] = []
        for time, pose, packed in frames:
            picture = Image.new("RGB", (wide, tall), DARK)
            size = np.rint((packed.high - packed.low) * scale).astype(int).tolist()
            left, top = (packed.low[0] - low[0]) * scale, (high[1] - packed.high[1]) * scale
            picture.paste(packed.image().resize((max(1, size[0]), max(1, size[1]))), (round(left), round(top)))
            draw = ImageDraw.Draw(picture)
            trail.append(((pose.x - low[0]) * scale, (high[1] - pose.y) * scale))
            if len(trail) > 1:
                draw.line(trail, fill=ESTIMATED, width=2)
            outline = pose.transform_points(robot.outline)
            corners = [((x - low[0]) * scale, (high[1] - y) * scale) for x, y in outline.tolist()]
            draw.polygon(corners, fill=ROBOT, outline=PAGE)
            yield time, picture

    def _rate(self) -> float:
        if len(self._frames) < 2:
            return 1.0
        seconds = self._frames[-1][0] - self._frames[0][0]
        return seconds / (len(self._frames) - 1) * (FRAMES_PER_SECOND // 2)


class _Packed:
    """A map in two bits a cell."""

    def __init__(self, grid: OccupancyGrid) -> None:
        cells = round_trinary(grid.data)
        self._shape = cells.shape
        self._known, self._blocked = np.packbits(cells != UNKNOWN), np.packbits(cells == OCCUPIED)
        rows, cols = cells.shape
        self.low = np.array((grid.origin.x, grid.origin.y))
        self.high = self.low + np.array((cols, rows)) * grid.resolution

    def image(self) -> Image.Image:
        """Return a picture, a pixel for each cell, north up."""
        count = self._shape[0] * self._shape[1]
        known = np.unpackbits(self._known, count=count).reshape(self._shape).view(np.bool_)
        blocked = np.unpackbits(self._blocked, count=count).reshape(self._shape).view(np.bool_)
        cells = np.where(blocked, np.int8(OCCUPIED), np.where(known, np.int8(FREE), np.int8(UNKNOWN)))
        pixels = np.empty((*self._shape, 3), np.uint8)
        for value, color in ((UNKNOWN, DARK), (FREE, FREE_COLOR), (OCCUPIED, WALL)):
            pixels[cells == value] = color
        return Image.fromarray(np.ascontiguousarray(pixels[::-1]))
