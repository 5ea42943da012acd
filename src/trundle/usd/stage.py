"""Shared code for worlds and robots as USD stages: units, names, poses, meshes, friction, and saving."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

from trundle.errors import OutputError
from trundle.files.writing import DISK_FULL, atomic_path, cannot_write
from trundle.geometry import Pose3D
from trundle.geometry.solids import Color, Mesh

SUFFIXES = (".usd", ".usda", ".usdc")


class PrimNames:
    """Makes prim names that are valid and unique under one parent: `rack 1` becomes `rack_1`."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def take(self, name: str) -> str:
        """Return the free name most similar to the given one."""
        plain = Tf.MakeValidIdentifier(name)
        given, number = plain, 1
        while given in self._taken:
            number += 1
            given = f"{plain}_{number}"
        self._taken.add(given)
        return given


def new_stage(root: str) -> Any:
    """Return a stage in metres and kilograms with z up, whose default prim is a transform with the given name."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, f"/{root}").GetPrim())
    return stage


def save(stage: Any, path: str | os.PathLike[str]) -> None:
    """Write a stage to a file atomically.

    Raises:
        OutputError: If the file cannot be written, or its suffix is not one of USD's.
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise OutputError(f"cannot write {target}: a USD file's name ends in {', '.join(SUFFIXES)}")
    with atomic_path(target) as temporary:
        try:
            stage.GetRootLayer().Export(str(temporary))
        except Tf.ErrorException as error:
            # USD repeats its errors for every few bytes: the system's own are these.
            number = next((number for number in DISK_FULL if os.strerror(number) in str(error)), errno.EIO)
            raise cannot_write(target, OSError(number, os.strerror(number))) from error


def set_pose(xformable: Any, pose: Pose3D) -> None:
    """Set a prim's pose in its parent, in double precision."""
    xformable.AddTranslateOp().Set(Gf.Vec3d(*pose.position))
    w, x, y, z = pose.quaternion
    xformable.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z))


def set_color(gprim: Any, color: Color) -> None:
    """Set a prim's colour, and its opacity if it is not opaque."""
    gprim.CreateDisplayColorAttr([Gf.Vec3f(*color[:3])])
    if color[3] < 1.0:
        gprim.CreateDisplayOpacityAttr([color[3]])


def define_mesh(stage: Any, path: str, mesh: Mesh) -> Any:
    """Define a triangle mesh; its points are in single precision, as in USD."""
    prim = UsdGeom.Mesh.Define(stage, path)
    points = mesh.vertices.astype(np.float32)
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.faces), 3, dtype=np.int32)))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(mesh.faces).ravel()))
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    return prim


def set_extent(gprim: Any) -> None:
    """Set a prim's extent from its shape."""
    gprim.CreateExtentAttr(UsdGeom.Boundable.ComputeExtentFromPlugins(gprim, Usd.TimeCode.Default()))


def make_collider(prim: Any, *, approximation: str = "none") -> None:
    """Make a prim a collider; for a mesh with one of UsdPhysics' approximations."""
    UsdPhysics.CollisionAPI.Apply(prim)
    if prim.IsA(UsdGeom.Mesh):
        UsdPhysics.MeshCollisionAPI.Apply(prim).CreateApproximationAttr(approximation)


def friction_material(stage: Any, path: str, friction: float, *, lowest: bool) -> Any:
    """Define a material for contacts.

    Args:
        stage: The stage.
        path: Path of the material.
        friction: Static and dynamic friction.
        lowest: Whether contacts use the lower friction of the two materials. By default PhysX takes the mean, which
            gives a frictionless caster half the floor's friction.
    """
    material = UsdShade.Material.Define(stage, path)
    prim = material.GetPrim()
    physics = UsdPhysics.MaterialAPI.Apply(prim)
    physics.CreateStaticFrictionAttr(friction)
    physics.CreateDynamicFrictionAttr(friction)
    physics.CreateRestitutionAttr(0.0)
    if lowest:
        # PhysX's own schema is not in usd-core; its attributes can still be written.
        prim.AddAppliedSchema("PhysxMaterialAPI")
        prim.CreateAttribute("physxMaterial:frictionCombineMode", Sdf.ValueTypeNames.Token, False).Set("min")
    return material


def bind_friction(prim: Any, material: Any) -> None:
    """Bind a physics material to a collider."""
    binding = UsdShade.MaterialBindingAPI.Apply(prim)
    binding.Bind(material, UsdShade.Tokens.weakerThanDescendants, "physics")
