"""Results of grid searches: `GridPath`, `PointPath`, and batches of both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Generic, Literal, TypeVar, cast, overload

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.geometry import FloatArray

Status = Literal["found", "unreachable", "timeout", "cancelled", "partial"]
STATUSES: tuple[Status, ...] = ("found", "unreachable", "timeout", "cancelled", "partial")
PARTIAL = STATUSES.index("partial")
_CORNER_BYTES = 8  # two 32-bit indices

CellArray = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class CellPath:
    """The result of a grid search.

    Attributes:
        status: "found"; "unreachable", when no path connects the cells; "timeout" or "cancelled", when it was stopped;
            "partial", when it leads to the reachable cell nearest to the goal, as it was asked to.
        length: Length in cells; infinite where the goal is unreachable, NaN where the search was stopped.
        corners: The bytes of `waypoints`.
        start_snapped: How far the start was moved to a free cell, in cells.
        goal_snapped: How far the goal was moved to a free cell, in cells.
        remaining: Straight distance from the end of a partial path to the goal, in cells; 0 otherwise.
    """

    status: Status
    length: float
    corners: bytes
    start_snapped: float = 0.0
    goal_snapped: float = 0.0
    remaining: float = 0.0

    def __repr__(self) -> str:
        corners = len(self.corners) // _CORNER_BYTES
        return f"{type(self).__name__}({self.status}, {self.length:.4g} cells, {corners} corners)"

    @property
    def cost(self) -> float:
        """The cost that was minimized: the length."""
        return self.length


class GridPath(CellPath):
    """A path from cell to cell; its length counts a diagonal step as √2."""

    __slots__ = ()

    @property
    def waypoints(self) -> CellArray:
        """Start, turning points and goal: (row, col), shape (M, 2), read-only. M is 0 where nothing was found."""
        return np.frombuffer(self.corners, dtype=np.int32).reshape(-1, 2)

    @property
    def cells(self) -> CellArray:
        """Every cell from start to goal: (row, col), shape (N, 2). N is 0 where nothing was found."""
        return _core.walk_corners(self.waypoints)


class PointPath(CellPath):
    """The path of a point from the centre of a cell to that of another; its length is Euclidean."""

    __slots__ = ()

    @property
    def waypoints(self) -> FloatArray:
        """Where the path begins, turns and ends: (row, col), shape (N, 2). N is 0 where nothing was found.

        The centre of a cell has its indices as coordinates, so that the ends are the start and the goal. The corner
        between cells (0, 0) and (1, 1) is (0.5, 0.5): the exact path turns at such corners of blocked cells.
        """
        half_cells = np.frombuffer(self.corners, dtype=np.int32).reshape(-1, 2)[:, ::-1]
        return 0.5 * (half_cells.astype(np.float64) - 1.0)


_PathT = TypeVar("_PathT", GridPath, PointPath)


@dataclass(frozen=True, slots=True, eq=False)
class CellPaths(Sequence[_PathT], Generic[_PathT]):
    """The results of many queries: a sequence of paths, and their numbers as arrays.

    Attributes:
        status: Status of each path, shape (N,).
        length: Length of each path in cells, shape (N,).
        corners: The corners of all, one after the other, shape (M, 2).
        ends: Where the corners of each end in `corners`, shape (N,).
        start_snapped: How far each start was moved to a free cell, in cells, shape (N,).
        goal_snapped: How far each goal was moved to a free cell, in cells, shape (N,).
        remaining: Straight distance from the end of each partial path to its goal, in cells, shape (N,).
    """

    _kind: ClassVar[type[CellPath]] = CellPath
    status: npt.NDArray[np.str_]
    length: FloatArray
    corners: CellArray
    ends: npt.NDArray[np.int64]
    start_snapped: FloatArray
    goal_snapped: FloatArray
    remaining: FloatArray

    def __repr__(self) -> str:
        found = int((self.status == "found").sum())
        return f"{type(self).__name__}({len(self)} paths, {found} found)"

    @property
    def cost(self) -> FloatArray:
        """The costs that were minimized: the lengths, shape (N,)."""
        return self.length

    def __len__(self) -> int:
        return len(self.length)

    @overload
    def __getitem__(self, index: int) -> _PathT: ...
    @overload
    def __getitem__(self, index: slice) -> list[_PathT]: ...
    def __getitem__(self, index: int | slice) -> _PathT | list[_PathT]:
        if isinstance(index, slice):
            return [self._path(i) for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} paths, and no path {index}")
        return self._path(index % len(self))

    def __iter__(self) -> Iterator[_PathT]:
        return (self._path(i) for i in range(len(self)))

    def _path(self, index: int) -> _PathT:
        first = int(self.ends[index - 1]) if index > 0 else 0
        path = self._kind(
            _BY_NAME[str(self.status[index])],
            float(self.length[index]),
            self.corners[first : int(self.ends[index])].tobytes(),
            float(self.start_snapped[index]),
            float(self.goal_snapped[index]),
            float(self.remaining[index]),
        )
        return cast("_PathT", path)


_BY_NAME: dict[str, Status] = {status: status for status in STATUSES}


class GridPaths(CellPaths[GridPath]):
    """The paths of `GridSearch.plan_many`."""

    __slots__ = ()
    _kind = GridPath


class PointPaths(CellPaths[PointPath]):
    """The paths of `GridSearch.any_angle_paths`."""

    __slots__ = ()
    _kind = PointPath
