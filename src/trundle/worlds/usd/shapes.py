"""Shapes and colours of USD's geometric prims. A shape is in its prim's own frame, or scaled to the map frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom, UsdShade

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Mesh, Sphere
from trundle.worlds import tessellate
from trundle.worlds.affine import FlattenedError, place, pose_of, scale_mesh, split
from trundle.worlds.shapes import ENDLESS, LevelPlane, is_level
from trundle.worlds.tessellate import convex_hull, triangulate
from trundle.worlds.usd.walk import TIME, Place

Placeable: TypeAlias = Box | Cylinder | Sphere | Mesh

_TO_AXIS = {
    "X": np.array([[0.0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]),
    "Y": np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]),
    "Z": np.eye(4),
}
"""Rotations from a shape along z to the same shape along one of USD's axes; act on columns."""

GREY: Color = (0.6, 0.6, 0.62, 1.0)

# Of UsdPreviewSurface and of Omniverse's materials.
_INPUTS = ("diffuseColor", "diffuse_color_constant", "diffuse_tint", "base_color", "baseColor")


@dataclass(slots=True)
class Shapes:
    """Converts prims to shapes; data that instances share is read and scaled once.

    Attributes:
        path: The file, for messages.
        colliders: Whether meshes take the shape of their colliders' approximation.
    """

    path: str
    colliders: bool
    _meshes: dict[tuple[str, str], Mesh] = field(default_factory=dict)
    _scaled: dict[tuple[str, str, tuple[float, ...]], Mesh] = field(default_factory=dict)

    def shape(self, item: Place) -> tuple[Placeable, Pose3D]:
        """Return a prim's shape and its pose in the map frame.

        Raises:
            FlattenedError: If it is empty: no faces, or a size or scale of 0.
            WorldError: If its numbers are inconsistent; the message names the prim.
        """
        prim = item.prim
        try:
            if prim.GetTypeName() == "Mesh":
                return self._mesh(item)
            shape, axis = _primitive(prim)
            return place(shape, item.matrix @ _TO_AXIS[axis])
        except FlattenedError:
            raise
        except WorldError as error:
            raise WorldError(f"{self.path}: {item.name}: {error}") from error

    def _mesh(self, item: Place) -> tuple[Placeable, Pose3D]:
        kind = item.approximation if self.colliders and item.approximation else "none"
        # Instances share their prototype's prim, and so its mesh.
        shared = item.prim.GetPrimInPrototype() if item.prim.IsInstanceProxy() else item.prim
        key = (str(shared.GetPath()), "convexHull" if kind == "convexHull" else "none")
        if key not in self._meshes:
            mesh = _read_mesh(item.prim)
            if key[1] == "convexHull":
                mesh = convex_hull(mesh.vertices[np.unique(mesh.faces)]) or mesh
            self._meshes[key] = mesh
        mesh = self._meshes[key]
        if kind == "boundingCube":
            corners = mesh.vertices[np.unique(mesh.faces)]
            low, high = corners.min(axis=0), corners.max(axis=0)
            edges = np.maximum(high - low, 1e-6 * (high - low).max())
            centred = np.eye(4)
            centred[:3, 3] = (low + high) / 2.0
            return place(Box((edges[0], edges[1], edges[2])), item.matrix @ centred)
        if kind == "boundingSphere":
            return _bounding_sphere(mesh, item.matrix)
        parts = split(item.matrix[:3, :3])
        if parts is None:
            return place(mesh, item.matrix)
        rotation, scales = parts
        scaled = (*key, tuple(round(float(scale), 12) for scale in scales))
        if scaled not in self._scaled:
            self._scaled[scaled] = scale_mesh(mesh, scales)
        return self._scaled[scaled], pose_of(item.matrix[:3, 3], rotation)


def level_plane(item: Place) -> LevelPlane | None:
    """Return a prim as a level plane that faces up; None if it is not one. A plane that collides is infinite."""
    if item.prim.GetTypeName() != "Plane":
        return None
    turned = item.matrix[:3, :3] @ _TO_AXIS[_axis(item.prim)][:3, :3]
    normal = turned[:, 2]
    length = float(np.linalg.norm(normal))
    if length == 0.0 or not is_level(float(normal[2]) / length):
        return None
    height = float(item.matrix[2, 3])
    if item.approximation is not None:
        return LevelPlane(height, ENDLESS)
    plane = UsdGeom.Plane(item.prim)
    try:
        drawn = _number(plane.GetWidthAttr()) * _number(plane.GetLengthAttr())
    except FlattenedError:
        return None
    return LevelPlane(height, drawn * abs(float(np.linalg.det(turned[:2, :2]))))


def _primitive(prim: Any) -> tuple[Placeable, str]:
    """Return a prim's shape along z, and its actual axis."""
    kind = str(prim.GetTypeName())
    if kind == "Cube":
        edge = _number(UsdGeom.Cube(prim).GetSizeAttr())
        return Box((edge, edge, edge)), "Z"
    if kind == "Sphere":
        return Sphere(_number(UsdGeom.Sphere(prim).GetRadiusAttr())), "Z"
    if kind == "Plane":
        plane = UsdGeom.Plane(prim)
        width, length = _number(plane.GetWidthAttr()), _number(plane.GetLengthAttr())
        axis = _axis(prim)
        # A plane that faces x lies along z and y: USD's width is then along z.
        if axis == "X":
            width, length = length, width
        return tessellate.rectangle_mesh(width, length), axis
    axis = _axis(prim)
    height = _number(prim.GetAttribute("height"), zero=kind.startswith("Capsule"))
    if kind in ("Cylinder_1", "Capsule_1"):
        bottom = _number(prim.GetAttribute("radiusBottom"), zero=True)
        top = _number(prim.GetAttribute("radiusTop"), zero=True)
    else:
        bottom = top = _number(prim.GetAttribute("radius"))
    if max(bottom, top) == 0.0:
        raise FlattenedError("its radii are 0")
    if kind == "Cone":
        return tessellate.cone_mesh(bottom, height), axis
    if kind.startswith("Capsule"):
        return _capsule(bottom, top, height), axis
    return (Cylinder(bottom, height) if bottom == top else tessellate.frustum_mesh(bottom, top, height)), axis


