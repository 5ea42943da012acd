"""The robot's contacts in a MuJoCo state, by name."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from trundle.sim.footprint import CellNames
from trundle.sim.mujoco.robot_parts import BASE, part_of
from trundle.sim.mujoco.world_parts import FLOOR, solid_of
from trundle.sim.state import Contact
from trundle.worlds import World


class ContactReader:
    """Reads the robot's contacts with everything but the floor; what else touches in the world is left out.

    Args:
        model: The compiled world and robot.
        world: The world that the model was built from.
        movers: Names of the movers by their geoms.
    """

    def __init__(self, model: mujoco.MjModel, world: World, movers: Mapping[int, str]) -> None:
        self._model = model
        self._movers = movers
        self._floor = model.geom(FLOOR).id
        own = model.body_rootid[model.geom_bodyid] == model.body(BASE).id
        self._own = frozenset(np.flatnonzero(own).tolist())
        self._cells = CellNames(world)

    def read(self, data: mujoco.MjData, touched: dict[tuple[str, str], Contact]) -> None:
        """Add the robot's current contacts to `touched`, by part and solid; the first position of each pair is kept."""
        pairs = data.contact.geom.tolist()
        for index, pair in enumerate(pairs):
            if self._floor in pair:
                continue
            own, other = pair if pair[0] in self._own else pair[::-1]
            if own not in self._own:
                continue
            x, y, _ = data.contact.pos[index].tolist()
            part = part_of(self._model.geom(own).name)
            name = self._movers.get(other) or self._cells.name(solid_of(self._model.geom(other).name), x, y)
            touched.setdefault((part, name), Contact(part, name, x, y))
