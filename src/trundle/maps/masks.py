"""`KeepoutMask` and `SpeedMask`: zones painted as ROS maps, as Nav2's costmap filters read them.

A mask lies in the map frame with its own resolution, origin and size. In Nav2 the costmap filter info server defines
the meaning of a speed mask's values; here the mask's YAML may define it with the same keys `type`, `base` and
`multiplier`, which Nav2's map server ignores.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Literal, TypeAlias, cast, get_args

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, VALUES, count_values
from trundle.maps.frame import GridFrame
from trundle.maps.grid import OccupancyGrid
from trundle.maps.occupancy import Compat
from trundle.maps.resample import CellLayout, resample

SpeedUnit: TypeAlias = Literal["percent", "absolute"]

_LETHAL = 254  # the cost of an obstacle in a costmap
_KEEPOUT_TYPE = 0
_SPEED_TYPES: dict[int, SpeedUnit] = {1: "percent", 2: "absolute"}
_KINDS = {0: "a keep-out mask", 1: "a speed mask in percent", 2: "a speed mask in m/s", 3: "a binary mask"}
"""`type` of Nav2's costmap filter info."""
_LARGEST = 1e6  # of base and multiplier: more is a mistake


@dataclass(frozen=True, slots=True, eq=False)
class KeepoutMask:
    """Zones that the robot must not enter, or should avoid.

    Cells of 100 are lethal: no part of the robot may touch them. A cell of 1 to 99 is free, but costs at least
    `254 · value / 100`, as in Nav2's keepout filter. 0, unknown cells and the area outside the mask change nothing.

    Attributes:
        grid: The mask, in the map frame.
        name: Its source, for messages.

    Raises:
        MapError: If `grid` is not an `OccupancyGrid`.
    """

    grid: OccupancyGrid
    name: str = "the keep-out mask"

    def __post_init__(self) -> None:
        _check_grid(self.grid, self.name)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], *, compat: Compat | None = None, max_cells: int | None = None
    ) -> KeepoutMask:
        """Read a mask as a ROS map.

        Raises:
            MapError: If it cannot be read, or its YAML declares another kind of mask.
        """
        kind, fields = _read_info(path)
        if kind not in (None, _KEEPOUT_TYPE) or (fields.get("base", 0.0), fields.get("multiplier", 1.0)) != (0.0, 1.0):
            what = f"type {kind}, {_KINDS[kind]}" if kind else f"{' and '.join(fields)}, as a speed mask has"
            raise MapError(f"{os.fspath(path)}: not a keep-out mask: it has {what}; use it as such")
        return cls(OccupancyGrid.load(path, compat=compat, max_cells=max_cells), os.fspath(path))

    def costs_on(self, frame: GridFrame) -> npt.NDArray[np.uint8]:
        """Return lower bounds of the costs of another grid's cells: 254 where they touch a keep-out cell at all.

        Returns:
            uint8, shape `frame.shape`, read-only.

        Raises:
            MapError: If the mask does not overlap the grid.
        """
        check_overlap(self.grid, frame, self.name)
        # A border of free cells, so that cells partly outside the mask do not become unknown.
        rim = math.ceil(math.sqrt(2.0) * frame.resolution / self.grid.resolution) + 1
        cells = np.pad(np.maximum(self.grid.data, FREE), rim)
        corner = self.grid.origin @ Pose2D(-rim * self.grid.resolution, -rim * self.grid.resolution)
        # In the frame of the grid, which is then aligned with the axes.
        placed = OccupancyGrid(cells, self.grid.resolution, frame.origin.inverse() @ corner)
        layout = CellLayout(frame.resolution, Pose2D(0.0, 0.0), *frame.shape)
        values = np.maximum(resample(placed, layout).cells, FREE)
        costs = np.round(np.arange(OCCUPIED + 1) * (_LETHAL / OCCUPIED)).astype(np.uint8)[values]
        costs.flags.writeable = False
        return costs


