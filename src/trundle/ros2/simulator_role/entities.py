"""`Entities`: what is in the simulation, and where it is: the robot, what moves, and the solids of the world."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from trundle.errors import InputError, UnknownNameError
from trundle.mission import Session
from trundle.ros2.role import BridgeContext

EntityKind: TypeAlias = Literal["robot", "mover", "solid"]


@dataclass(frozen=True, slots=True)
class Entity:
    """Something in the simulation, where it is now.

    Attributes:
        name: Its name.
        kind: What it is.
        position: (x, y, z) [m], map frame.
        rotation: Quaternion (w, x, y, z).
        velocity: (vx, vy) [m/s], map frame.
        turn: Speed of rotation [rad/s].
    """

    name: str
    kind: EntityKind
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0


class Entities:
    """Finds entities by their names.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context

    def all(self, session: Session) -> list[Entity]:
        """Return all entities as they are now; the robot is the first."""
        state = session.state
        pose, twist = state.pose, state.twist
        velocity = twist.v * math.cos(pose.yaw), twist.v * math.sin(pose.yaw)
        found = [Entity(self.robot, "robot", (pose.x, pose.y, 0.0), _about_z(pose.yaw), velocity, twist.w)]
        found += [
            Entity(
                mover.name,
                "mover",
                (mover.pose.x, mover.pose.y, 0.0),
                _about_z(mover.pose.yaw),
                (mover.vx, mover.vy),
                mover.w,
            )
            for mover in state.movers
        ]
        world = self._context.mission.sim.world
        if world is not None:
            found += [Entity(solid.name, "solid", solid.pose.position, solid.pose.quaternion) for solid in world.solids]
        return found

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self._context.mission.robot.name

    def one(self, name: str, session: Session) -> Entity:
        """Return an entity by its name.

        Raises:
            UnknownNameError: If no entity has that name.
        """
        found = self.all(session)
        for entity in found:
            if entity.name == name:
                return entity
        raise UnknownNameError("entity", name, [entity.name for entity in found])

    def matching(self, pattern: str, kinds: Sequence[EntityKind], session: Session) -> list[Entity]:
        """Return entities of these kinds whose names match a regular expression; without kinds, of all.

        Raises:
            InputError: If the pattern is not a regular expression.
        """
        try:
            expression = re.compile(pattern)
        except re.error as error:
            raise InputError(f"{pattern!r} is no regular expression: {error}") from error
        return [
            entity
            for entity in self.all(session)
            if expression.search(entity.name) and (not kinds or entity.kind in kinds)
        ]


def _about_z(yaw: float) -> tuple[float, float, float, float]:
    return (math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0))