def _capsule(bottom: float, top: float, height: float) -> Mesh:
    if bottom == top:
        return tessellate.capsule_mesh(bottom, height)
    ends = [
        tessellate.sphere_mesh(radius).vertices + np.array([0.0, 0.0, sign * height / 2.0])
        for radius, sign in ((bottom, -1.0), (top, 1.0))
        if radius > 0.0
    ]
    ends.append(np.array([[0.0, 0.0, height / 2.0 if top == 0.0 else -height / 2.0]]))
    hull = convex_hull(np.concatenate(ends))
    if hull is None:
        raise FlattenedError("it is empty")
    return hull


def _axis(prim: Any) -> str:
    axis = str(prim.GetAttribute("axis").Get(TIME))
    if axis not in _TO_AXIS:
        raise WorldError(f"{prim.GetPath()}: axis must be X, Y or Z, got {axis}")
    return axis


def _number(attribute: Any, *, zero: bool = False) -> float:
    value = attribute.Get(TIME)
    number = float(value) if isinstance(value, int | float) else float("nan")
    if not np.isfinite(number) or number < 0.0:
        raise WorldError(f"{attribute.GetName()} must be a number of at least 0, got {value}")
    if number == 0.0 and not zero:
        raise FlattenedError(f"its {attribute.GetName()} is 0")
    return number


def _read_mesh(prim: Any) -> Mesh:
    mesh = UsdGeom.Mesh(prim)
    points = _array(mesh.GetPointsAttr(), np.float64).reshape(-1, 3)
    counts = _array(mesh.GetFaceVertexCountsAttr(), np.int64)
    indices = _array(mesh.GetFaceVertexIndicesAttr(), np.int64)
    if len(counts) == 0 or len(points) == 0:
        raise FlattenedError("it has no faces")
    if not np.isfinite(points).all():
        raise WorldError(f"{int((~np.isfinite(points)).any(axis=1).sum())} of its {len(points)} points are not finite")
    if counts.min() < 0 or counts.sum() != len(indices):
        raise WorldError(f"its faces have {counts.sum()} corners, but faceVertexIndices has {len(indices)} entries")
    if len(indices) and (indices.min() < 0 or indices.max() >= len(points)):
        raise WorldError(f"its faces have vertex indices outside 0..{len(points) - 1}")
    faces, owners = triangulate(points, counts, indices)
    holes = _array(mesh.GetHoleIndicesAttr(), np.int64)
    if len(holes):
        faces = faces[~np.isin(owners, holes)]
    if len(faces) == 0:
        raise FlattenedError("it has no faces")
    if mesh.GetOrientationAttr().Get(TIME) == UsdGeom.Tokens.leftHanded:
        faces = faces[:, ::-1]
    return Mesh(points, faces.astype(np.int32))


def _array(attribute: Any, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    value = attribute.Get(TIME)
    try:
        return np.array([] if value is None else value, dtype=dtype)
    except (TypeError, ValueError) as error:
        raise WorldError(f"{attribute.GetName()} is not a list of numbers: {error}") from error


def _bounding_sphere(mesh: Mesh, matrix: FloatArray) -> tuple[Placeable, Pose3D]:
    points = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = float(np.sqrt(((points - centre) ** 2).sum(axis=1).max()))
    if radius == 0.0:
        raise FlattenedError("its scale of 0 flattens it")
    return Sphere(radius), pose_of(centre, np.eye(3))


@dataclass(slots=True)
class Colors:
    """Finds colours; caches those of materials."""

    _materials: dict[str, Color | None] = field(default_factory=dict)

    def of(self, prim: Any) -> Color:
        """Return a prim's colour; the mean if it has one per vertex."""
        primvars = UsdGeom.PrimvarsAPI(prim)
        values = primvars.FindPrimvarWithInheritance("displayColor").ComputeFlattened(TIME)
        if values and np.ndim(values) == 2:
            opacities = primvars.FindPrimvarWithInheritance("displayOpacity").ComputeFlattened(TIME)
            return _color(np.mean(values, axis=0), float(np.mean(opacities)) if np.ndim(opacities) == 1 else 1.0)
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        if not material:
            return GREY
        path = str(material.GetPath())
        if path not in self._materials:
            self._materials[path] = _material_color(material)
        return self._materials[path] or GREY


def _material_color(material: Any) -> Color | None:
    for context in (UsdShade.Tokens.universalRenderContext, "mdl"):
        shader = material.ComputeSurfaceSource(context)[0]
        for name in _INPUTS if shader else ():
            entry = shader.GetInput(name)
            value = entry.Get(TIME) if entry else None
            if value is not None and np.shape(value) == (3,):
                return _color(np.array(value), 1.0)
    return None


def _color(rgb: Any, opacity: float) -> Color:
    if not (np.isfinite(rgb).all() and np.isfinite(opacity)):
        return GREY
    red, green, blue, alpha = (float(value) for value in np.clip([*rgb, opacity], 0.0, 1.0))
    return red, green, blue, alpha
