"""Stands in for omni.physx and omni.physics.core: they step PhysX, call what has subscribed, and report contacts."""

from __future__ import annotations

import enum
import types
from collections.abc import Callable
from typing import Any

from pxr import UsdPhysics

from trundle.testing.isaac.events import Subscription
from trundle.testing.isaac.kit import App
from trundle.testing.isaac.nothing import Nothing
from trundle.testing.isaac.physics import Engine
from trundle.testing.isaac.queries import SceneQueries
from trundle.testing.isaac.stage import Context


def modules(app: App, context: Context, engine: Engine) -> dict[str, dict[str, object]]:
    """Return the members of the modules that this file stands in for."""
    events = app.events

    def on_step(on_update: Callable[..., Any], pre_step: bool = False, order: int = 0) -> Subscription:
        return events.subscribe("physics.before" if pre_step else "physics.after", on_update, order)

    def on_step_alone(function: Callable[[float], Any]) -> Subscription:
        return events.subscribe("physics.after", lambda dt, _: function(dt))

    def on_contact(function: Callable[..., Any]) -> Subscription:
        return events.subscribe("physics.after", lambda dt, _: function(*engine.contact_report()))

    def simulate(dt: float, time: float) -> None:
        engine.step(dt)

    core = types.SimpleNamespace(
        simulate=simulate, flush_changes=engine.flush, subscribe_physics_on_step_events=on_step,
        fetch_results=lambda: None, check_results=lambda: True,
    )  # fmt: skip
    update = types.SimpleNamespace(
        force_load_physics_from_usd=engine.load, start_simulation=lambda: None, on_update=lambda *_: None,
        reset_simulation=engine.unload,
    )  # fmt: skip
    registry = types.SimpleNamespace(
        get_simulation_ids=lambda: [1], get_simulation_name=lambda _: "PhysX", is_simulation_active=lambda _: True,
        subscribe_simulation_registry_events=lambda _: None, activate_simulation=lambda _: None,
        deactivate_simulation=lambda _: None, get_simulation=lambda _: None,
    )  # fmt: skip
    simulation = types.SimpleNamespace(
        get_contact_report=engine.contact_report, subscribe_contact_report_events=on_contact,
        flush_changes=engine.flush,
        simulate=simulate, fetch_results=lambda: None,
    )  # fmt: skip
    physx = types.SimpleNamespace(
        subscribe_physics_step_events=on_step_alone, force_load_physics_from_usd=engine.load,
        start_simulation=lambda: None, update_simulation=simulate, update_transformations=lambda *_, **__: None,
        release_physics_objects=engine.unload,
    )  # fmt: skip
    queries = SceneQueries(engine)
    query = types.SimpleNamespace(
        query_prim=lambda *, prim_id, articulation_fn, **_: _describe_articulation(
            context, engine, prim_id, articulation_fn
        )
    )
    return {
        "omni.physics.core": {
            "get_physics_simulation_interface": lambda: core, "get_physics_interface": lambda: registry,
            "get_physics_stage_update_interface": lambda: update,
            "SimulationRegistryEventType": enum.Enum("Kind", "SIMULATION_ACTIVATED SIMULATION_DEACTIVATED"),
        },
        "omni.physx": {
            "get_physx_simulation_interface": lambda: simulation, "get_physx_interface": lambda: physx,
            "IPhysxSimulation": simulation, "acquire_physx_interface": lambda: physx,
            "get_physx_property_query_interface": lambda: query, "get_physx_scene_query_interface": lambda: queries,
        },
        "omni.physxfabric": {"get_physx_fabric_interface": lambda: Nothing("omni.physxfabric.IPhysxFabric")},
    }  # fmt: skip


def _describe_articulation(
    context: Context, engine: Engine, prim_id: int, articulation_fn: Callable[[Any], None]
) -> None:
    """Describe an articulation of the stage, before there is physics: its bodies, from the root outwards."""
    stage = context.stage
    joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    ends = {
        number: [str(next(iter(body.GetTargets()), "")) for body in (joint.GetBody0Rel(), joint.GetBody1Rel())]
        for number, joint in enumerate(joints)
    }  # fmt: skip
    reached = {str(engine.name(prim_id)): UsdPhysics.Joint()}
    for body in (queue := list(reached)):
        # Those of one body come by the names of the next, as PhysX has them.
        beside = [(pair[1 - pair.index(body)], number) for number, pair in enumerate(ends.values()) if body in pair]
        for other, number in sorted(beside):
            if other and other not in reached:
                reached[other] = joints[number]
                queue.append(other)
    links = [
        types.SimpleNamespace(
            rigid_body=True, rigid_body_name=body, joint=bool(joint), joint_name=str(joint.GetPath()) if joint else "",
            joint_dof=int(bool(joint) and not joint.GetPrim().IsA(UsdPhysics.FixedJoint)),
        )
        for body, joint in reached.items()
    ]  # fmt: skip
    articulation_fn(types.SimpleNamespace(links=links))
