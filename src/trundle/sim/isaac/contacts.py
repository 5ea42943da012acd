"""The robot's contacts, from PhysX' contact report. Imported only once the application runs."""

from __future__ import annotations

import math
from typing import Any

import omni.usd
from omni.physx import get_physx_simulation_interface
from pxr import PhysicsSchemaTools, Sdf, Usd, UsdPhysics

from trundle.sim.cells import CellNames
from trundle.sim.simulator import Contact
from trundle.worlds import World
from trundle.worlds.usd.options import NAME

FLOOR_BAND = 0.02
"""Contacts up to this far above the lowest one [m] are with the floor, which cannot be identified by name."""


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
                # Not every USD has PhysX' schemas; their attributes can still be written.
                prim.AddAppliedSchema("PhysxContactReportAPI")
                prim.CreateAttribute("physxContactReport:threshold", Sdf.ValueTypeNames.Float, False).Set(0.0)

    def find_floor(self) -> None:
        """Take the lowest contact of the robot at rest as the height of the floor."""
        heights = [z for _, _, points in self._touching() for _, _, z in points]
        self._floor = min(heights, default=0.0)

    def read(self, touched: dict[tuple[str, str], Contact]) -> None:
        """Add the robot's current contacts to `touched`, by part and solid; the first position of each pair is kept."""
        for own, other, points in self._touching():
            part = own.rpartition("/")[2]
            for x, y, z in points:
                if z > self._floor + FLOOR_BAND:
                    # All cells of a map are one collider.
                    name = self._cells.name(self._name(other), x, y)
                    touched.setdefault((part, name), Contact(part, name, x, y))

    def _touching(self) -> list[tuple[str, str, list[tuple[float, float, float]]]]:
        """Pairs in contact after the last physics step: the robot's body, the other's collider, and where [m]."""
        pairs: list[tuple[str, str, list[tuple[float, float, float]]]] = []
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
            pairs.append((own, collider, [(x, y, z) for x, y, z in points if math.isfinite(x + y + z)]))
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
