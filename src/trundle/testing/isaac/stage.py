"""Stands in for omni.usd (the open stage), pxr.PhysxSchema (classes of the schemas) and usdrt (Fabric)."""

from __future__ import annotations

import enum
import re
import types
from collections.abc import Callable
from typing import Any, Literal

from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdUtils

from trundle.testing.isaac.events import Event, Events
from trundle.testing.isaac.nothing import Nothing


class StageEvent(enum.IntEnum):
    """omni.usd.StageEventType."""

    OPENED = 0
    CLOSED = 1
    ASSETS_LOADING = 2
    ASSETS_LOADED = 3
    SELECTION_CHANGED = 4
    CLOSING = 5


class Context:
    """omni.usd's context: one open stage.

    Attributes:
        watchers: Called with the changes of the stage.
    """

    def __init__(self, events: Events) -> None:
        self._events = events
        self.watchers: list[Callable[[Usd.Notice.ObjectsChanged], None]] = []
        self._stage: Usd.Stage | None = None
        self._notices: Any = None

    def get_stage(self) -> Usd.Stage | None:
        """Return the open stage."""
        return self._stage

    @property
    def stage(self) -> Usd.Stage:
        """The open stage, where there must be one."""
        if self._stage is None:
            raise RuntimeError("no stage is open; open one, or create one with create_new_stage")
        return self._stage

    def get_stage_id(self) -> int:
        """Return its number in USD's cache."""
        return 0 if self._stage is None else UsdUtils.StageCache.Get().Insert(self._stage).ToLongInt()

    def new_stage(self) -> bool:
        """Open an empty stage in metres, with z up."""
        stage = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        return self._open(stage)

    def open_stage(self, path: str, *_: object) -> bool:
        """Open a file: whether it could be opened. Changes are not written to it."""
        try:
            layer = Sdf.Layer.OpenAsAnonymous(str(path))
        except Tf.ErrorException:
            return False
        # A layer of its own on top: a file that is opened twice starts as it is, and relative references hold.
        root = Sdf.Layer.CreateAnonymous(".usda")
        root.subLayerPaths.append(str(path))
        stage = Usd.Stage.Open(root)
        for key in ("metersPerUnit", "upAxis", "kilogramsPerUnit", "timeCodesPerSecond"):
            if layer.pseudoRoot.HasInfo(key):
                stage.SetMetadata(key, layer.pseudoRoot.GetInfo(key))
        if layer.defaultPrim:
            root.defaultPrim = layer.defaultPrim
        return self._open(stage)

    def close_stage(self, *_: object) -> bool:
        """Close the stage."""
        self._close()
        return True

    def save_as_stage(self, path: str, *_: object) -> bool:
        """Write the stage to a file, as it is at the moment in one layer."""
        return bool(self.stage.Flatten().Export(str(path)))

    export_as_stage = save_as_stage

    def get_stage_loading_status(self) -> tuple[str, int, int]:
        """Return what is being loaded: never anything."""
        return "", 0, 0

    def get_stage_url(self) -> str:
        """Return where the stage lies."""
        return "" if self._stage is None else self._stage.GetRootLayer().identifier

    def stage_event_name(self, kind: StageEvent, *_: object) -> str:
        """Return the name of an event."""
        return f"omni.usd.stage.{StageEvent(kind).name.lower()}"

    def get_stage_event_stream(self) -> types.SimpleNamespace:
        """Return the stream of these events."""
        return self._events.stream("omni.usd.stage")

    def _open(self, stage: Usd.Stage) -> bool:
        self._close()
        self._stage = stage
        with Usd.EditContext(stage, stage.GetSessionLayer()):
            UsdGeom.Camera.Define(stage, "/OmniverseKit_Persp")
        UsdUtils.StageCache.Get().Insert(stage)
        self._notices = Tf.Notice.Register(Usd.Notice.ObjectsChanged, lambda notice, _: self._tell(notice), stage)
        self._send(StageEvent.OPENED)
        self._send(StageEvent.ASSETS_LOADED)
        return True

    def _close(self) -> None:
        if self._stage is not None:
            self._send(StageEvent.CLOSING)
            UsdUtils.StageCache.Get().Erase(self._stage)
            self._stage = self._notices = None
            self._send(StageEvent.CLOSED)

    def _send(self, kind: StageEvent) -> None:
        self._events.dispatch_event(self.stage_event_name(kind))
        self._events.send("omni.usd.stage", Event("omni.usd.stage", int(kind), {}), kind=int(kind))

    def _tell(self, notice: Usd.Notice.ObjectsChanged) -> None:
        for watcher in self.watchers:
            watcher(notice)

    def __getattr__(self, name: str) -> Nothing:
        return getattr(Nothing("omni.usd.UsdContext"), name)

    def modules(self) -> dict[str, dict[str, object]]:
        """Return the members of the modules that this file stands in for."""
        context = self

        def transform(prim: Usd.Prim, *_: object) -> Gf.Matrix4d:
            return UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())

        assembler = types.SimpleNamespace(check_layers=lambda *_: {"ret_val": False})
        return {
            "omni.usd": {
                "get_context": lambda *_: context, "UsdContext": Context, "StageEventType": StageEvent,
                "get_stage_next_free_path": self.free_path,
                "get_context_from_stage": lambda stage: context if stage is context.get_stage() else None,
                "check_ancestral": lambda prim: False, "resolve_paths": lambda *_: None,
                "get_world_transform_matrix": transform,
                "get_shader_from_material": lambda prim, *_, **__: prim.GetChild("Shader"),
                "get_local_transform_matrix": lambda prim, *_: UsdGeom.Xformable(prim).GetLocalTransformation(),
                "set_prop_val": lambda prop, value, *_: prop.Set(value),
            },
            "omni.usd.editor": {"is_no_delete": lambda _: False},
            "omni.metrics.assembler.core": {"get_metrics_assembler_interface": lambda: assembler},
            "isaacsim.core.utils.bindings._isaac_utils": {
                "_find_matching_prim_paths": lambda pattern, _, kind="": self.match(pattern, kind),
                "transforms": Nothing("isaacsim.core.utils.bindings.transforms"),
            },
            **_fabric(context),
        }  # fmt: skip

    @staticmethod
    def free_path(stage: Usd.Stage, path: str, prepend_default_prim: bool = True) -> str:
        """Return a path at which there is no prim yet."""
        if (
            prepend_default_prim
            and stage.HasDefaultPrim()
            and not path.startswith(str(top := stage.GetDefaultPrim().GetPath()))
        ):
            path = f"{top}{path}"
        taken = [path, *(f"{path}_{n:02}" for n in range(1, 10_000))]
        return next(name for name in taken if not stage.GetPrimAtPath(name))

    def match(self, pattern: str, kind: str = "") -> list[str]:
        """Return paths of prims by a pattern: `*` or `.*` is any text but a slash, others are [0-9] and (a|b)."""
        if self._stage is None:
            return []
        parts = pattern.strip("/").split("/")
        found = [self._stage.GetPseudoRoot()]
        for part in parts:
            expression = re.compile(part.replace(".*", "*").replace("*", ".*").replace("?", ".").replace("[!", "[^"))
            wanted = [prim.GetChild(part) for prim in found] if part.isidentifier() else [
                child for prim in found for child in prim.GetChildren() if expression.fullmatch(child.GetName())
            ]  # fmt: skip
            found = [prim for prim in wanted if prim]
        return [str(prim.GetPath()) for prim in found if not kind or _is_kind(prim, kind)]


