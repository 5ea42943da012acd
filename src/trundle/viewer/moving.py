"""`MovingBodies`: the movers of a world in a model that is drawn, and their trails as dots on the floor."""

from __future__ import annotations

import mujoco
import numpy as np

from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.sim.mover_history import ShownMovers
from trundle.sim.movers import MoverField
from trundle.sim.mujoco.mover_bodies import place_movers
from trundle.sim.mujoco.world_parts import MOVER
from trundle.worlds import World
from trundle.worlds.movers.crowd import each_body

TRAIL_COLOR = (0.85, 0.42, 0.05, 1.0)
_DOTS = 12
_DOT_RADIUS_M, _DOT_HALF_HEIGHT_M = 0.05, 0.004
_BELOW_M = -50.0  # where dots are kept that are not shown [m]


class MovingBodies:
    """Adds dots for the trails of movers to a model, and then places movers and dots.

    Args:
        spec: The model with the world; its movers are bodies already.
        world: The world.
        group: Geom group of the dots.
    """

    def __init__(self, spec: mujoco.MjSpec, world: World, group: int) -> None:
        self._names = [name for name, _ in each_body(world.movers)]
        for name in self._names:
            for dot in range(_DOTS):
                body = spec.worldbody.add_body(name=_dot_name(name, dot), mocap=True, pos=(0.0, 0.0, _BELOW_M))
                body.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_CYLINDER,
                    size=(_DOT_RADIUS_M, _DOT_HALF_HEIGHT_M, 0.0),
                    rgba=TRAIL_COLOR,
                    contype=0,
                    conaffinity=0,
                    mass=0.0,
                    group=group,
                )

    def place(self, model: mujoco.MjModel, data: mujoco.MjData, shown: ShownMovers) -> None:
        """Put the movers where they are, with dots evenly along each trail; those not shown stay where they are."""
        at = {state.name: index for index, state in enumerate(shown.states)}
        for name in self._names:
            if name not in at:
                continue
            pose = shown.states[at[name]].pose
            slots = np.array([model.body(f"{MOVER}{name}").mocapid[0]])
            place_movers(data, slots, np.array([pose.as_tuple()]))
            trail = shown.trails[at[name]] if at[name] < len(shown.trails) else np.zeros((0, 2))
            picked = np.linspace(0, len(trail) - 1, _DOTS + 1).round().astype(int)[:-1] if len(trail) > _DOTS else []
            for dot in range(_DOTS):
                slot = int(model.body(_dot_name(name, dot)).mocapid[0])
                data.mocap_pos[slot] = (*trail[picked[dot]], 0.004) if dot < len(picked) else (0.0, 0.0, _BELOW_M)


def movers_at_start(world: World, robot: Robot, pose: Pose2D) -> ShownMovers:
    """Where the movers of a world are when a run with seed 0 begins.

    Raises:
        WorldError: If there is no room for a crowd.
    """
    if not world.movers:
        return ShownMovers()
    field = MoverField(world, robot)
    field.reset(0, pose)
    return ShownMovers(field.states())


def _dot_name(name: str, dot: int) -> str:
    return f"viewer:trail:{name}:{dot}"
