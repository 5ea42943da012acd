"""`SimulationServices`: simulation_interfaces, as Isaac Sim and Gazebo serve them; `Entities`: what is there."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from trundle.errors import InputError, UnknownNameError
from trundle.mission import Session
from trundle.navigation.behaviors.behavior import snake_case
from trundle.ros2.bad_input import BadInputError, check_frame, check_pose
from trundle.ros2.role import BridgeContext
from trundle.ros2.simulator_role.control import SimulationControl, SimulationState, StepAction

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


PACKAGE = "simulation_interfaces"

UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)
"""Codes of simulation_interfaces/Result."""

ALREADY_THERE = 101
"""A code of SetSimulationState."""

_STATES: dict[SimulationState, int] = {"stopped": 0, "playing": 1, "paused": 2, "quitting": 3}
_ROBOT, _DYNAMIC, _STATIC = 2, 4, 5
_CATEGORIES: dict[EntityKind, int] = {"robot": _ROBOT, "mover": _DYNAMIC, "solid": _STATIC}
_TIME, _STATE, _SPAWNED, _ALL = 1, 2, 4, 255
_BOX, _SPHERE = 1, 3

FEATURES = (8, 10, 11, 12, 20, 21, 22, 24, 25, 26, 31, 32, 33)
"""Numbers of SimulatorFeatures: ENTITY_CATEGORIES, ENTITY_STATE_GETTING and _SETTING, ENTITY_INFO_GETTING,
SIMULATION_RESET with _TIME and _STATE, SIMULATION_STATE_GETTING, _SETTING and _PAUSE, STEP_SIMULATION_SINGLE, _MULTIPLE
and _ACTION."""

REFUSED = {
    "SpawnEntity": "nothing can be spawned: give movers and worlds in the scenario, or drop boxes on its page",
    "DeleteEntity": "nothing can be deleted",
    "SetEntityInfo": "entities have no tags or descriptions that can be set",
    "GetEntityBounds": "bounds are not served: the robot's outline is in /robot_description",
    "GetSpawnables": "nothing can be spawned",
    "GetNamedPoses": "there are no named poses",
    "GetNamedPoseBounds": "there are no named poses",
    "LoadWorld": "the world is that of the command line: start another bridge for another one",
    "UnloadWorld": "the world is that of the command line",
    "GetCurrentWorld": "the world is that of the command line",
    "GetAvailableWorlds": "the world is that of the command line",
}
"""Services that are answered with FEATURE_UNSUPPORTED, and why."""


class _Refused(Exception):  # noqa: N818 - an answer, not an error
    """An answer with this code and message."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


