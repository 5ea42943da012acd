"""Stands in for omni.physx and omni.physics.core: they pass the stage to PhysX, which ovphysx runs on the CPU."""

from __future__ import annotations

import enum
import itertools
import tempfile
import types
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import ovphysx
import ovstage
from ovphysx import PhysX
from ovphysx.types import ObjectScope, SimObjectType, TensorType
from pxr import Gf, Plug, Sdf, Usd, UsdGeom, UsdPhysics

from trundle.testing.isaac.kit import App, Subscription
from trundle.testing.isaac.nothing import Nothing
from trundle.testing.isaac.stage import Context

_KEPT = (
    TensorType.ARTICULATION_DOF_POSITION,
    TensorType.ARTICULATION_ROOT_POSE,
    TensorType.ARTICULATION_ROOT_VELOCITY,
    TensorType.ARTICULATION_DOF_VELOCITY,
    TensorType.ARTICULATION_DOF_POSITION_TARGET,
    TensorType.ARTICULATION_DOF_VELOCITY_TARGET,
)
"""State of an articulation that is carried over when the stage changes while it plays."""

_CONTACT = ("Type", "Collider", "OtherBody", "OtherCollider", "PointCount", "PointPosition")
_CONTACT_TYPES = ("CONTACT_FOUND", "CONTACT_LOST", "CONTACT_PERSIST")