@dataclass(frozen=True, slots=True, eq=False)
class SpeedMask:
    """Speed limits by the position of the robot's base_link.

    The limit in a cell is `base + multiplier · value`, in percent of the robot's top speed or in m/s. A value of 0
    means no limit, as does the area outside the mask. Limits of 0 or less, limits above 100 % and unknown cells, which
    Nav2 treats as no limit with a warning, are refused.

    Attributes:
        grid: The mask, in the map frame.
        unit: "percent", Nav2's type 1, or "absolute" (m/s), its type 2.
        base: [% or m/s].
        multiplier: [% or m/s per unit of the mask]; 100 and −1 make darker paint slower in a mask of mode scale.
        name: Its source, for messages.

    Raises:
        MapError: If a cell has an invalid limit, the unit is unknown, or `grid` is not an `OccupancyGrid`.
    """

    grid: OccupancyGrid
    unit: SpeedUnit = "percent"
    base: float = 0.0
    multiplier: float = 1.0
    name: str = "the speed mask"

    def __post_init__(self) -> None:
        _check_grid(self.grid, self.name)
        if self.unit not in get_args(SpeedUnit):
            raise MapError(f'{self.name}: unit is {self.unit!r}; it must be "percent" or "absolute" (m/s)')
        if not (math.isfinite(self.base) and math.isfinite(self.multiplier)):
            raise MapError(f"{self.name}: base and multiplier must be finite, got {self.base} and {self.multiplier}")
        most, mark = (100.0, "%") if self.unit == "percent" else (math.inf, "m/s")
        for value in VALUES[count_values(self.grid.data) > 0].tolist():
            limit = self.base + self.multiplier * value
            if value == UNKNOWN:
                found = "is unknown, which defines no speed"
            elif value == FREE or 0.0 < limit <= most:
                continue
            else:
                found = f"has {value}, a limit of {self.base:g} + {self.multiplier:g} · {value} = {limit:g} {mark}"
            row, col = (int(index) for index in np.argwhere(self.grid.data == value)[0])
            x, y = self.grid.cell_to_world(row, col)
            allowed = f"above 0 and at most {most:g} %" if self.unit == "percent" else "above 0 m/s"
            raise MapError(
                f"{self.name}: the cell at ({x:.2f}, {y:.2f}) {found}; a limit must be {allowed}. Paint white where "
                "there is no limit (0), correct base and multiplier, or use mode scale or raw for shades; to block an "
                "area, use a keep-out mask"
            )

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        *,
        unit: SpeedUnit | None = None,
        base: float | None = None,
        multiplier: float | None = None,
        compat: Compat | None = None,
        max_cells: int | None = None,
    ) -> SpeedMask:
        """Read a mask as a ROS map. Arguments not given are taken from its YAML, else from Nav2: percent, 0 and 1.

        Raises:
            MapError: If it cannot be read, is another kind of mask, or has an invalid limit.
        """
        kind, fields = _read_info(path)
        if kind is not None and kind not in _SPEED_TYPES:
            raise MapError(
                f"{os.fspath(path)}: type {kind}, {_KINDS[kind]}, is not a speed mask; "
                "write type: 1 for percent or type: 2 for m/s"
            )
        said = "percent" if kind is None else _SPEED_TYPES[kind]
        return cls(
            OccupancyGrid.load(path, compat=compat, max_cells=max_cells),
            said if unit is None else unit,
            fields.get("base", 0.0) if base is None else float(base),
            fields.get("multiplier", 1.0) if multiplier is None else float(multiplier),
            os.fspath(path),
        )

    def limits(self, top_speed: float) -> FloatArray:
        """Return limits [m/s] of the values 0 to 100 for a robot's top speed [m/s]; infinite for 0. Shape (101,)."""
        values = self.base + self.multiplier * np.arange(OCCUPIED + 1)
        limits = values * (top_speed / 100.0) if self.unit == "percent" else values
        limits[FREE] = np.inf
        return cast("FloatArray", limits)

    def limit_at(self, x: npt.ArrayLike, y: npt.ArrayLike, top_speed: float) -> FloatArray:
        """Return limits [m/s] at points x, y [m] in the map frame, of one shape; infinite where there are none."""
        row, col = self.grid.world_to_cell(x, y)
        inside = self.grid.contains(row, col)
        values = np.where(inside, self.grid.data[np.where(inside, row, 0), np.where(inside, col, 0)], FREE)
        return self.limits(top_speed)[values]


def check_overlap(grid: OccupancyGrid, frame: GridFrame, name: str) -> None:
    """Raise `MapError` if a mask does not overlap a map."""
    # Separating-axis test: disjoint rectangles are separated by a side of one of them.
    for one, other in ((grid, frame), (frame, grid)):
        corners = one.origin.inverse().transform_points(_corners(other))
        size = np.array([one.shape[1], one.shape[0]]) * one.resolution
        if (corners.max(axis=0) <= 1e-9).any() or (corners.min(axis=0) >= size - 1e-9).any():
            raise MapError(
                f"{name}: the mask does not overlap the map: it covers {_extent(grid)}, the map {_extent(frame)}; "
                "correct its origin and resolution"
            )


def _check_grid(grid: object, name: str) -> None:
    if not isinstance(grid, OccupancyGrid):
        raise MapError(f"{name} needs an OccupancyGrid, got {type(grid).__name__}")


def _corners(frame: GridFrame) -> FloatArray:
    rows, cols = frame.shape
    return frame.origin.transform_points(np.array([[0, 0], [cols, 0], [cols, rows], [0, rows]]) * frame.resolution)


def _extent(frame: GridFrame) -> str:
    (x0, y0), (x1, y1) = (f(_corners(frame), axis=0) for f in (np.min, np.max))
    return f"x {x0:.2f} to {x1:.2f}, y {y0:.2f} to {y1:.2f}"


def _read_info(path: str | os.PathLike[str]) -> tuple[int | None, dict[str, float]]:
    """Read Nav2's keys in a mask's YAML: its `type`, and `base` and `multiplier` if present."""
    from trundle.maps.ros_yaml import read_fields

    if not isinstance(path, str | os.PathLike):
        raise MapError(
            f"a mask is loaded from the path of its YAML, got {type(path).__name__}; "
            "KeepoutMask(grid) and SpeedMask(grid) make one from an OccupancyGrid"
        )
    try:
        fields = read_fields(path)
    except MapError:
        return None, {}  # It may not be a YAML file; the map reader reports the problem.
    kind: int | None = None
    if "type" in fields.nodes:
        number = fields.number("type", low=0, high=_LARGEST)
        if number not in _KINDS:
            kinds = ", ".join(f"{key} ({what})" for key, what in _KINDS.items())
            raise MapError(f"{fields.place('type')}: type is {number:g}; it must be one of {kinds}")
        kind = int(number)
    numbers = {
        key: fields.number(key, low=-_LARGEST, high=_LARGEST) for key in ("base", "multiplier") if key in fields.nodes
    }
    return kind, numbers
