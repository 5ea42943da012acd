"""The physics of Isaac Sim: PhysX, which ovphysx runs on the CPU, with the stage that is open."""

from __future__ import annotations

import tempfile
import types
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import ovphysx  # pyright: ignore[reportMissingImports]
import ovstage  # pyright: ignore[reportMissingImports]
from ovphysx import PhysX  # pyright: ignore[reportMissingImports]
from ovphysx.types import ObjectScope, SimObjectType, TensorType  # pyright: ignore[reportMissingImports]
from pxr import Gf, Plug, Sdf, Usd, UsdGeom, UsdPhysics

from trundle.testing.isaac.kit import App
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
        PhysX.set_cpu_mode(True)
        ovphysx.set_global_config(ovphysx.GlobalConfigKey.NUM_THREADS, 0)
        self._physx = PhysX()
        ovphysx.set_log_level(ovphysx.LogLevel.ERROR)
        import physx_usd_schemas  # pyright: ignore[reportMissingImports]

        physx_usd_schemas.register_all()
        Plug.Registry().RegisterPlugins(str(ovphysx.newton_schema_root()))
        schemas = [*map(str, physx_usd_schemas.schema_paths()), str(ovphysx.newton_schema_root())]
        ovstage.population.register_usd_schemas(schemas)
        self._folder = tempfile.TemporaryDirectory(prefix="trundle-isaac-")
        self._stage: Any = None
        self._numbers: dict[str, int] = {}
        self._names: list[str] = []
        self._changed = self._writing = False
        self._targets: dict[str, float] = {}
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
        stage = self._context.stage
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
        self._tokens: dict[int, str] = {}
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
        self._reload()
        targets, self._targets = self._targets, {}
        for path in self._articulations() if targets and self.loaded else ():
            binding = self.bind([path], TensorType.ARTICULATION_DOF_VELOCITY_TARGET)
            values = self.read(path, TensorType.ARTICULATION_DOF_VELOCITY_TARGET)
            for number, name in enumerate(binding.dof_names):
                values[0, number] = targets.get(name, values[0, number])
            binding.write(values)
            binding.destroy()

    def _reload(self) -> None:
        if not (self.loaded and self._changed):
            return
        self.synchronize()
        roots = self._articulations()
        kept = [(path, kind, self.read(path, kind)) for path in roots for kind in _KEPT]
        self._physx.wait_task(self._physx.detach_ovstage())
        self._stage.destroy()
        self._stage = None
        self.load()
        left = set(self._articulations())
        for path, kind, value in (one for one in kept if one[0] in left):
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
        world = dict(zip(self._poses.prim_paths, [_matrix(pose) for pose in poses], strict=True))
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
                body, collider, own = (
                    int(values[name].reshape(-1)[row]) for name in ("OtherBody", "OtherCollider", "Collider")
                )
                count = int(values["PointCount"].reshape(-1)[row])
                headers.append(
                    types.SimpleNamespace(
                        type=f"ContactEventType.{_CONTACT_TYPES[int(kinds[row])]}",
                        actor0=self.number(path), collider0=self.number(self._path(own)),
                        actor1=self.number(self._path(body)), collider1=self.number(self._path(collider)),
                        contact_data_offset=len(points), num_contact_data=count,
                    )
                )  # fmt: skip
                found = (Gf.Vec3f(*map(float, position)) for position in positions[first : first + count])
                points += [types.SimpleNamespace(position=position) for position in found]
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
            lists: dict[int, list[str]] = {}
            for group in result.groups:
                if group.attribute not in self._tokens:
                    token = self._paths.token_to_string(group.attribute)
                    self._tokens[group.attribute] = token.removeprefix("contactEvent")
                name = self._tokens[group.attribute]
                if group.prim_list not in lists:
                    lists[group.prim_list] = self._paths.get_path_strings(group.prim_list)
                for path, tensor in zip(lists[group.prim_list], group.tensors, strict=True):
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
        moved = self._moved
        if moved is None or moved.identifier not in stage.GetSessionLayer().subLayerPaths:
            moved = self._moved = Sdf.Layer.CreateAnonymous("moved.usda")
            stage.GetSessionLayer().subLayerPaths.insert(0, moved.identifier)
        return moved

    @contextmanager
    def _quietly(self) -> Iterator[None]:
        self._writing = True
        try:
            yield
        finally:
            self._writing = False

    def _watch(self, notice: Usd.Notice.ObjectsChanged) -> None:
        """Note a change of the stage that concerns physics."""
        if self._writing or not self.loaded:
            return
        stage = self._context.stage
        for path in [*notice.GetResyncedPaths(), *notice.GetChangedInfoOnlyPaths()]:
            prim = stage.GetPrimAtPath(path.GetPrimPath())
            if not path.IsPropertyPath():
                gone = not prim and any(Sdf.Path(body).HasPrefix(path) for body in self._bodies)
                if gone or (prim and any(_is_physical(part) for part in Usd.PrimRange(prim))):
                    self._changed = True
            elif path.name == "drive:angular:physics:targetVelocity":
                self._targets[prim.GetName()] = float(np.radians(stage.GetAttributeAtPath(path).Get() or 0.0))
            elif path.name.startswith(("physics:", "physx", "drive:")):
                self._changed = True


def _frame(stage: Usd.Stage, path: str, bodies: list[str]) -> tuple[str, Gf.Matrix4d, Gf.Vec3d]:
    """The nearest body above a body, the transform from its parent to that (or to the world), and its scale."""
    body = stage.GetPrimAtPath(path)
    parent = body.GetParent()
    above = next((name for name in map(str, Sdf.Path(path).GetParentPath().GetPrefixes()[::-1]) if name in bodies), "")
    between = (
        UsdGeom.Xformable(parent).ComputeLocalToWorldTransform(0) if parent.IsA(UsdGeom.Xformable) else Gf.Matrix4d(1.0)
    )
    if above:
        between *= (
            UsdGeom.Xformable(stage.GetPrimAtPath(above))
            .ComputeLocalToWorldTransform(0)
            .RemoveScaleShear()
            .GetInverse()
        )
    local = UsdGeom.Xformable(body).GetLocalTransformation()
    return above, between, Gf.Vec3d(*(local.GetRow3(axis).GetLength() for axis in range(3)))


def _matrix(pose: Any) -> Gf.Matrix4d:
    x, y, z, qx, qy, qz, qw = map(float, pose)
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