class Engine:
    """PhysX, with the stage that is open.

    Attributes:
        runs: How often PhysX was given the stage; views are made anew for each.
    """

    def __init__(self, app: App, context: Context) -> None:
        self._app, self._context = app, context
        # It would like a Warp without CUDA.
        warnings.filterwarnings("ignore", message="ovphysx is in CPU-only mode")
        ovphysx.set_log_level(ovphysx.LogLevel.ERROR)
        PhysX.set_cpu_mode(True)
        ovphysx.set_global_config(ovphysx.GlobalConfigKey.NUM_THREADS, 0)
        self._physx = PhysX()
        import physx_usd_schemas

        physx_usd_schemas.register_all()
        Plug.Registry().RegisterPlugins(str(ovphysx.newton_schema_root()))
        schemas = [*map(str, physx_usd_schemas.schema_paths()), str(ovphysx.newton_schema_root())]
        ovstage.population.register_usd_schemas(schemas)
        self._folder = tempfile.TemporaryDirectory(prefix="trundle-isaac-")
        self._stage: ovstage.Stage | None = None
        self._numbers: dict[str, int] = {}
        self._names: list[str] = []
        self._changed = self._writing = False
        self._moved: Sdf.Layer | None = None
        self.runs = 0
        self.steps = 0
        context.watchers.append(self._watch)
        app.step, app.synchronize = self.step, self.synchronize

    @property
    def loaded(self) -> bool:
        """Whether PhysX has the stage."""
        return self._stage is not None

    def load(self) -> None:
        """Give PhysX the stage."""
        if self.loaded:
            return
        stage = self._context.get_stage()
        self._bodies = [
            str(prim.GetPath()) for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI) and _moves(prim)
        ]
        self.runs += 1
        file = Path(self._folder.name) / f"{self.runs}.usdc"
        stage.Export(str(file))
        self._stage = ovstage.Stage(f"trundle{self.runs}")
        ovstage.population.open_usd(self._stage, str(file), ordinal=1, domains=ovstage.PopulationDomain.ALL)
        self._stage.advance_write_floor(ordinal=1).wait()
        self._physx.wait_task(self._physx.attach_ovstage(self._stage, read_ordinal=1))
        file.unlink()
        self._paths = ovstage.PathDictionary(self._stage)
        self._known: dict[int, str] = {}
        self._frames = {path: _frame(stage, path, self._bodies) for path in self._bodies}
        self._poses = self.bind(self._bodies, TensorType.RIGID_BODY_POSE) if self._bodies else None
        self._changed = False

    def unload(self) -> None:
        """Take the stage from PhysX, and what it moved back to where it was."""
        if self._stage is None:
            return
        self._physx.wait_task(self._physx.detach_ovstage())
        self._stage.destroy()
        self._stage = None
        stage = self._context.get_stage()
        if stage is not None:
            with self._quietly():
                self._results(stage).Clear()

    def flush(self) -> None:
        """Load the stage again if it was changed since, and let everything go on from where it is."""
        if not (self.loaded and self._changed):
            return
        self.synchronize()
        roots = self._articulations()
        kept = [(path, kind, self.read(path, kind)) for path in roots for kind in _KEPT]
        self._physx.wait_task(self._physx.detach_ovstage())
        self._stage.destroy()
        self._stage = None
        self.load()
        for path, kind, value in kept:
            binding = self.bind([path], kind)
            if tuple(binding.shape) == value.shape:
                binding.write(value)
            binding.destroy()

    def step(self, dt: float) -> None:
        """Do a physics step of `dt` [s], and call what has subscribed to it."""
        self.load()
        self.flush()
        info = types.SimpleNamespace(simulation_id=1, dt=dt)
        self._app.events.send("physics.before", dt, info)
        self.flush()
        self._physx.step_sync(dt)
        self.steps += 1
        self._app.count(dt)
        self._app.events.send("physics.after", dt, info)

    def bind(self, paths: list[str], kind: int) -> Any:
        """Return PhysX's own view of one quantity of these prims."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return self._physx.create_tensor_binding(prim_paths=paths, tensor_type=kind)

    def read(self, path: str, kind: int) -> np.ndarray:
        """Read one quantity of one prim."""
        binding = self.bind([path], kind)
        value = np.zeros(binding.shape, np.dtype(str(binding.dtype)))
        binding.read(value)
        binding.destroy()
        return value

    def synchronize(self) -> None:
        """Write the poses of bodies to the stage, as Kit does once a frame."""
        stage = self._context.get_stage()
        if not self.loaded or self._poses is None or stage is None:
            return
        poses = np.zeros(self._poses.shape, np.float32)
        self._poses.read(poses)
        world = dict(zip(self._poses.prim_paths, map(_matrix, poses.tolist()), strict=True))
        layer = self._results(stage)
        with self._quietly(), Sdf.ChangeBlock():
            for path, (above, between, scale) in self._frames.items():
                if path not in world or not stage.GetPrimAtPath(path):
                    continue
                local = world[path] * (between * world.get(above, Gf.Matrix4d(1.0))).GetInverse()
                prim = Sdf.CreatePrimInLayer(layer, path)
                values = {
                    "xformOp:translate": (Sdf.ValueTypeNames.Double3, local.ExtractTranslation()),
                    "xformOp:orient": (Sdf.ValueTypeNames.Quatd, local.RemoveScaleShear().ExtractRotationQuat()),
                    "xformOp:scale": (Sdf.ValueTypeNames.Double3, scale),
                }
                for name, (kind, value) in values.items():
                    given = prim.attributes.get(name) or Sdf.AttributeSpec(prim, name, kind)
                    given.default = value
                order = prim.attributes.get("xformOpOrder") or Sdf.AttributeSpec(
                    prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform
                )
                order.default = list(values)

    def contact_report(self) -> tuple[list[types.SimpleNamespace], list[types.SimpleNamespace]]:
        """Return what touches since the last step: headers and points, as omni.physx does."""
        headers: list[types.SimpleNamespace] = []
        points: list[types.SimpleNamespace] = []
        for path, values in self._read_contacts().items():
            kinds = values["Type"].reshape(-1)
            positions, first = values["PointPosition"].reshape(-1, 3), 0
            for row in range(kinds.size):
                body, collider, own = (int(values[name].reshape(-1)[row]) for name in ("OtherBody", "OtherCollider", "Collider"))
                count = int(values["PointCount"].reshape(-1)[row])
                headers.append(
                    types.SimpleNamespace(
                        type=f"ContactEventType.{_CONTACT_TYPES[int(kinds[row])]}", stage_id=self._context.get_stage_id(),
                        actor0=self.number(path), collider0=self.number(self._path(own)),
                        actor1=self.number(self._path(body)), collider1=self.number(self._path(collider)),
                        contact_data_offset=len(points), num_contact_data=count,
                    )
                )  # fmt: skip
                for position in positions[first : first + count]:
                    points.append(types.SimpleNamespace(position=Gf.Vec3f(*map(float, position))))
                first += count
        return headers, points

    def number(self, path: object) -> int:
        """Return the number of a path, PhysicsSchemaTools.sdfPathToInt."""
        text = str(path)
        if text not in self._numbers:
            self._names.append(text)
            self._numbers[text] = len(self._names)
        return self._numbers[text]

    def name(self, number: int) -> Sdf.Path:
        """Return the path of a number, PhysicsSchemaTools.intToSdfPath."""
        return Sdf.Path(self._names[number - 1] if number else "")

    def _read_contacts(self) -> dict[str, dict[str, np.ndarray]]:
        found: dict[str, dict[str, np.ndarray]] = {}
        if not self.loaded:
            return found
        names = [f"contactEvent{name}" for name in _CONTACT]
        with self._physx.read_sync(SimObjectType.CONTACT_SENSOR, names) as result:
            for group in result.groups:
                name = self._paths.token_to_string(group.attribute).removeprefix("contactEvent")
                for path, tensor in zip(self._paths.get_path_strings(group.prim_list), group.tensors, strict=True):
                    found.setdefault(path, {})[name] = tensor.numpy().copy()
        return {path: values for path, values in found.items() if len(values) == len(_CONTACT)}

    def _path(self, number: int) -> str:
        if number not in self._known:
            self._known[number] = self._paths.path_to_string(number) if number else ""
        return self._known[number]

    def _articulations(self) -> list[str]:
        """Roots of articulations that PhysX has."""
        with self._physx.read_sync(SimObjectType.ARTICULATION, ["rootPosition"], scope=ObjectScope.ALL) as result:
            return [path for group in result.groups for path in self._paths.get_path_strings(group.prim_list)]

    def _results(self, stage: Usd.Stage) -> Sdf.Layer:
        if self._moved is None or self._moved.identifier not in stage.GetSessionLayer().subLayerPaths:
            self._moved = Sdf.Layer.CreateAnonymous("moved.usda")
            stage.GetSessionLayer().subLayerPaths.insert(0, self._moved.identifier)
        return self._moved

    @contextmanager
    def _quietly(self) -> Iterator[None]:
        self._writing = True
        try:
            yield
        finally:
            self._writing = False

    def _watch(self, notice: Usd.Notice.ObjectsChanged) -> None:
        """Note a change of the stage that concerns physics."""
        if self._writing or self._changed or not self.loaded:
            return
        stage = self._context.get_stage()
        for path in notice.GetResyncedPaths():
            prim = stage.GetPrimAtPath(path.GetPrimPath())
            gone = not prim and any(Sdf.Path(body).HasPrefix(path) for body in self._bodies)
            if gone or (prim and any(_is_physical(part) for part in Usd.PrimRange(prim))):
                self._changed = True
        for path in notice.GetChangedInfoOnlyPaths():
            if path.name.startswith(("physics:", "physx", "drive:")):
                self._changed = True

    def modules(self) -> dict[str, dict[str, object]]:
        """Return the members of the modules that this file stands in for."""
        events, engine = self._app.events, self

        def on_step(on_update: Callable[..., Any], pre_step: bool = False, order: int = 0) -> Subscription:
            return events.subscribe("physics.before" if pre_step else "physics.after", on_update, order)

        def on_step_alone(function: Callable[[float], Any]) -> Subscription:
            return events.subscribe("physics.after", lambda dt, _: function(dt))

        def on_contact(function: Callable[..., Any]) -> Subscription:
            return events.subscribe("physics.after", lambda dt, _: function(*engine.contact_report()))

        def simulate(dt: float, time: float) -> None:
            engine.step(dt)

        core = types.SimpleNamespace(
            simulate=simulate, flush_changes=self.flush, subscribe_physics_on_step_events=on_step,
            fetch_results=lambda: None, check_results=lambda: True,
        )  # fmt: skip
        update = types.SimpleNamespace(
            force_load_physics_from_usd=self.load, start_simulation=lambda: None, on_update=lambda *_: None,
            reset_simulation=self.unload,
        )  # fmt: skip
        registry = types.SimpleNamespace(
            get_simulation_ids=lambda: [1], get_simulation_name=lambda _: "PhysX", is_simulation_active=lambda _: True,
            subscribe_simulation_registry_events=lambda _: None, activate_simulation=lambda _: None,
            deactivate_simulation=lambda _: None, get_simulation=lambda _: None,
        )  # fmt: skip
        simulation = types.SimpleNamespace(
            get_contact_report=self.contact_report, subscribe_contact_report_events=on_contact, flush_changes=self.flush,
            simulate=simulate, fetch_results=lambda: None,
        )  # fmt: skip
        physx = types.SimpleNamespace(
            subscribe_physics_step_events=on_step_alone, force_load_physics_from_usd=self.load,
            start_simulation=lambda: None, update_simulation=simulate, update_transformations=lambda *_, **__: None,
            release_physics_objects=self.unload,
        )  # fmt: skip
        query = types.SimpleNamespace(query_prim=self._query)
        return {
            "omni.physics.core": {
                "get_physics_simulation_interface": lambda: core, "get_physics_interface": lambda: registry,
                "get_physics_stage_update_interface": lambda: update,
                "SimulationRegistryEventType": enum.Enum("SimulationRegistryEventType", "SIMULATION_ACTIVATED SIMULATION_DEACTIVATED"),
            },
            "omni.physx": {
                "get_physx_simulation_interface": lambda: simulation, "get_physx_interface": lambda: physx,
                "IPhysxSimulation": simulation, "acquire_physx_interface": lambda: physx, "get_physx_property_query_interface": lambda: query,
            },
            "omni.physxfabric": {"get_physx_fabric_interface": lambda: Nothing("omni.physxfabric.IPhysxFabric")},
        }  # fmt: skip

    def _query(self, *, prim_id: int, articulation_fn: Callable[[Any], None], **_: object) -> None:
        """Describe an articulation of the stage, before there is physics: its bodies, from the root outwards."""
        stage = self._context.get_stage()
        joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
        ends = {
            number: [str(body.GetTargets()[0]) if body.GetTargets() else "" for body in (joint.GetBody0Rel(), joint.GetBody1Rel())]
            for number, joint in enumerate(joints)
        }  # fmt: skip
        reached = {str(self.name(prim_id)): UsdPhysics.Joint()}
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


class PhysicsScenes:
    """The compiled part of isaacsim.core.simulation_manager: it watches the stage for physics scenes and deletions."""

    def __init__(self, app: App, context: Context, engine: Engine) -> None:
        self._app, self._context, self._engine = app, context, engine
        self._own = itertools.count(-1, -1)
        self._last = 0
        self.reset()
        context.watchers.append(self._watch)

    def reset(self) -> None:
        """Forget the callbacks."""
        self._added: list[Callable[[str], None]] = []
        self._deleted: dict[int, Callable[[str], None]] = {}

    def register_physics_scene_addition_callback(self, function: Callable[[str], None]) -> None:
        """Call a function with the path of each physics scene, of those that are there too."""
        self._added.append(function)
        stage = self._context.get_stage()
        for prim in stage.Traverse() if stage else ():
            if prim.IsA(UsdPhysics.Scene):
                function(str(prim.GetPath()))

    def register_deletion_callback(self, function: Callable[[str], None]) -> None:
        """Call a function with the path of each prim that is removed; its number is that of the next callback."""
        self._deleted[next(self._own) if function.__name__ == "remove_physics_scene" else self._last] = function

    def cleanup_invalid_physics_scenes(self) -> list[str]:
        """Return the scenes that are gone: those that are removed are told of at once."""
        return []

    def get_simulation_time(self) -> float:
        """Return the simulated time [s]."""
        return self._app.timeline.time

    def get_num_physics_steps(self) -> int:
        """Return the number of steps."""
        return self._engine.steps

    def is_simulating(self) -> bool:
        """Whether the timeline plays."""
        return self._app.timeline.is_playing()

    def is_paused(self) -> bool:
        """Whether it is paused."""
        return not self._app.timeline.is_playing() and not self._app.timeline.is_stopped()

    def get_callback_iter(self) -> int:
        """Return the next callback's number."""
        return self._last

    def set_callback_iter(self, value: int) -> None:
        """Set the next callback's number."""
        self._last = value

    def deregister_callback(self, number: int) -> bool:
        """Forget a callback for deletions: whether there was one of this number."""
        return self._deleted.pop(number, None) is not None

    def scene(self, path: str) -> types.SimpleNamespace:
        """Return the physics scene at a path, which is made where there is none."""
        UsdPhysics.Scene.Define(self._context.get_stage(), path)
        return types.SimpleNamespace(path=path)

    def paths(self, _: int | None) -> list[str]:
        """Return the paths of all physics scenes."""
        return [str(prim.GetPath()) for prim in self._context.get_stage().Traverse() if prim.IsA(UsdPhysics.Scene)]

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("isaacsim.core.simulation_manager.bindings"), name)

    def _watch(self, notice: Usd.Notice.ObjectsChanged) -> None:
        stage = self._context.get_stage()
        for path in notice.GetResyncedPaths():
            if not path.IsPrimPath():
                continue
            prim = stage.GetPrimAtPath(path)
            if not prim:
                for function in list(self._deleted.values()):
                    self._call(function, str(path))
                continue
            for part in Usd.PrimRange(prim):
                if part.IsA(UsdPhysics.Scene):
                    for function in list(self._added):
                        self._call(function, str(part.GetPath()))

    def _call(self, function: Callable[[str], None], path: str) -> None:
        try:
            function(path)
        except ReferenceError:
            self._deleted = {number: kept for number, kept in self._deleted.items() if kept is not function}


