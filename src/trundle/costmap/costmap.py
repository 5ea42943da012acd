"""`Costmap`: an occupancy grid seen by one robot, with Nav2's cost numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap.arguments import as_corners, as_footprint, as_poses, as_range, keepout_costs, slices_of, widen
from trundle.costmap.costs import (
    DEFAULT_COST_SCALING_FACTOR,
    DEFAULT_MARGIN_M,
    DEFAULT_UNKNOWN_COST,
    INSCRIBED,
    LETHAL,
    NO_INFORMATION,
    UnknownPolicy,
    check_inflation,
    check_unknown,
    check_unseen,
    cost_table,
    inflate,
    open_unknown,
    raise_unknown,
)
from trundle.errors import InputError, MapError
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.frame import GridFrame
from trundle.maps.grid import OccupancyGrid
from trundle.robots import Robot
from trundle.values import check_kind, is_finite_number, show_value

if TYPE_CHECKING:
    from trundle.maps.masks import KeepoutMask

_REMEMBERED_CHANGES = 16  # what was made of a costmap, such as a grid search, and missed more updates is made anew

_Item = TypeVar("_Item", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Costmap(GridFrame):
    """Traversal cost of each cell for one robot, and whether its footprint touches something.

    Costs are Nav2's: 0 free, 1..252 near something, 253 where the inscribed circle touches, 254 occupied, 255 unknown.
    Planning and checking treat cells of 255, and everything outside the map, as occupied. Whether unknown cells have
    255 is settled here, for planners, footprint checks and controllers alike: with `unknown` "free" or "costly" they
    have the costs of free ones.

    Attributes:
        data: uint8, shape (rows, cols) = (y, x), row 0 at the bottom, read-only.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame; its yaw turns the whole grid.
        footprint: Corners of the robot's convex outline in base_link [m], counter-clockwise, shape (N, 2), read-only.
        inflation_radius: Distance from an occupied or unknown cell up to which costs rise [m].
        cost_scaling_factor: Decay of the cost with distance [1/m].
        keepout: Lowest cost of each cell by the keep-out mask, uint8, shape (rows, cols), read-only; or None.
        unknown: How unknown cells are treated: "blocked", "free" or "costly".
        unknown_cost: Lowest cost of an unknown cell where they are costly, 0 to 252.
        unseen: The unknown cells, where they are free or costly: bool, shape (rows, cols), read-only; else None.
        planar: The footprint as a value: its outline, its radii, and how to pad it.
        version: Another object for every costmap, to ask its successors what changed since (`changes_since`).

    Raises:
        MapError: If the costs are not a uint8 array of shape (rows, cols), or the resolution is not positive; or the
            keep-out costs or `unseen` are of another kind.
        InputError: If the footprint is no convex outline around base_link, or an inflation number is out of range.
    """

    data: npt.NDArray[np.uint8]
    resolution: float
    origin: Pose2D
    footprint: FloatArray
    inflation_radius: float
    cost_scaling_factor: float = DEFAULT_COST_SCALING_FACTOR
    keepout: npt.NDArray[np.uint8] | None = None
    unknown: UnknownPolicy = "blocked"
    unknown_cost: int = DEFAULT_UNKNOWN_COST
    unseen: npt.NDArray[np.bool_] | None = None
    planar: Footprint = field(init=False, repr=False)
    version: object = field(init=False, repr=False)
    _changes: tuple[tuple[object, tuple[slice, slice]], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            data = np.asarray(self.data)
        except ValueError as error:
            raise MapError(f"a costmap needs uint8 costs of shape (rows, cols): {error}") from None
        if data.ndim != 2 or data.size == 0 or data.dtype != np.uint8:
            raise MapError(f"a costmap needs uint8 costs of shape (rows, cols), got {data.dtype} {data.shape}")
        if not (is_finite_number(self.resolution) and self.resolution > 0.0):
            raise MapError(
                f"resolution must be a positive number of metres per cell, got {show_value(self.resolution)}"
            )
        resolution = float(self.resolution)
        keepout = self.keepout
        if keepout is not None:
            if keepout.shape != data.shape or keepout.dtype != np.uint8:
                raise MapError(f"keepout needs uint8 costs of shape {data.shape}, got {keepout.dtype} {keepout.shape}")
            object.__setattr__(self, "keepout", _frozen(keepout))
        check_unknown(self.unknown, self.unknown_cost)
        check_unseen(self.unknown, self.unseen, data.shape)
        if self.unseen is not None:
            object.__setattr__(self, "unseen", _frozen(self.unseen))
        data = _frozen(data)
        planar = as_footprint(self.footprint)
        object.__setattr__(self, "data", data)
        object.__setattr__(self, "resolution", resolution)
        object.__setattr__(self, "origin", Pose2D.of(self.origin))
        object.__setattr__(self, "footprint", planar.outline)
        object.__setattr__(self, "planar", planar)
        object.__setattr__(self, "version", object())
        object.__setattr__(self, "_changes", ())
        check_inflation(self.inflation_radius, self.cost_scaling_factor, resolution)

    def __repr__(self) -> str:
        return f"Costmap({self._size_text()}, inflation {self.inflation_radius:.4g} m, unknown {self.unknown})"

    def _repr_png_(self) -> bytes:
        """Show a picture in notebooks, with north up."""
        from trundle.pictures.cells import Tint, draw_cells
        from trundle.pictures.colors import COST_ORDER, KEPT_OUT, UNKNOWN, cost_palette
        from trundle.pictures.figure import make_figure, to_png

        tints: list[Tint] = []
        if self.unseen is not None:
            tints.append(Tint(self.unseen & (self.data < INSCRIBED), UNKNOWN, 0.5))
        if self.keepout is not None:
            tints.append(Tint(self.keepout == LETHAL, KEPT_OUT, 1.0))
        drawing, scale = draw_cells(self.data, cost_palette(), COST_ORDER, self.resolution, self.origin, tints)
        inflation = f"inflation radius {self.inflation_radius:.4g} m, unknown cells {self.unknown}"
        return to_png(make_figure(drawing, scale, "Costmap", [self._size_text(), inflation]))

    @classmethod
    def from_grid(
        cls,
        grid: OccupancyGrid,
        footprint: Robot | Footprint | npt.ArrayLike,
        inflation_radius: float | None = None,
        cost_scaling_factor: float = DEFAULT_COST_SCALING_FACTOR,
        *,
        keepout: KeepoutMask | None = None,
        unknown: UnknownPolicy = "blocked",
        unknown_cost: int = DEFAULT_UNKNOWN_COST,
    ) -> Costmap:
        """Inflate a map for a robot.

        As in Nav2's static layer with `trinary_costmap`, only 100 is occupied: 1 to 99 are free. Distances are exact
        and between the centres of cells; unknown cells that block inflate like occupied ones. Up to the inscribed
        radius a cell costs 253 whatever the inflation radius is, then
        `int(252 · exp(−k · (d − inscribed radius)))` up to the inflation radius, and 0 beyond.

        Args:
            grid: The map.
            footprint: A robot, its `Footprint`, or the corners of its convex outline in base_link [m], shape (N, 2).
            inflation_radius: [m]. If None, the circumscribed radius + 0.3 m, so that costs keep the tail clear.
            cost_scaling_factor: k above [1/m].
            keepout: Cells that it keeps out are lethal and inflate like occupied ones, so that no part of the robot
                gets in. Cells where it has 1 to 99 cost more. Other unknown cells stay unknown.
            unknown: How unknown cells are treated, as with Nav2's `allow_unknown` and `track_unknown_space`.
                "blocked": they cost 255 and inflate; no part of the robot gets there. "free": like free cells.
                "costly": like free cells, with a cost of at least `unknown_cost`.
            unknown_cost: For "costly", from 0 to 252; `least_cost` and `hybrid_astar` weigh it as they do all costs.

        Raises:
            InputError: If the grid is none, the footprint is no convex outline around base_link, or an option is out
                of range.
            MapError: If the mask lies beside the map.
        """
        check_kind(grid, OccupancyGrid, "a costmap's map", "OccupancyGrid.load(path) reads one")
        planar = as_footprint(footprint)
        radius = planar.circumscribed_radius + DEFAULT_MARGIN_M if inflation_radius is None else inflation_radius
        check_inflation(radius, cost_scaling_factor, grid.resolution)
        floor = None if keepout is None else keepout_costs(keepout, grid)
        check_unknown(unknown, unknown_cost)
        style = CostmapStyle(planar, float(radius), float(cost_scaling_factor), unknown, unknown_cost)
        return style.make(grid.data, grid.resolution, grid.origin, floor)

    def update(self, rows: slice, cols: slice, occupancy: npt.ArrayLike) -> Costmap:
        """Make a costmap in which a rectangle of the map has new occupancy; this one does not change.

        It equals a new costmap of the changed map, and takes a copy of the bytes and an inflation around the
        rectangle. The keep-out mask still holds there.

        Args:
            rows: Which rows, without a step.
            cols: Which columns, without a step.
            occupancy: Their new values as in an `OccupancyGrid`, −1 to 100: of the rectangle's shape, or one for all.

        Raises:
            InputError: If the rectangle is empty or not within the map, or the values are none of these.
        """
        row, row_end = as_range(rows, "rows", self.shape[0])
        col, col_end = as_range(cols, "cols", self.shape[1])
        try:
            values = np.asarray(occupancy)
        except ValueError as error:
            raise InputError(f"the values of a rectangle must be an array: {error}") from None
        size = row_end - row, col_end - col
        if values.dtype.kind not in "iub" or values.shape not in ((), size):
            raise InputError(f"a rectangle of {size} needs integers of this shape or one, got {values.shape}")
        if values.size and (values.min() < UNKNOWN or values.max() > OCCUPIED):
            raise InputError("occupancy goes from -1 (unknown) over 0 (free) to 100 (occupied)")
        table = cost_table(self.inscribed_radius, self.inflation_radius, self.cost_scaling_factor, self.resolution)
        reach = math.isqrt(len(table) - 1)
        # What the rectangle can change, and what that depends on.
        changed = widen((row, row_end, col, col_end), reach, self.shape)
        window = widen(changed, reach, self.shape)
        old = self.data[slices_of(window)]
        cells = (old == LETHAL).view(np.int8) * np.int8(OCCUPIED)  # the others are free
        cells += (old == NO_INFORMATION).view(np.int8) * np.int8(UNKNOWN)
        cells[row - window[0] : row_end - window[0], col - window[2] : col_end - window[2]] = values
        floor = None if self.keepout is None else self.keepout[slices_of(window)]
        unseen = None if self.unseen is None else self.unseen.copy()
        if unseen is not None:
            unseen[row:row_end, col:col_end] = values == UNKNOWN
            unseen.flags.writeable = False
            np.maximum(cells, np.int8(FREE), out=cells)
        costs = inflate(cells, table, floor)
        if unseen is not None and self.unknown == "costly":
            costs = raise_unknown(costs, unseen[slices_of(window)], self.unknown_cost)
        data = self.data.copy()
        data[slices_of(changed)] = costs[
            changed[0] - window[0] : changed[1] - window[0], changed[2] - window[2] : changed[3] - window[2]
        ]
        data.flags.writeable = False
        successor = replace(self, data=data, footprint=self.planar, unseen=unseen)
        changes = (*self._changes, (self.version, slices_of(changed)))
        object.__setattr__(successor, "_changes", changes[-_REMEMBERED_CHANGES:])
        return successor

    def changes_since(self, version: object) -> list[tuple[slice, slice]] | None:
        """Return rectangles (rows, cols) that hold every cell whose cost has changed since a costmap of this `version`.

        They are known for the last 16 calls of `update`; for versions before that, it returns None.
        """
        for index, (before, _) in enumerate(self._changes):
            if before is version:
                return [window for _, window in self._changes[index:]]
        return [] if version is self.version else None

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        rows, cols = self.data.shape
        return rows, cols

    @property
    def inscribed_radius(self) -> float:
        """Distance [m] from base_link to the nearest edge of the footprint."""
        return self.planar.inscribed_radius

    @property
    def circumscribed_radius(self) -> float:
        """Distance [m] from base_link to the farthest corner of the footprint."""
        return self.planar.circumscribed_radius

    @property
    def unknown_cells(self) -> npt.NDArray[np.bool_]:
        """Which cells are unknown, however they are treated, shape (rows, cols)."""
        return self.data == NO_INFORMATION if self.unseen is None else self.unseen

    def cost_at(self, x: npt.ArrayLike, y: npt.ArrayLike) -> npt.NDArray[np.uint8]:
        """Return the costs at points x, y [m] in the map frame, of any one shape; 255 (unknown) outside the map."""
        row, col = self.world_to_cell(x, y)
        inside = self.contains(row, col)
        costs = self.data[np.where(inside, row, 0), np.where(inside, col, 0)]
        return np.where(inside, costs, np.uint8(NO_INFORMATION))

    def footprint_collides(
        self, poses: npt.ArrayLike, *, outline: npt.ArrayLike | None = None
    ) -> npt.NDArray[np.bool_]:
        """Test at each of many poses whether the footprint touches a cell of 254 or 255, or leaves the map.

        The oriented outline is tested exactly against the squares of the cells; contact shallower than 1e-9 m is none.

        Args:
            poses: (x, y, yaw) [m, m, rad], map frame, shape (N, 3) or (3,). A pose that is not finite collides.
            outline: A convex outline instead of the robot's, e.g. with a margin, shape (M, 2), counter-clockwise.

        Returns:
            Shape (N,).

        Raises:
            InputError: If the poses or the outline have another shape, or the outline is not finite.
        """
        corners = self.footprint if outline is None else as_corners(outline)
        return _core.footprint_collides(self.data, self.resolution, *self.origin.as_tuple(), corners, as_poses(poses))

    def footprint_sweeps(
        self, first: npt.ArrayLike, last: npt.ArrayLike, *, outline: npt.ArrayLike | None = None
    ) -> FloatArray:
        """Return how far each of many motions goes before the footprint touches a cell of 254 or 255 or leaves the map.

        During a motion position and yaw change evenly from the first pose to the last. All that the outline sweeps
        over is tested, not only sampled poses: a motion reported as free is free all along, except for contact
        shallower than 1e-9 m. Straight lines are tested exactly. A turn may be reported as blocked where it passes
        something by less than 0.01 mm.

        Args:
            first: First poses (x, y, yaw) [m, m, rad], map frame, shape (N, 3) or (3,).
            last: Last poses, likewise. Yaws are not wrapped: from 0 to −3 is a clockwise turn, from 0 to 2π a full one.
            outline: A convex outline instead of the robot's, shape (M, 2), counter-clockwise.

        Returns:
            The share of each motion before the first contact, 0 to 1; infinity where all of it is free; shape (N,).

        Raises:
            InputError: If the poses or the outline have another shape, or the outline is not convex.
        """
        corners = self.footprint if outline is None else as_corners(outline)
        ends = as_poses(first), as_poses(last)
        if len(ends[0]) != len(ends[1]):
            raise InputError(f"each motion needs two poses; got {len(ends[0])} first and {len(ends[1])} last ones")
        try:
            return _core.footprint_sweep(self.data, self.resolution, *self.origin.as_tuple(), corners, *ends)
        except ValueError as error:
            raise InputError(str(error)) from None

    def clearance(self, poses: npt.ArrayLike, cap: float = 2.0, *, outline: FloatArray | None = None) -> FloatArray:
        """Measure the distance [m] from the oriented footprint to the nearest cell of 254 or 255 or the map's edge.

        Args:
            poses: (x, y, yaw) [m, m, rad], map frame, shape (N, 3) or (3,).
            cap: Larger distances are reported as this [m].
            outline: Measured from this outline [m] instead of the footprint: base_link, convex, shape (M, 2).

        Returns:
            Shape (N,); 0 where the footprint touches something.

        Raises:
            InputError: If `cap` is not a positive number.
        """
        if not (is_finite_number(cap) and cap > 0.0):
            raise InputError(f"cap must be a positive number of metres, got {show_value(cap)}")
        corners = self.footprint if outline is None else outline
        return _core.footprint_clearance(
            self.data, self.resolution, *self.origin.as_tuple(), corners, as_poses(poses), float(cap)
        )


@dataclass(frozen=True, slots=True, eq=False)
class CostmapStyle:
    """The settings by which a costmap is made of occupancy; they are checked already.

    Attributes:
        planar, inflation_radius, cost_scaling_factor, unknown, unknown_cost: As in `Costmap`.
    """

    planar: Footprint
    inflation_radius: float
    cost_scaling_factor: float
    unknown: UnknownPolicy
    unknown_cost: int

    def make(
        self,
        occupancy: npt.NDArray[np.int8],
        resolution: float,
        origin: Pose2D,
        floor: npt.NDArray[np.uint8] | None,
    ) -> Costmap:
        """Make the costmap of occupancy, −1 to 100, and of the lowest costs by a keep-out mask, both of one shape."""
        table = cost_table(self.planar.inscribed_radius, self.inflation_radius, self.cost_scaling_factor, resolution)
        cells, unseen = (occupancy, None) if self.unknown == "blocked" else open_unknown(occupancy)
        data = inflate(cells, table, floor)
        if self.unknown == "costly" and unseen is not None:
            data = raise_unknown(data, unseen, self.unknown_cost)
        for array in (data, unseen):
            if array is not None:
                array.flags.writeable = False
        checked: Any = self.planar
        return Costmap(
            data,
            resolution,
            origin,
            checked,
            self.inflation_radius,
            self.cost_scaling_factor,
            keepout=floor,
            unknown=self.unknown,
            unknown_cost=self.unknown_cost,
            unseen=unseen,
        )


def _frozen(data: npt.NDArray[_Item]) -> npt.NDArray[_Item]:
    """Return the array itself if it is read-only and contiguous, else a copy."""
    if data.flags.writeable or not data.flags.c_contiguous:
        data = np.array(data, order="C", copy=True)
        data.flags.writeable = False
    return data
