"""The robot's contacts, from PhysX' contact report. Imported only once the application runs."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import omni.usd
from omni.physx import get_physx_simulation_interface
from pxr import PhysicsSchemaTools, Usd, UsdPhysics

from trundle.sim.footprint import CellNames
from trundle.sim.state import Contact
from trundle.usd.isaac import fit_body
from trundle.worlds import World
from trundle.worlds.usd.options import NAME

FLOOR_BAND = 0.02
"""Contacts up to this far above the lowest one [m] are with the floor, which cannot be identified by name."""


class Touching(NamedTuple):
    """A part of the robot in contact with something: the paths of both, and the points of contact [m]."""

    part: str
    other: str
    points: list[tuple[float, float, float]]


class ContactReader:
    """Reads contacts of the robot with everything but the floor.

    Solids have the names of the world that trundle wrote, or their prim paths in any other stage.

    Args:
        world: Used for the names of cells.
        path: Path of the robot's prim.
    """

    def __init__(self, world: World, path: str) -> None:
        self._cells = CellNames(world)
        self._path = path
        self._stage: Any = omni.usd.get_context().get_stage()
        self._names: dict[str, str] = {}
        self._floor = 0.0
        for prim in Usd.PrimRange(self._stage.GetPrimAtPath(path)):
            if prim.HasAPI(UsdPhysics.RigidBodyAPI):
                fit_body(prim)

    def find_floor(self, earlier: list[Touching]) -> None:
        """Take the lowest contact as the height of the floor: now, with the robot at rest, or of earlier pairs."""
        heights = [z for pair in (*earlier, *self.touching()) for _, _, z in pair.points]
        self._floor = min(heights, default=0.0)

    def read(self, touched: dict[tuple[str, str], Contact]) -> None:
        """Add the robot's current contacts to `touched`; see `add`."""
        self.add(self.touching(), touched)

    def add(self, pairs: list[Touching], touched: dict[tuple[str, str], Contact], *, height: float = math.inf) -> None:
        """Add contacts with everything but the floor, by part and solid; the first position of each pair is kept.

        Args:
            pairs: What touched; see `touching`.
            touched: The contacts so far.
            height: Height above the floor [m] above which contacts are left out.
        """
        for pair in pairs:
            part = pair.part.rpartition("/")[2]
            for x, y, z in pair.points:
                if FLOOR_BAND < z - self._floor <= height:
                    # All cells of a map are one collider.
                    name = self._cells.name(self._name(pair.other), x, y)
                    touched.setdefault((part, name), Contact(part, name, x, y))

    def touching(self) -> list[Touching]:
        """Return the pairs in contact after the last physics step, those with the floor among them."""
        pairs: list[Touching] = []
        headers, data = get_physx_simulation_interface().get_contact_report()
        for header in headers:
            if str(header.type).endswith("CONTACT_LOST"):
                continue
            sides = [(_path(header.actor0), _path(header.collider0)), (_path(header.actor1), _path(header.collider1))]
            sides.sort(key=lambda side: not self._is_own(side[0]))
            (own, _), (actor, collider) = sides
            if not self._is_own(own) or self._is_own(actor):
                continue
            first = header.contact_data_offset
            points = [
                tuple(map(float, data[index].position)) for index in range(first, first + header.num_contact_data)
            ]
            pairs.append(Touching(own, collider, [(x, y, z) for x, y, z in points if math.isfinite(x + y + z)]))
        return pairs

    def _is_own(self, path: str) -> bool:
        return path == self._path or path.startswith(f"{self._path}/")

    def _name(self, path: str) -> str:
        if path not in self._names:
            prim = self._stage.GetPrimAtPath(path)
            given = prim.GetCustomDataByKey(NAME) if prim else None
            self._names[path] = str(given) if given else path
        return self._names[path]


def _path(number: int) -> str:
    return str(PhysicsSchemaTools.intToSdfPath(number))
