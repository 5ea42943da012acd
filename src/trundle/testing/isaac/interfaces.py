"""Stands in for omni.physx and omni.physics.core: they step PhysX, call subscribers, and answer rays and overlaps."""

from __future__ import annotations

import enum
import types
import warnings
from collections.abc import Callable
from typing import Any

from ovphysx.types import SceneQueryGeometryType, SceneQueryMode  # pyright: ignore[reportMissingImports]
from pxr import Gf, UsdPhysics

from trundle.testing.isaac.events import Subscription
from trundle.testing.isaac.kit import App
from trundle.testing.isaac.nothing import Nothing
from trundle.testing.isaac.physics import Engine
from trundle.testing.isaac.stage import Context

Report = Callable[[types.SimpleNamespace], bool]


class SceneQueries:
    """omni.physx.get_physx_scene_query_interface()."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def raycast_closest(self, origin: Any, direction: Any, distance: float, bothSides: bool = False) -> dict[str, Any]:
        """Return the first hit of a ray as a dict; its `hit` is false where there is none."""
        hits = self._cast(origin, direction, distance, SceneQueryMode.CLOSEST, bothSides)
        return (
            {"hit": True, "rigidBody": hits[0].rigid_body, "faceIndex": hits[0].face_index, **vars(hits[0])}
            if hits
            else {"hit": False}
        )

    def raycast_any(self, origin: Any, direction: Any, distance: float, bothSides: bool = False) -> bool:
        """Return whether a ray hits anything."""
        return bool(self._cast(origin, direction, distance, SceneQueryMode.ANY, bothSides))

    def raycast_all(
        self, origin: Any, direction: Any, distance: float, reportFn: Report, bothSides: bool = False
    ) -> bool:
        """Call a function with the hits of a ray, until it returns false; whether there was one."""
        return bool(_tell(self._cast(origin, direction, distance, SceneQueryMode.ALL, bothSides), reportFn))

    def overlap_box(self, halfExtent: Any, pos: Any, rot: Any, reportFn: Report, anyHit: bool = False) -> int:
        """Call a function with what is in a box, until it returns false; how many there are."""
        return self._overlap(reportFn, SceneQueryGeometryType.BOX, half_extent=halfExtent, position=pos, rotation=rot)

    def overlap_sphere(self, radius: float, pos: Any, reportFn: Report, anyHit: bool = False) -> int:
        """Call a function with what is in a sphere, until it returns false; how many there are."""
        return self._overlap(reportFn, SceneQueryGeometryType.SPHERE, radius=radius, position=pos)

    def overlap_box_any(self, halfExtent: Any, pos: Any, rot: Any) -> bool:
        """Return whether there is anything in a box."""
        return self.overlap_box(halfExtent, pos, rot, lambda _: False) > 0

    def overlap_sphere_any(self, radius: float, pos: Any) -> bool:
        """Return whether there is anything in a sphere."""
        return self.overlap_sphere(radius, pos, lambda _: False) > 0

    def _cast(self, origin: Any, direction: Any, distance: float, mode: Any, both: bool) -> list[types.SimpleNamespace]:
        long = (sum(float(number) ** 2 for number in direction)) ** 0.5
        ray = tuple(float(number) / long for number in direction)
        return self._ask(lambda physx: physx.raycast(tuple(origin), ray, float(distance), mode, both))

    def _overlap(self, report: Report, kind: Any, **geometry: Any) -> int:
        hits = self._ask(lambda physx: physx.overlap(kind, SceneQueryMode.ALL, **geometry))
        return _tell(hits, report)

    def _ask(self, question: Callable[[Any], list[dict[str, Any]]]) -> list[types.SimpleNamespace]:
        if not self._engine.loaded:
            return []  # as in Isaac Sim before it plays
        self._engine.flush()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            hits = question(self._engine.physx)
            ids = [hit[name] for hit in hits for name in ("collision", "rigid_body")]
            paths = self._engine.physx.get_scene_query_paths_from_ids(ids) if ids else []
        return [
            types.SimpleNamespace(
                collision=paths[2 * row], rigid_body=paths[2 * row + 1], distance=float(hit["distance"]),
                position=Gf.Vec3f(*map(float, hit["position"])), normal=Gf.Vec3f(*map(float, hit["normal"])),
                face_index=int(hit["face_index"]),
            )
            for row, hit in enumerate(hits)
        ]  # fmt: skip


def _tell(hits: list[types.SimpleNamespace], report: Report) -> int:
    for hit in hits:
        if not report(hit):
            break
    return len(hits)


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
