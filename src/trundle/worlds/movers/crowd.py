"""`Crowd`: people or forklifts that walk to random places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.errors import WorldError
from trundle.geometry.solids import Solid
from trundle.values import is_finite_number, show_value
from trundle.worlds.movers.mover import Mover, body_named, check_parts

MODELS = ("social_force",)
"""Models that a crowd can follow."""

STEERED = ("forklift",)
"""Kinds that steer: they drive where they face. Others may step aside."""

MOST_MEMBERS = 1000  # a step takes time and memory in proportion to the square of this


@dataclass(frozen=True, slots=True)
class Crowd:
    """People or vehicles that go to random places of the world, one after another, around its solids and each other.

    Every one draws a place, goes there on the shortest path that keeps its distance from solids, and draws the next.
    The model is that of Helbing and Molnár, Social Force Model for Pedestrian Dynamics (Physical Review E 51, 1995),
    with their parameters, stepped at a fixed period of 0.05 s. Beside it nobody enters a solid or another one. The
    places are drawn by the seed of the run, which also gives the places at the start, 2 m or more from the robot.

    Attributes:
        name: Name of the crowd, unique in its world; its members are `name_1`, `name_2`, ….
        count: Number of its members.
        kind: Their body, "person" or "forklift"; another kind needs `parts`. Forklifts steer: they drive where
            they face, and need room to turn everywhere.
        speed: Highest speed of a member [m/s]; each has a preferred speed of 0.7 to 1 times it.
        sees_robot: Whether they stop for the robot and go around it; else they ignore it.
        area: (x0, y0, x1, y1) [m], where they stay. If None, they stay in the bounds of the world's solids.
        model: Name of the model.
        seed: Seed of their random places. If None, it is the run's.
        parts: Their solids, in the frame of one. If None, they are those of `kind`.

    Raises:
        WorldError: If a value is out of range.
        UnknownNameError: If there is no such kind, and no parts are given.
    """

    name: str
    count: int
    kind: str = "person"
    speed: float = 1.2
    sees_robot: bool = True
    area: tuple[float, float, float, float] | None = None
    model: str = "social_force"
    seed: int | None = None
    parts: tuple[Solid, ...] | None = None

    def __post_init__(self) -> None:
        what = f"the crowd {self.name!r}"
        check_parts(self.name, self.parts or body_named(self.kind))
        if isinstance(self.count, bool) or not isinstance(self.count, int) or not 1 <= self.count <= MOST_MEMBERS:
            raise WorldError(
                f"{what}: count must be a whole number from 1 to {MOST_MEMBERS}, got {show_value(self.count)}"
            )
        if not (is_finite_number(self.speed) and 0.0 < self.speed <= 10.0):
            raise WorldError(f"{what}: speed must be above 0 and at most 10 m/s, got {show_value(self.speed)}")
        if not isinstance(self.sees_robot, bool):
            raise WorldError(f"{what}: sees_robot must be true or false, got {show_value(self.sees_robot)}")
        if self.model not in MODELS:
            raise WorldError(f"{what}: there is no model {self.model!r}; use {', '.join(MODELS)}")
        if self.seed is not None and (isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0):
            raise WorldError(f"{what}: seed must be a whole number of 0 or more, got {show_value(self.seed)}")
        if self.area is not None:
            x0, y0, x1, y1 = self.area
            if not (all(map(math.isfinite, self.area)) and x0 < x1 and y0 < y1):
                raise WorldError(f"{what}: area must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1, got {self.area}")
        if self.parts is not None:
            object.__setattr__(self, "parts", tuple(self.parts))

    @property
    def members(self) -> tuple[str, ...]:
        """Names of its members."""
        return tuple(f"{self.name}_{number + 1}" for number in range(self.count))

    @property
    def body(self) -> tuple[Solid, ...]:
        """The solids of one member, in its own frame."""
        return self.parts or body_named(self.kind)

    @property
    def steers(self) -> bool:
        """Whether its members drive where they face."""
        return self.kind in STEERED


def each_body(movers: Sequence[Mover | Crowd]) -> list[tuple[str, tuple[Solid, ...]]]:
    """Return the name and the solids of everyone: first of the movers, then of the members of crowds."""
    bodies = [(mover.name, mover.parts) for mover in movers if isinstance(mover, Mover)]
    for crowd in movers:
        if isinstance(crowd, Crowd):
            body = crowd.body
            bodies += [(name, body) for name in crowd.members]
    return bodies