class SimulationServices:
    """Serves the state of the simulation, its steps and restarts, and the entities in it.

    The world's frame is the map frame of the simulation. A step is a control period. Only the robot can be placed.

    Args:
        context: The bridge.
        prefix: What the services' names begin with, such as "gzserver/".
    """

    def __init__(self, context: BridgeContext, *, prefix: str = "") -> None:
        self._wire, self._types = context.wire, context.wire.types
        self._context, self._prefix = context, prefix
        self._control, self._entities = SimulationControl(context), Entities(context)
        self._steps = StepAction(context, self._control, self._result)

    def open(self) -> None:
        """Serve all that the other side has types for."""
        for name, handler in (
            ("GetSimulatorFeatures", self._get_features),
            ("GetSimulationState", self._get_state),
            ("SetSimulationState", self._set_state),
            ("StepSimulation", self._step),
            ("ResetSimulation", self._reset),
            ("GetEntities", self._get_entities),
            ("GetEntityState", self._get_entity_state),
            ("GetEntitiesStates", self._get_entities_states),
            ("GetEntityInfo", self._get_entity_info),
            ("SetEntityState", self._set_entity_state),
        ):
            self._serve(name, handler)
        self._wire.act(f"{self._prefix}simulate_steps", f"{PACKAGE}/action/SimulateSteps", self._steps)
        if not self._wire.transport.has_services:
            return
        for name, why in REFUSED.items():
            if self._types.knows(f"{PACKAGE}/srv/{name}_Request"):
                self._serve(name, lambda _, why=why: self._refuse(UNSUPPORTED, why))

    def _serve(self, name: str, handler: Callable[[Any], dict[str, Any]]) -> None:
        type_name = f"{PACKAGE}/srv/{name}"

        def answer(request: Any) -> Any:
            try:
                fields = handler(request)
            except _Refused as refused:
                fields = {"result": self._result(refused.code, str(refused))}
            except UnknownNameError as error:
                fields = {"result": self._result(NOT_FOUND, str(error))}
            except InputError as error:
                fields = {"result": self._result(FAILED, str(error))}
            return self._types.make(f"{type_name}_Response", **{"result": self._result(OK), **fields})

        self._wire.serve(f"{self._prefix}{snake_case(name)}", type_name, answer)

    def _result(self, code: int, message: str = "") -> Any:
        return self._types.make(f"{PACKAGE}/msg/Result", result=code, error_message=message)

    def _refuse(self, code: int, message: str) -> dict[str, Any]:
        raise _Refused(code, message)

    # Simulation -----------------------------------------------------------------------------------------------------

    def _get_features(self, request: Any) -> dict[str, Any]:
        features = self._types.make(
            f"{PACKAGE}/msg/SimulatorFeatures",
            features=list(FEATURES),
            custom_info="trundle: a step is one control period; see its docs/ros2.md",
        )
        return {"features": features}

    def _get_state(self, request: Any) -> dict[str, Any]:
        number = _STATES[self._control.state]
        return {"state": self._types.make(f"{PACKAGE}/msg/SimulationState", state=number)}

    def _set_state(self, request: Any) -> dict[str, Any]:
        control, wanted = self._control, request.state.state
        if wanted not in _STATES.values():
            return self._refuse(FAILED, f"{wanted} is no state of a simulation")
        if wanted == _STATES[control.state]:
            return self._refuse(ALREADY_THERE, f"the simulation is {control.state} already")
        if self._steps.is_busy:
            return self._refuse(INCORRECT_STATE, "the simulation is stepped by an action: cancel that first")
        actions = {0: control.stop, 1: control.play, 2: control.pause, 3: control.quit}
        actions[wanted]()
        return {}

    def _step(self, request: Any) -> dict[str, Any]:
        if self._steps.is_busy:
            return self._refuse(INCORRECT_STATE, "the simulation is stepped by an action: cancel that first")
        self._control.step(int(request.steps))
        return {}

    def _reset(self, request: Any) -> dict[str, Any]:
        scope = int(getattr(request, "scope", 0))
        if scope == _SPAWNED:
            return self._refuse(UNSUPPORTED, "what was added goes with SCOPE_STATE, not alone")
        if scope == _TIME:
            self._control.reset_time()
        elif scope in (0, _STATE, _STATE | _SPAWNED, _TIME | _STATE, _TIME | _STATE | _SPAWNED, _ALL):
            self._control.reset(from_zero=bool(scope & _TIME))
        else:
            return self._refuse(UNSUPPORTED, f"{scope} is no scope of a reset that is known")
        return {}

    # Entities -------------------------------------------------------------------------------------------------------

    def _get_entities(self, request: Any) -> dict[str, Any]:
        return {"entities": [entity.name for entity in self._find(request.filters)]}

    def _get_entities_states(self, request: Any) -> dict[str, Any]:
        found = self._find(request.filters)
        return {"entities": [entity.name for entity in found], "states": [self._state_of(entity) for entity in found]}

    def _get_entity_state(self, request: Any) -> dict[str, Any]:
        return {"state": self._state_of(self._entities.one(request.entity, self._control.session))}

    def _get_entity_info(self, request: Any) -> dict[str, Any]:
        entity = self._entities.one(request.entity, self._control.session)
        category = self._types.make(f"{PACKAGE}/msg/EntityCategory", category=_CATEGORIES[entity.kind])
        return {"info": self._types.make(f"{PACKAGE}/msg/EntityInfo", category=category, description=entity.kind)}

    def _set_entity_state(self, request: Any) -> dict[str, Any]:
        entity = self._entities.one(request.entity, self._control.session)
        if entity.kind != "robot":
            reason = "moves by itself" if entity.kind == "mover" else "stands in the world"
            return self._refuse(UNSUPPORTED, f"only the robot can be placed, and {entity.name} {reason}")
        state = request.state
        twist = state.twist
        speeds = (twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z)
        if any(speeds):
            return self._refuse(UNSUPPORTED, "the robot is placed at rest: give a twist of 0")
        try:
            check_frame(state.header.frame_id, ("world", self._context.profile.frames.map))
            self._control.place(check_pose(state.pose))
        except BadInputError as error:
            self._wire.warn(f"set_entity_state: {error.kind}", f"a state of {entity.name} is refused: {error}")
            raise
        return {}

    def _find(self, filters: Any) -> list[Entity]:
        if list(filters.tags.tags):
            return []
        kinds: list[EntityKind] = [
            kind for kind, number in _CATEGORIES.items() for wanted in filters.categories if wanted.category == number
        ]
        if len(filters.categories) and not kinds:
            return []
        found = self._entities.matching(filters.filter, kinds, self._control.session)
        return [entity for entity in found if self._is_within(entity, filters.bounds)]

    def _is_within(self, entity: Entity, bounds: Any) -> bool:
        """Return whether the middle of an entity is within a box or a sphere."""
        corners = [(point.x, point.y, point.z) for point in bounds.points]
        if not corners:
            return True
        if bounds.type == _SPHERE and len(corners) == 2:
            return math.dist(entity.position, corners[0]) <= corners[1][0]
        if bounds.type == _BOX and len(corners) == 2:
            sides = zip(*corners, entity.position, strict=True)
            return all(min(one, other) <= middle <= max(one, other) for one, other, middle in sides)
        raise _Refused(UNSUPPORTED, "entities are filtered by a sphere or a box, given by two points")

    def _state_of(self, entity: Entity) -> Any:
        make, (x, y, z), (w, qx, qy, qz) = self._types.make, entity.position, entity.rotation
        vx, vy = entity.velocity
        frame = self._context.profile.frames.map
        stamp = self._context.maker.stamp(self._context.clock.now)
        return make(
            f"{PACKAGE}/msg/EntityState",
            header=make("std_msgs/msg/Header", stamp=stamp, frame_id=frame),
            pose=make(
                "geometry_msgs/msg/Pose",
                position=make("geometry_msgs/msg/Point", x=x, y=y, z=z),
                orientation=make("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=w),
            ),
            twist=make(
                "geometry_msgs/msg/Twist",
                linear=make("geometry_msgs/msg/Vector3", x=vx, y=vy),
                angular=make("geometry_msgs/msg/Vector3", z=entity.turn),
            ),
        )
