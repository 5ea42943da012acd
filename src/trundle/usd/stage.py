"""What worlds and robots as USD stages have in common: units, names, poses, meshes, friction, and saving."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

from trundle.errors import OutputError
from trundle.files.writing import atomic_path
from trundle.geometry import Pose3D
from trundle.solids import Color, Mesh

SUFFIXES = (".usd", ".usda", ".usdc")


class PrimNames:
    """Gives out names of prims that are valid and unique under one parent: `rack 1` becomes `rack_1`."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def take(self, name: str) -> str:
        """Take the name that is nearest to a given one."""
        plain = Tf.MakeValidIdentifier(name)
        given, number = plain, 1
        while given in self._taken:
            number += 1
            given = f"{plain}_{number}"
        self._taken.add(given)
        return given


def new_stage(root: str) -> Any:
    """A stage in metres and kilograms with z up, whose default prim is a transform of the given name."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, f"/{root}").GetPrim())
    return stage


def save(stage: Any, path: str | os.PathLike[str]) -> None:
    """Write a stage to a file, or leave what was there.

    Raises:
        OutputError: If the file cannot be written, or its name does not end as a USD file's does.
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise OutputError(f"cannot write {target}: a USD file's name ends in {', '.join(SUFFIXES)}")
    with atomic_path(target) as temporary:
        try:
            stage.GetRootLayer().Export(str(temporary))
        except Tf.ErrorException as error:
            raise OutputError(f"cannot write {target}: {error}") from error


def set_pose(xformable: Any, pose: Pose3D) -> None:
    """Give a prim its place in its parent, in double precision."""
    xformable.AddTranslateOp().Set(Gf.Vec3d(*pose.position))
    w, x, y, z = pose.quaternion
    xformable.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z))


def set_color(gprim: Any, color: Color) -> None:
    """Give a prim one colour, and an opacity where it is not opaque."""
    gprim.CreateDisplayColorAttr([Gf.Vec3f(*color[:3])])
    if color[3] < 1.0:
        gprim.CreateDisplayOpacityAttr([color[3]])


def define_mesh(stage: Any, path: str, mesh: Mesh) -> Any:
    """Define a triangle mesh; its points are in single precision, as USD has them."""
    prim = UsdGeom.Mesh.Define(stage, path)
    points = mesh.vertices.astype(np.float32)
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.faces), 3, dtype=np.int32)))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(mesh.faces).ravel()))
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    return prim


def set_extent(gprim: Any) -> None:
    """Give a prim the extent that its shape has."""
    gprim.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(gprim, Usd.TimeCode.Default()))


def make_collider(prim: Any, *, approximation: str = "none") -> None:
    """Let a prim collide; a mesh as its approximation says, in UsdPhysics' words."""
    UsdPhysics.CollisionAPI.Apply(prim)
    if prim.IsA(UsdGeom.Mesh):
        UsdPhysics.MeshCollisionAPI.Apply(prim).CreateApproximationAttr(approximation)


def friction_material(stage: Any, path: str, friction: float, *, lowest: bool) -> Any:
    """Define a material for contacts.

    Args:
        stage: Where.
        path: Its path.
        friction: Static and dynamic.
        lowest: Whether the lower friction of the two that touch counts. PhysX takes the mean else, and gives a caster
            without friction that of half the floor's.
    """
    material = UsdShade.Material.Define(stage, path)
    prim = material.GetPrim()
    physics = UsdPhysics.MaterialAPI.Apply(prim)
    physics.CreateStaticFrictionAttr(friction)
    physics.CreateDynamicFrictionAttr(friction)
    physics.CreateRestitutionAttr(0.0)
    if lowest:
        # PhysX's own schema is not in usd-core; its attributes can be written all the same.
        prim.AddAppliedSchema("PhysxMaterialAPI")
        prim.CreateAttribute("physxMaterial:frictionCombineMode", Sdf.ValueTypeNames.Token, False).Set("min")
    return material


def bind_friction(prim: Any, material: Any) -> None:
    """Let a collider's contacts have a material."""
    binding = UsdShade.MaterialBindingAPI.Apply(prim)
    binding.Bind(material, UsdShade.Tokens.weakerThanDescendants, "physics")
