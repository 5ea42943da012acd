"""`CrowdWalk`: the crowds of a world while a run goes on, stepped by the kernel."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle._core import CrowdFloor, CrowdModel, CrowdRun
from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid, solids_bounds
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of, radius_of, top_of
from trundle.worlds.movers.walkable import make_floor

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
        self.model = CrowdModel(
            [_make_floor(crowd, solids) for crowd in crowds],
            np.array([crowd.count for crowd in crowds]),
            np.array([_numbers_of(crowd) for crowd in crowds for _ in range(crowd.count)]),
            np.concatenate(outlines),
            np.array([len(outline) for outline in outlines]),
            np.array([radius_of(mover.parts) for mover in movers]),
        )
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
        for row, crowd in zip(words, self._crowds, strict=True):
            key = [seed if crowd.seed is None else crowd.seed, zlib.crc32(crowd.name.encode())]
            row[:] = np.random.SeedSequence(key).generate_state(4, np.uint64)
        return words

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


def _make_floor(crowd: Crowd, solids: Sequence[Solid]) -> CrowdFloor:
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
