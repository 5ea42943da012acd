"""The physics of Isaac Sim: PhysX, which ovphysx runs on the CPU, with the stage that is open."""

from __future__ import annotations

import tempfile
import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import ovphysx  # pyright: ignore[reportMissingImports]
import ovstage  # pyright: ignore[reportMissingImports]
from ovphysx import PhysX  # pyright: ignore[reportMissingImports]
from ovphysx.types import ObjectScope, SimObjectType, TensorType  # pyright: ignore[reportMissingImports]
from pxr import Gf, Plug, Sdf, Usd, UsdPhysics

from trundle.testing.isaac.kit import App
from trundle.testing.isaac.poses import Kept, Poses, restore
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

_KEPT_BODY = (TensorType.RIGID_BODY_POSE, TensorType.RIGID_BODY_VELOCITY)
"""The same of a body that is no link."""

_DRIVE = {
    f"drive:{axis}:physics:{name}": f"joint{quantity}"
    for axis in ("angular", "linear")
    for name, quantity in {
        "targetVelocity": "VelocityTarget", "targetPosition": "PositionTarget", "damping": "Damping",
        "stiffness": "Stiffness",
    }.items()
}  # fmt: skip
"""PhysX's quantities, in USD's units, of attributes that a script may set at every step."""

_VELOCITIES = {"physics:velocity": slice(0, 3), "physics:angularVelocity": slice(3, 6)}

_PROXIES = Usd.TraverseInstanceProxies()
_CONTACT = ("Type", "Collider", "OtherBody", "OtherCollider", "PointCount", "PointPosition")
_CONTACT_TYPES = ("CONTACT_FOUND", "CONTACT_LOST", "CONTACT_PERSIST")


