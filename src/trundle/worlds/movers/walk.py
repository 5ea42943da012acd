"""`CrowdWalk`: the crowds of a world while a run goes on, stepped by the kernel."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle._core import CrowdFloor, CrowdModel, CrowdRun, inflate, label_components
from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid, solids_bounds
from trundle.maps.rasterise import HeightBand, SolidRaster
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of, radius_of, top_of

# Edge of a cell [m], as in the usual maps; it grows in larger worlds, which bounds the number of cells.
_RESOLUTION = 0.05
_MOST_CELLS = 1_000_000
_FLOOR_TOP = 0.05  # what is not higher is driven over [m]
WALL = 255
"""The cost of a cell that is impassable."""

_BASE, _EXTRA, _DECAY_M = 10.0, 60.0, 0.4  # what a cell costs: paths keep off solids where there is room
_NEAR_M = 1.2  # solids that are farther than this from the disc are not felt [m]
_AHEAD_M = 0.3  # how far along its path somebody looks [m]


class FloorArrays(NamedTuple):
    """Where members of a crowd can be, as `CrowdFloor` takes it.

    Attributes:
        costs: Of a path through each cell, `WALL` where it is blocked, shape (rows, cols); the rim is blocked.
        nearness: Of solids: 255 in them, 0 from `reach` on, shape (rows, cols).
        corner_x, corner_y: The corner of cell (0, 0) [m].
        resolution: Edge of a cell [m].
        reach: Distance from which solids are not felt [m].
        look: How many cells ahead on its path somebody goes for.
    """

    costs: npt.NDArray[np.uint8]
    nearness: npt.NDArray[np.uint8]
    corner_x: float
    corner_y: float
    resolution: float
    reach: float
    look: int


def make_floor(
    solids: Sequence[Solid], bounds: tuple[float, float, float, float], radius: float, top: float
) -> FloorArrays | None:
    """Return where a disc is clear of a world's solids, as far as one can get from the largest such area.

    Args:
        solids: The world's solids.
        bounds: (x0, y0, x1, y1) [m], which the disc does not leave.
        radius: Radius of the disc [m].
        top: Solids that start above this height do not matter [m].

    Returns:
        The floor, or None where there is no such place.
    """
    x0, y0, x1, y1 = bounds
    edge = max(_RESOLUTION, math.sqrt((x1 - x0) * (y1 - y0) / _MOST_CELLS))
    rows, cols = math.ceil((y1 - y0) / edge) + 2, math.ceil((x1 - x0) / edge) + 2
    occupied = np.zeros((rows, cols), dtype=np.int8)
    band = HeightBand(_FLOOR_TOP, max(top, 2 * _FLOOR_TOP))
    SolidRaster(occupied, edge, (x0 - edge, y0 - edge), band).add(solids)
    occupied[[0, -1], :] = occupied[:, [0, -1]] = 100
    # Between the middles of two cells; points in them may be nearer by a diagonal.
    least = radius + math.sqrt(2.0) * edge
    reach = least + _NEAR_M
    distances = np.sqrt(np.arange(int((reach / edge) ** 2) + 1)) * edge
    costs = _BASE + _EXTRA * np.exp(-np.maximum(0.0, distances - least) / _DECAY_M)
    costs[distances <= least] = WALL
    through = np.maximum(inflate(occupied, costs.astype(np.uint8)), np.uint8(_BASE))
    through[occupied != 0] = WALL
    nearness = inflate(occupied, np.round(255.0 * (1.0 - distances / reach)).astype(np.uint8))
    labels, table = label_components((through != WALL).view(np.uint8), False)
    if len(table) == 0:
        return None
    through[labels != int(np.argmax(table[:, 0])) + 1] = WALL
    look = max(1, round(_AHEAD_M / edge))
    return FloorArrays(through, nearness, x0 - edge, y0 - edge, edge, reach, look)


class CrowdArrays(NamedTuple):
    """What `CrowdModel` is made of, as that takes it but for the floors."""

    floors: list[FloorArrays]
    counts: npt.NDArray[np.int64]
    members: FloatArray
    corners: FloatArray
    corner_counts: npt.NDArray[np.int64]
    mover_radii: FloatArray


PERIOD_S = 0.05
"""Crowds are stepped at this period; between two steps they move straight at constant speed."""


class RobotMotion(NamedTuple):
    """Place and speed of the robot, for those who see it.

    Attributes:
        x, y: Position [m], map frame.
        vx, vy: Velocity [m/s], map frame.
        radius: Radius of its circumscribed circle [m].
    """

    x: float
    y: float
    vx: float
    vy: float
    radius: float


class CrowdWalk:
    """Steps crowds through a run; the same seed and robot give the same steps.

    Args:
        crowds: The crowds.
        movers: Others that move, by functions of time; crowds keep clear of them, too.
        solids: The world's solids.

    Raises:
        WorldError: If there is no room for a crowd.
    """

    def __init__(self, crowds: Sequence[Crowd], movers: Sequence[Mover], solids: Sequence[Solid]) -> None:
        self._crowds, self._movers = tuple(crowds), tuple(movers)
        self.names = [name for crowd in crowds for name in crowd.members]
        outlines = [outline_of(crowd.body) for crowd in crowds for _ in range(crowd.count)]
        self.arrays = CrowdArrays(
            [_make_floor(crowd, solids) for crowd in crowds],
            np.array([crowd.count for crowd in crowds]),
            np.array([_numbers_of(crowd) for crowd in crowds for _ in range(crowd.count)]),
            np.concatenate(outlines),
            np.array([len(outline) for outline in outlines]),
            np.array([radius_of(mover.parts) for mover in movers], dtype=np.float64),
        )
        self.model = CrowdModel([CrowdFloor(*floor) for floor in self.arrays.floors], *self.arrays[1:])
        """What the kernel knows of the crowds."""
        self._run = CrowdRun(self.model)

    def reset(self, seed: int, robot: RobotMotion) -> None:
        """Start from a seed, away from the robot.

        Raises:
            WorldError: If there is no room for all of them.
        """
        missing = self._run.reset(self.words(seed), np.array(robot), self.movers_at(0))
        if missing >= 0:
            raise self.has_no_room(missing)

    def is_due(self, time: float) -> bool:
        """Return whether `at` needs the robot for this time [s]."""
        return _steps_until(time) > self._run.index

    def at(self, time: float, robot: RobotMotion | None = None) -> FloatArray:
        """Return (x, y, yaw, vx, vy, w) of all members at a time [s] not before the last one, shape (N, 6).

        Args:
            time: Since the start of the run [s].
            robot: Where the robot is; needed where the time is due.
        """
        for step in range(self._run.index + 1, _steps_until(time) + 1):
            self._run.step(None if robot is None else np.array(robot), self.movers_at(step))
        return self._run.at(time)

    def words(self, seed: int) -> npt.NDArray[np.uint64]:
        """Return the random words that the kernel starts from with a seed, shape (crowds, 4)."""
        words = np.empty((len(self._crowds), 4), dtype=np.uint64)
        for row, (key, own) in zip(words, self.seeds, strict=True):
            row[:] = np.random.SeedSequence([seed if own is None else own, key]).generate_state(4, np.uint64)
        return words

    @property
    def seeds(self) -> list[tuple[int, int | None]]:
        """Of each crowd, what its words differ by from others' of the same seed, and its own seed if it has one."""
        return [(zlib.crc32(crowd.name.encode()), crowd.seed) for crowd in self._crowds]

    def movers_at(self, step: int) -> FloatArray:
        """Return (x, y, vx, vy) of the others at a step of the crowds, shape (M, 4)."""
        states = [mover.motion.at(step * PERIOD_S) for mover in self._movers]
        return np.array([(each.x, each.y, each.vx, each.vy) for each in states]).reshape(-1, 4)

    def has_no_room(self, number: int) -> WorldError:
        """Return the error for a member that finds no place at the start."""
        first = 0
        crowd = self._crowds[0]
        for crowd in self._crowds:
            if number < first + crowd.count:
                break
            first += crowd.count
        return WorldError(
            f"the crowd {crowd.name!r}: found no place for {self.names[number]!r} with a radius of "
            f"{radius_of(crowd.body):.2f} m that is 2 m from the robot and clear of the {number - first} before it; "
            "make the crowd smaller"
        )


def _steps_until(time: float) -> int:
    return math.floor(time / PERIOD_S + 1e-9)


def _numbers_of(crowd: Crowd) -> tuple[float, float, bool, bool]:
    return radius_of(crowd.body), crowd.speed, crowd.sees_robot, crowd.steers


def _make_floor(crowd: Crowd, solids: Sequence[Solid]) -> FloorArrays:
    if crowd.area is not None:
        bounds = crowd.area
    elif solids:
        lows, highs = solids_bounds(solids)
        (x0, y0), (x1, y1) = lows.min(axis=0)[:2].tolist(), highs.max(axis=0)[:2].tolist()
        bounds = (x0, y0, x1, y1)
    else:
        raise WorldError(f"the crowd {crowd.name!r}: the world has no solids that bound it; give its area")
    radius = radius_of(crowd.body)
    floor = make_floor(solids, bounds, radius, top_of(crowd.body))
    if floor is None:
        raise WorldError(
            f"the crowd {crowd.name!r}: the world has no room for one; a member has a radius of {radius:.2f} m"
        )
    return floor
