"""`OccupancyGrid`: a ROS occupancy map in memory."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.geometry import Pose2D, format_pose
from trundle.maps.cells import FREE, MAX_CELLS, MAX_EXTENT, MAX_ORIGIN, OCCUPIED, SURFACES, UNKNOWN, Surface
from trundle.maps.frame import GridFrame
from trundle.values import as_number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trundle.maps.from_world import Bounds, Coverage, SolidWorld, Style
    from trundle.maps.height_field import HeightField
    from trundle.maps.occupancy import Compat, Mode


@dataclass(frozen=True, slots=True)
class OccupancyGrid(GridFrame):
    """Free, occupied and unknown cells with their pose in the map frame.

    Attributes:
        data: int8, shape (rows, cols) = (y, x), row 0 at the bottom, read-only; −1 unknown, 0 free .. 100 occupied.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame; its yaw rotates the whole grid.
        surface: Where the surface of what is drawn lies, which localisation needs to the centimetre: "border", at the
            border of the occupied cells (walls extruded from cells, or drawn on cell borders); "overlap", somewhere in
            the occupied cells at the rim, half a cell inside on average (cells that a solid reaches into); "centre",
            through their middle (maps built by driving).

    Raises:
        MapError: If the array has no cells or another shape, a value is outside −1..100, the resolution is not a
            positive number, the surface is none of these, or the map is wider than 100 km or its origin farther than a
            million km away.
    """

    data: npt.NDArray[np.int8]
    resolution: float
    origin: Pose2D = Pose2D(0.0, 0.0, 0.0)
    surface: Surface = "border"

    def __post_init__(self) -> None:
        try:
            source = np.asarray(self.data)
        except ValueError as error:
            raise MapError(f"an occupancy grid needs data of shape (rows, cols): {error}") from None
        if source.ndim != 2 or source.size == 0:
            raise MapError(f"an occupancy grid needs data of shape (rows, cols), got {source.shape}")
        if source.dtype.kind not in "iub" or source.min() < UNKNOWN or source.max() > OCCUPIED:
            raise MapError("an occupancy grid holds integers: -1 (unknown), and 0 (free) to 100 (occupied)")
        resolution = as_number(self.resolution, "resolution")
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise MapError(f"resolution must be a positive number of metres per cell, got {self.resolution}")
        extent = max(source.shape) * resolution
        if extent > MAX_EXTENT:
            raise MapError(
                f"{source.shape[1]} x {source.shape[0]} cells of {resolution:g} m are {extent / 1e3:g} km, and a map "
                f"may be {MAX_EXTENT / 1e3:g} km wide; correct the resolution, which is in metres per cell"
            )
        origin = Pose2D.of(self.origin)
        if max(abs(origin.x), abs(origin.y)) > MAX_ORIGIN:
            raise MapError(
                f"the origin ({origin.x:g}, {origin.y:g}) is more than {MAX_ORIGIN:g} m away, where "
                "coordinates cannot resolve cells; correct it"
            )
        if self.surface not in SURFACES:
            raise MapError(f"surface is {self.surface!r}; it must be one of {', '.join(SURFACES)}")
        data = np.array(source, dtype=np.int8, order="C", copy=True)
        data.flags.writeable = False
        object.__setattr__(self, "data", data)
        object.__setattr__(self, "resolution", resolution)
        object.__setattr__(self, "origin", origin)

    def __repr__(self) -> str:
        return f"OccupancyGrid({self._size_text()}, origin {format_pose(self.origin)})"

    def _repr_png_(self) -> bytes:
        """Show a picture in notebooks, with north up."""
        from trundle.pictures.cells import draw_cells
        from trundle.pictures.colors import occupancy_palette
        from trundle.pictures.figure import make_figure, to_png

        cells = self.data.view(np.uint8)
        order = [*range(OCCUPIED), *range(OCCUPIED + 1, 256), OCCUPIED]  # obstacles before unknown before free
        drawing, scale = draw_cells(cells, occupancy_palette(), order, self.resolution, self.origin)
        free, occupied, unknown = (100.0 * float((self.data == kind).mean()) for kind in (FREE, OCCUPIED, UNKNOWN))
        parts = f"{free:.1f} % free, {occupied:.1f} % occupied, {unknown:.1f} % unknown"
        return to_png(make_figure(drawing, scale, "Occupancy grid", [self._size_text(), parts]))

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        rows, cols = self.data.shape
        return rows, cols

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        *,
        compat: Compat | None = None,
        allow_outside: bool = False,
        max_cells: int | None = None,
    ) -> OccupancyGrid:
        """Read a ROS map (YAML and image), or a MovingAI map (suffix `.map`).

        Args:
            path: The map's YAML file.
            compat: "humble" reads thresholds, colour and alpha as Nav2 Humble did; None as current Nav2 does.
            allow_outside: Whether `image` may lie outside the YAML file's folder.
            max_cells: The most cells to accept; of an image of 16-bit colour or of text, fewer. A larger one is refused
                before it is decoded. If None, the limit is 20 million.

        Raises:
            MapError: If a file or a value in it is invalid; the message gives file, line and column.
        """
        from trundle.maps.ros_reader import load_map

        found = load_map(path, compat=compat, allow_outside=allow_outside, max_cells=max_cells)
        try:
            return cls(*found)
        except MapError as error:
            raise MapError(f"{Path(path)}: {error}") from error

    @classmethod
    def from_world(
        cls,
        world: SolidWorld,
        *,
        resolution: float = 0.05,
        z_range: tuple[float, float] = (0.10, 0.62),
        floor_z: float = 0.0,
        floor: HeightField | None = None,
        max_slope: float | None = None,
        bounds: Bounds | None = None,
        seeds: Sequence[tuple[float, float]] | None = None,
        coverage: Coverage = "any",
        style: Style = "exact",
        half_cell_origin: bool = False,
        margin: float = 0.0,
        max_cells: int = MAX_CELLS,
    ) -> OccupancyGrid:
        """Make the map of a world: its obstacles in a height band, seen from above.

        A cell is occupied if a solid reaches deeper than 1 µm into it in x, y and the band (exact: no cell is missed,
        none is added). A mesh is solid where its winding number is positive, so a closed body is filled, overlapping
        bodies are one, and a room whose faces point inward is empty. Of an open mesh only the surface is marked.
        Surfaces without thickness mark the cells that they touch. Of the other cells, those reached by a 4-connected
        flood fill from the seeds are free; the rest is unknown.

        With a `floor` the band follows it. Within each cell the floor is a plane plus bounds on the deviation from it.
        Over a level floor or a plane ramp the map is therefore as exact as over z = 0, and the ramp's own mesh, which
        ends at the floor, is not an obstacle. Over a curved floor or a step no obstacle is missed, and the band is
        extended by the deviation. Cylinders and spheres may be up to 0.1 mm, or a ten-thousandth of their radius, too
        large there. A cell in which the floor is steeper than `max_slope` anywhere is occupied: a step between two
        samples is a slope from one to the other. A cell in which the floor is not known everywhere is unknown, even if
        there is an obstacle.

        Args:
            world: Anything with `solids`, `bounds` and `seeds`.
            resolution: Edge of a cell [m].
            z_range: Lowest and highest height of the band above the floor [m]; by default the height of Nova Carter.
            floor_z: Height of the floor in the world [m].
            floor: Height of an uneven floor; instead of `floor_z`.
            max_slope: The steepest drivable floor [rad], with `floor`; by default 10 degrees.
            bounds: ((x_min, y_min), (x_max, y_max)) [m]; the lower corner is kept, the upper one moved out to whole
                cells. By default the world's, with both corners moved out to multiples of the resolution.
            seeds: Points (x, y) [m] that are free and reachable; (): the largest area without obstacles. By default the
                world's seeds inside the bounds, or the largest area if there are none.
            coverage: "any", or "centre" to mark only cells whose centre is inside a solid. Surfaces count as for "any".
            style: "exact" as above; "isaac" for comparison with Isaac Sim's generator: its query box for each cell
                extends half a cell above and below the band, touching it is enough, and meshes are surfaces.
            half_cell_origin: Whether to write the centre of the corner cell as the origin, as Isaac Sim does and ROS
                does not: ROS readers then place the map half a cell off.
            margin: Width [m] added around the bounds on all sides.
            max_cells: The most cells to accept.

        Raises:
            MapError: If an argument is out of range, the map would have too many cells, a seed lies outside, in an
                obstacle or where there is no floor, or the floor is unknown everywhere.

        Warns:
            MapWarning: If no solid reaches into the band within the bounds, no cell is free, a mesh in the band is not
                closed, the world is more than 2 km wide, or parts of the map have no known floor.
        """
        from trundle.maps.from_world import rasterise_world

        cells = rasterise_world(
            world,
            resolution=resolution,
            z_range=z_range,
            floor_z=floor_z,
            floor=floor,
            max_slope=max_slope,
            bounds=bounds,
            seeds=seeds,
            coverage=coverage,
            style=style,
            half_cell_origin=half_cell_origin,
            margin=margin,
            max_cells=max_cells,
        )
        return cls(*cells)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        mode: Mode = "trinary",
        image_format: Literal["png", "pgm"] = "png",
    ) -> None:
        """Write a ROS map: the YAML file at `path`, and its image of the same name beside it.

        If that name is taken, the image is named after a hash of its content, and the YAML refers to it. The YAML is
        written last, so an interrupted save leaves either the old map or the new one; then the old image is deleted.

        Args:
            path: Ends in .yaml or .yml; or in .map for a MovingAI map, which only has free and blocked cells.
            mode: "trinary" keeps occupied, free and unknown; "scale" adds shades between; "raw" keeps every value.
            image_format: "png", or "pgm" (not for mode "scale", which needs transparency).

        Raises:
            MapError: If the mode, the format or the file name is invalid.
            OutputError: If the folder cannot be written to. An existing map is left unchanged.
        """
        from trundle.maps.ros_writer import save_map

        save_map(self, path, mode=mode, image_format=image_format)
