"""Stands in for omni.kit.commands and omni.physx.scripts, as far as they change the stage."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade

from trundle.testing.isaac.nothing import Nothing
from trundle.testing.isaac.stage import Context, add_ground_plane


def modules(context: Context) -> dict[str, dict[str, object]]:
    """Return the members of the modules that this file stands in for."""

    class DeletePrimsCommand:
        def __init__(self, paths: list[str], stage: Usd.Stage | None = None, **_: object) -> None:
            self._paths, self._stage = paths, stage

        def do(self) -> None:
            for path in self._paths:
                (self._stage or context.stage).RemovePrim(path)

    class MovePrimCommand:
        def __init__(self, path_from: str, path_to: str, **_: object) -> None:
            self._edit = Sdf.BatchNamespaceEdit()
            self._edit.Add(str(path_from), str(path_to))

        def do(self) -> bool:
            return context.stage.GetRootLayer().Apply(self._edit)

    def create_prim(
        prim_type: str, prim_path: str = "", attributes: dict[str, Any] | None = None, **_: object
    ) -> Usd.Prim:
        path = str(prim_path) or context.free_path(context.stage, f"/{prim_type}")
        prim = context.stage.DefinePrim(path, prim_type)
        for name, value in (attributes or {}).items():
            prim.GetAttribute(name).Set(value)
        return prim

    def add_reference(stage: Usd.Stage, prim_path: str, reference: Sdf.Reference, **_: object) -> None:
        stage.GetPrimAtPath(prim_path).GetReferences().AddReference(reference)

    def add_ground(
        stage: Usd.Stage, planePath: str, axis: str = "Z", size: float = 50.0, position: Any = (0, 0, 0),
        color: Any = None, **_: object,
    ) -> str:  # fmt: skip
        return add_ground_plane(stage, context.free_path(stage, str(planePath)), axis, size, position, color)

    def transform(
        path: str, new_translation: Any = None, new_rotation_euler: Any = None, new_scale: Any = None, **_: object
    ) -> None:
        prim = context.stage.GetPrimAtPath(path)
        matrix = Gf.Transform(UsdGeom.Xformable(prim).GetLocalTransformation())
        if new_translation is not None:
            matrix.SetTranslation(Gf.Vec3d(new_translation))
        if new_rotation_euler is not None:
            x, y, z = (
                Gf.Rotation(Gf.Vec3d(*axis), angle)
                for axis, angle in zip(((1, 0, 0), (0, 1, 0), (0, 0, 1)), new_rotation_euler, strict=True)
            )
            matrix.SetRotation(x * y * z)
        if new_scale is not None:
            matrix.SetScale(Gf.Vec3d(new_scale))
        _set_transform(prim, matrix)

    commands: dict[str, Callable[..., Any]] = {
        "DeletePrims": lambda **keys: DeletePrimsCommand(**keys).do(),
        "MovePrim": lambda **keys: MovePrimCommand(**keys).do(),
        "CreatePrim": create_prim, "CreatePrimWithDefaultXform": create_prim, "AddReference": add_reference,
        "AddGroundPlane": add_ground, "TransformPrimSRT": transform,
        "ChangeProperty": lambda prop_path, value, **_: context.stage.GetPropertyAtPath(str(prop_path)).Set(value),
        "CreateMdlMaterialPrim": lambda mtl_path, mtl_url, mtl_name, **_: _add_material(
            context.stage, str(mtl_path), mtl_url, mtl_name
        ),
        "SetRigidBody": lambda path, approximationShape="convexHull", kinematic=False, **_: set_rigid_body(
            context.stage.GetPrimAtPath(path), approximationShape, kinematic
        ),
        "SetStaticCollider": lambda path, approximationShape="none", **_: set_collider(
            context.stage.GetPrimAtPath(path), approximationShape
        ),
    }  # fmt: skip

    def execute(name: str, **keys: Any) -> tuple[bool, Any]:
        command = commands.get(name.removesuffix("Command"))
        if command is None:
            return True, Nothing(f"omni.kit.commands.execute({name!r})")()
        return True, command(**keys)

    scripts: dict[str, object] = {
        "setRigidBody": set_rigid_body, "setCollider": set_collider, "setStaticCollider": set_collider,
        "add_ground_plane": lambda stage, planePath, axis, size, position, color: add_ground(
            stage, planePath, axis, size, position, color
        ),
    }  # fmt: skip
    return {
        "omni.usd.commands": {"DeletePrimsCommand": DeletePrimsCommand, "MovePrimCommand": MovePrimCommand},
        "omni.kit.commands": {"Command": type("Command", (), {}), "execute": execute},
        "omni.physx.scripts.utils": scripts,
        "omni.physx.scripts.physicsUtils": scripts,
    }


def set_collider(prim: Usd.Prim, approximationShape: str = "none", *_: object) -> None:
    """Make the shapes of a subtree collide; omni.physx.scripts.utils.setCollider."""
    for part in Usd.PrimRange(prim):
        if part.IsA(UsdGeom.Gprim):
            UsdPhysics.CollisionAPI.Apply(part)
        if part.IsA(UsdGeom.Mesh):
            UsdPhysics.MeshCollisionAPI.Apply(part).CreateApproximationAttr(approximationShape)


def set_rigid_body(prim: Usd.Prim, approximationShape: str = "convexHull", kinematic: bool = False, *_: object) -> None:
    """Make a prim a rigid body whose shapes collide; omni.physx.scripts.utils.setRigidBody."""
    UsdPhysics.RigidBodyAPI.Apply(prim).CreateKinematicEnabledAttr(kinematic)
    set_collider(prim, "convexHull" if approximationShape == "none" else approximationShape)


def _set_transform(prim: Usd.Prim, transform: Gf.Transform) -> None:
    xformable = UsdGeom.Xformable(prim)
    values = {
        UsdGeom.XformOp.TypeTranslate: transform.GetTranslation(),
        UsdGeom.XformOp.TypeOrient: transform.GetRotation().GetQuat(),
        UsdGeom.XformOp.TypeScale: transform.GetScale(),
    }
    ops = {op.GetOpType(): op for op in xformable.GetOrderedXformOps()}
    if not ops.keys() <= values.keys():
        xformable.ClearXformOpOrder()
        ops = {}
    for kind, value in values.items():
        op = ops.get(kind) or xformable.AddXformOp(kind, UsdGeom.XformOp.PrecisionDouble)
        op.Set(op.GetAttr().GetTypeName().type.pythonClass(value))
    xformable.SetXformOpOrder(sorted(xformable.GetOrderedXformOps(), key=lambda op: list(values).index(op.GetOpType())))


def _add_material(stage: Usd.Stage, path: str, url: str, name: str) -> None:
    """Add a material whose shader is of MDL, NVIDIA's language."""
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Shader")
    shader.SetSourceAsset(url, "mdl")
    shader.SetSourceAssetSubIdentifier(name, "mdl")
    shader.CreateOutput("out", Sdf.ValueTypeNames.Token)
    for output in (material.CreateSurfaceOutput, material.CreateDisplacementOutput, material.CreateVolumeOutput):
        output("mdl").ConnectToSource(shader.ConnectableAPI(), "out")