def _frame(stage: Usd.Stage, path: str, bodies: list[str]) -> tuple[str, Gf.Matrix4d, Gf.Vec3d]:
    """The nearest body above a body, the transform from its parent to that (or to the world), and its scale."""
    body = stage.GetPrimAtPath(path)
    parent = body.GetParent()
    above = next((name for name in map(str, Sdf.Path(path).GetParentPath().GetPrefixes()[::-1]) if name in bodies), "")
    between = UsdGeom.Xformable(parent).ComputeLocalToWorldTransform(0) if parent.IsA(UsdGeom.Xformable) else Gf.Matrix4d(1.0)
    if above:
        between *= UsdGeom.Xformable(stage.GetPrimAtPath(above)).ComputeLocalToWorldTransform(0).RemoveScaleShear().GetInverse()
    local = UsdGeom.Xformable(body).GetLocalTransformation()
    return above, between, Gf.Vec3d(*(local.GetRow3(axis).GetLength() for axis in range(3)))


def _matrix(pose: list[float]) -> Gf.Matrix4d:
    x, y, z, qx, qy, qz, qw = pose
    matrix = Gf.Matrix4d().SetRotate(Gf.Quatd(qw, qx, qy, qz))
    return matrix.SetTranslateOnly(Gf.Vec3d(x, y, z))


def _moves(prim: Usd.Prim) -> bool:
    enabled = UsdPhysics.RigidBodyAPI(prim).GetRigidBodyEnabledAttr().Get()
    return enabled is not False


def _is_physical(prim: Usd.Prim) -> bool:
    return (
        prim.HasAPI(UsdPhysics.RigidBodyAPI) or prim.HasAPI(UsdPhysics.CollisionAPI) or prim.IsA(UsdPhysics.Joint)
        or prim.IsA(UsdPhysics.Scene)
    )  # fmt: skip