class Engine:
    """PhysX, with the stage that is open.

    Attributes:
        physx: PhysX itself.
        runs: How often PhysX was given the stage; views are made anew for each.
    """

    def __init__(self, app: App, context: Context) -> None:
        self._app, self._context = app, context
        # It would like a Warp without CUDA.
        warnings.filterwarnings("ignore", message="ovphysx is in CPU-only mode")
        PhysX.set_cpu_mode(True)
        ovphysx.set_global_config(ovphysx.GlobalConfigKey.NUM_THREADS, 0)
        self.physx = PhysX()
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
        self._changed = False
        self._drive: dict[str, dict[str, float]] = {}
        self._own: set[tuple[str, int]] = set()
        self._kept: Kept = {}
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
        self.physx.wait_task(self.physx.attach_ovstage(self._stage, read_ordinal=1))
        file.unlink()
        self._paths = ovstage.PathDictionary(self._stage)
        self._known: dict[int, str] = {}
        self._tokens: dict[int, str] = {}
        self._links = set(self._of(SimObjectType.ARTICULATION_LINK, "mass"))
        self._joints = set(self._of(SimObjectType.ARTICULATION_JOINT, "jointPosition"))
        roots = {self._root_link(path): path for path in self._articulations()}
        self._poses = Poses(stage, self._bodies, links=self._links, roots=roots, physics=self, kept=self._kept)
        self._changed = False

    def unload(self) -> None:
        """Take the stage from PhysX, and what it moved back to where it was."""
        if self._stage is None:
            return
        self.physx.wait_task(self.physx.detach_ovstage())
        self._stage.destroy()
        self._stage = None
        self._own.clear()
        stage = self._context.get_stage()
        if stage is not None:
            restore(stage, self._kept)

    def flush(self) -> None:
        """Load the stage again if it was changed since, and let everything go on from where it is."""
        self._reload()
        drive, self._drive = self._drive, {}
        for quantity, values in drive.items() if self.loaded else ():
            self.set(SimObjectType.ARTICULATION_JOINT, quantity, values)

    def _reload(self) -> None:
        if not (self.loaded and self._changed):
            return
        self.synchronize()
        kept = [(path, kind, self.read(path, kind)) for path in self._articulations() for kind in _KEPT]
        kept += [(path, kind, self.read(path, kind)) for path in self._free() for kind in _KEPT_BODY]
        kept += [(path, kind, self.read(path, kind)) for path, kind in sorted(self._own)]
        self.physx.wait_task(self.physx.detach_ovstage())
        self._stage.destroy()
        self._stage = None
        self.load()
        left = {*self._articulations(), *self._bodies}
        self._own = {(path, kind) for path, kind in self._own if path in left}
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
        self.physx.step_sync(dt)
        self.steps += 1
        self._app.count(dt)
        self._app.events.send("physics.after", dt, info)

    def bind(self, paths: list[str], kind: int) -> Any:
        """Return PhysX's own view of one quantity of these prims."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return self.physx.create_tensor_binding(prim_paths=paths, tensor_type=kind)

    def read(self, path: str, kind: int) -> np.ndarray:
        """Read one quantity of one prim."""
        binding = self.bind([path], kind)
        value = np.zeros(binding.shape, np.dtype(str(binding.dtype)))
        binding.read(value)
        binding.destroy()
        return value

    def keep(self, paths: list[str], kind: int) -> None:
        """Carry this quantity of prims over when the stage changes: a script has set it, and it is not in the stage."""
        if kind not in _KEPT and kind not in _KEPT_BODY:
            self._own.update((path, kind) for path in paths)

    def set(self, kind: int, quantity: str, values: dict[str, Any]) -> None:
        """Set one quantity of objects, by their paths."""
        wanted = {self._paths.intern_path(path): value for path, value in values.items()}
        with self.physx.write_sync(kind, quantity, prim_paths=list(wanted)) as session:
            for group in session.groups:
                first = group.prim_offset
                paths = self._paths.get_paths(group.prim_list)[first : first + group.prim_count]
                # Joints have an array each, as many rows as axes; bodies have one together.
                arrays = [tensor.numpy() for tensor in group.tensors]
                for path, array in zip(paths, arrays if len(arrays) == len(paths) else arrays[0], strict=True):
                    array[...] = wanted[int(path)]
                session.commit_sync(group)

    def synchronize(self) -> None:
        """Write the poses of bodies to the stage, as Kit does once a frame."""
        if self.loaded and self._context.get_stage() is not None:
            self._poses.write()

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
        with self.physx.read_sync(SimObjectType.CONTACT_SENSOR, names) as result:
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

    def _of(self, kind: int, quantity: str) -> list[str]:
        """Return paths of all objects of a kind that PhysX has."""
        with self.physx.read_sync(kind, [quantity], scope=ObjectScope.ALL) as result:
            return [path for group in result.groups for path in self._paths.get_path_strings(group.prim_list)]

    def _articulations(self) -> list[str]:
        return self._of(SimObjectType.ARTICULATION, "rootPosition")

    def _free(self) -> list[str]:
        """Return bodies that forces move, and that are no links."""
        stage = self._context.stage
        return [
            path for path in self._bodies
            if path not in self._links and (prim := stage.GetPrimAtPath(path))
            and not UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get()
        ]  # fmt: skip

    def _root_link(self, articulation: str) -> str:
        """Return the root link of an articulation, whose path may be that of a prim above it."""
        if articulation in self._links:
            return articulation
        binding = self.bind([articulation], TensorType.ARTICULATION_ROOT_POSE)
        name, root = binding.body_names[0], Sdf.Path(articulation)
        binding.destroy()
        named = [link for link in self._links if link.rpartition("/")[2] == name]
        return max(named, key=lambda link: len(str(root.GetCommonPrefix(link))), default=articulation)

    def _watch(self, notice: Usd.Notice.ObjectsChanged) -> None:
        """Note a change of the stage that concerns physics."""
        if not self.loaded or self._poses.writing:
            return
        stage = self._context.stage
        moved: list[Sdf.Path] = []
        for path in [*notice.GetResyncedPaths(), *notice.GetChangedInfoOnlyPaths()]:
            prim = stage.GetPrimAtPath(path.GetPrimPath())
            if not path.IsPropertyPath():
                gone = [] if prim else [body for body in self._bodies if Sdf.Path(body).HasPrefix(path)]
                for body in gone:
                    self._kept.pop(body, None)
                if gone or (prim and any(_is_physical(part) for part in Usd.PrimRange(prim, _PROXIES))):
                    self._changed = True
            elif path.name.startswith("xformOp"):
                moved.append(path)
            elif path.name in _DRIVE and str(prim.GetPath()) in self._joints:
                value = float(stage.GetAttributeAtPath(path).Get() or 0.0)
                self._drive.setdefault(_DRIVE[path.name], {})[str(prim.GetPath())] = value
            elif path.name in _VELOCITIES and str(prim.GetPath()) in self._free():
                self._set_velocity(str(prim.GetPath()), path.name, stage.GetAttributeAtPath(path).Get())
            elif path.name.startswith(("physics:", "physx", "drive:")):
                self._changed = True
        if moved and self._poses.follow(moved):
            self._changed = True

    def _set_velocity(self, body: str, name: str, value: Any) -> None:
        velocity = self.read(body, TensorType.RIGID_BODY_VELOCITY)
        velocity[0, _VELOCITIES[name]] = value if name == "physics:velocity" else np.radians(value)
        binding = self.bind([body], TensorType.RIGID_BODY_VELOCITY)
        binding.write(velocity)
        binding.destroy()


def _moves(prim: Usd.Prim) -> bool:
    enabled = UsdPhysics.RigidBodyAPI(prim).GetRigidBodyEnabledAttr().Get()
    return enabled is not False


def _is_physical(prim: Usd.Prim) -> bool:
    return (
        prim.HasAPI(UsdPhysics.RigidBodyAPI) or prim.HasAPI(UsdPhysics.CollisionAPI) or prim.IsA(UsdPhysics.Joint)
        or prim.IsA(UsdPhysics.Scene)
    )  # fmt: skip