def add_ground_plane(
    stage: Usd.Stage, path: str, axis: str = "Z", size: float = 50.0, position: Any = (0.0, 0.0, 0.0), color: Any = None
) -> str:
    """Add a plane without end that collides, and a square that is seen; PhysicsSchemaTools.addGroundPlane."""
    UsdGeom.XformCommonAPI(UsdGeom.Xform.Define(stage, path)).SetTranslate(Gf.Vec3d(*position))
    plane = UsdGeom.Plane.Define(stage, f"{path}/geom")
    plane.CreateAxisAttr(axis)
    plane.CreatePurposeAttr(UsdGeom.Tokens.guide)
    UsdPhysics.CollisionAPI.Apply(plane.GetPrim())
    square = UsdGeom.Mesh.Define(stage, f"{path}/CollisionMesh")
    square.CreatePointsAttr([Gf.Vec3f(x * size, y * size, 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    square.CreateFaceVertexCountsAttr([4])
    square.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    square.CreateDisplayColorAttr([Gf.Vec3f(*(color or (0.5, 0.5, 0.5)))])
    return path


def _is_kind(prim: Usd.Prim, kind: str) -> bool:
    """Return NVIDIA's name for a kind of prim: a root of an articulation, a rigid body, or a schema's type."""
    names = {"articulation": "PhysicsArticulationRootAPI", "rigid_body": "PhysicsRigidBodyAPI"}
    return prim.HasAPI(names[kind]) if kind in names else prim.GetTypeName() == kind


def _fabric(context: Context) -> dict[str, dict[str, object]]:
    """usdrt: the types of Fabric's copy of the stage; as there is no copy, its stage is not valid."""
    usd: dict[str, object] = {name: type(name, (), {}) for name in ("Prim", "SchemaBase", "PrimRange", "Access")}
    usd["Stage"] = type("Stage", (), {"Attach": staticmethod(lambda _: Nothing("usdrt.Usd.Stage"))})
    members: dict[str, object] = {"Usd": types.SimpleNamespace(**usd), "Gf": Gf, "Sdf": Sdf}
    return {"usdrt": members, "usdrt.Usd": usd, "usdrt.Gf": vars(Gf), "usdrt.Sdf": vars(Sdf)}


class _Tokens:
    """PhysxSchema.Tokens: each is its name."""

    def __getattr__(self, name: str) -> str:
        return name


class _Schema:
    """A class of pxr.PhysxSchema; usd-core knows the schema by its name, and has no class for it."""

    schema: str

    def __init__(self, prim: Any = None, instance: str = "") -> None:
        self._prim = prim.GetPrim() if prim is not None else Usd.Prim()
        self._instance = instance

    @classmethod
    def Apply(cls, prim: Usd.Prim, *instance: str) -> _Schema:
        prim.ApplyAPI(cls.schema, *instance)
        return cls(prim, *instance)

    @classmethod
    def Get(cls, stage_or_prim: Any, where: Any) -> _Schema:
        if isinstance(stage_or_prim, Usd.Prim):
            return cls(stage_or_prim, where)
        return cls(stage_or_prim.GetPrimAtPath(where))

    def GetPrim(self) -> Usd.Prim:
        return self._prim

    def GetPath(self) -> Sdf.Path:
        return self._prim.GetPath()

    def __bool__(self) -> bool:
        return self._prim.IsValid() and self._prim.HasAPI(self.schema)

    def __getattr__(self, name: str) -> Callable[..., Usd.Attribute]:
        verb: Literal["Get", "Create"] = "Create" if name.startswith("Create") else "Get"
        kind = "Rel" if name.endswith("Rel") else "Attr"
        if not name.startswith(verb) or not name.endswith(kind):
            raise AttributeError(name)
        wanted = name.removeprefix(verb).removesuffix(kind).lower()

        def access(value: object = None, write_sparsely: bool = False) -> Any:
            found = next((path for path in self._properties() if path.rpartition(":")[2].lower() == wanted), None)
            if found is None:
                raise AttributeError(f"{self.schema} has no {wanted}")
            if kind == "Rel":
                return self._prim.GetRelationship(found)
            attribute = self._prim.GetAttribute(found)
            if verb == "Create" and value is not None:
                attribute.Set(value)
            return attribute

        return access

    def _properties(self) -> list[str]:
        registry = Usd.SchemaRegistry()
        definition = registry.FindAppliedAPIPrimDefinition(self.schema) or registry.FindConcretePrimDefinition(
            self.schema
        )
        names = definition.GetPropertyNames() if definition else []
        return [name.replace("__INSTANCE_NAME__", self._instance) for name in names]


class _JointSchema(_Schema):
    """PhysxJointAPI of Isaac Sim 5; since 6 there is a schema for each axis of a joint, without a friction like its."""

    schema = "PhysxJointAxisAPI"

    def __init__(self, prim: Any = None, instance: str = "") -> None:
        super().__init__(prim, instance)
        self._instance = instance or (
            "linear" if self._prim and self._prim.IsA(UsdPhysics.PrismaticJoint) else "angular"
        )

    @classmethod
    def Apply(cls, prim: Usd.Prim, *instance: str) -> _Schema:
        made = cls(prim, *instance)
        prim.ApplyAPI(cls.schema, made._instance)
        return made

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.endswith("JointFrictionAttr"):
            return getattr(Nothing("pxr.PhysxSchema.PhysxJointAPI"), name)
        return super().__getattr__(name)


def physx_schema() -> types.ModuleType:
    """Return a module like pxr.PhysxSchema, and make prims accept its classes."""

    class Module(types.ModuleType):
        Tokens = _Tokens()
        PhysxJointAPI = _JointSchema

        def __getattr__(self, name: str) -> type[_Schema]:
            if name.startswith("__"):
                raise AttributeError(name)
            made = type(name, (_Schema,), {"schema": name})
            setattr(self, name, made)
            return made

    def accept(method: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *arguments: method(*(_schema_name(argument) for argument in arguments))

    for name in ("HasAPI", "ApplyAPI", "RemoveAPI", "CanApplyAPI", "IsA"):
        setattr(Usd.Prim, name, accept(getattr(Usd.Prim, name)))
    for name in ("IsMultipleApplyAPISchema", "IsAppliedAPISchema"):
        setattr(Usd.SchemaRegistry, name, staticmethod(accept(getattr(Usd.SchemaRegistry, name))))
    return Module("pxr.PhysxSchema")


def _schema_name(argument: Any) -> Any:
    return argument.schema if isinstance(argument, type) and issubclass(argument, _Schema) else argument
