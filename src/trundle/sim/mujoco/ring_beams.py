"""`RingBeams`: distances along beams of a lidar of several rings, which rise and fall."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.sim.mujoco.model import world_spec
from trundle.sim.mujoco.mover_bodies import place_movers
from trundle.sim.mujoco.world_parts import MOVER
from trundle.sim.state import MoverState
from trundle.worlds import World

_SEEN = np.array([1, 1, 0, 0, 0, 0], dtype=np.uint8)
"""Geom groups: solids and cells; not the convex pieces of meshes."""


class RingBeams:
    """Casts beams of any direction into a world, with its floor and what moves in it, but without the robot.

    Args:
        world: The world.

    Raises:
        WorldError: If it cannot be modelled.
    """

    def __init__(self, world: World) -> None:
        try:
            self._model = world_spec(world).compile()
        except ValueError as error:
            raise WorldError(f"MuJoCo cannot model the world {world.name!r}: {error}") from error
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._slots: dict[str, int] = {}

    def cast(
        self, origin: Sequence[float], directions: FloatArray, reach: float, movers: Sequence[MoverState] = ()
    ) -> FloatArray:
        """Return distances [m] from an origin (x, y, z) [m], map frame, to what is nearest; infinity without anything.

        Args:
            origin: Where the beams begin.
            directions: Unit vectors, map frame, shape (N, 3).
            reach: How far they reach [m].
            movers: What moves, where it is now.
        """
        model, data = self._model, self._data
        if movers:
            self._move(movers)
        count = len(directions)
        geoms, distances = np.empty(count, dtype=np.int32), np.empty(count)
        start, beams = np.asarray(origin, dtype=np.float64), np.ascontiguousarray(directions).ravel()
        mujoco.mj_multiRay(model, data, start, beams, _SEEN, True, -1, geoms, distances, None, count, reach)
        return np.where((geoms >= 0) & (distances <= reach), distances, np.inf)

    def _move(self, movers: Sequence[MoverState]) -> None:
        slots = [self._slot(mover.name) for mover in movers]
        poses = np.array([mover.pose.as_tuple() for mover in movers])
        place_movers(self._data, np.array(slots, dtype=np.int32), poses)
        mujoco.mj_kinematics(self._model, self._data)

    def _slot(self, name: str) -> int:
        if name not in self._slots:
            self._slots[name] = int(self._model.body_mocapid[self._model.body(f"{MOVER}{name}").id])
        return self._slots[name]
