"""A `World` as a USD stage."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Gf, Sdf, UsdGeom, UsdPhysics

from trundle.errors import OutputError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.usd.stage import (
    PrimNames,
    bind_friction,
    define_mesh,
    friction_material,
    make_collider,
    new_stage,
    set_color,
    set_extent,
    set_pose,
)
from trundle.worlds import World
from trundle.worlds.tessellate import box_mesh
from trundle.worlds.usd.options import NAME, SEEDS
from trundle.worlds.walls import merge_cells

_ROOT = "World"
FRICTION = 1.0  # as the wheels': PhysX takes the mean of two materials
_FLOOR_MARGIN = 5.0  # how far the floor is drawn beyond the solids [m]
_FLOOR_COLOR = (0.66, 0.67, 0.68, 1.0)


def world_stage(world: World) -> Any:
    """Make the stage of a world; see `trundle.export.usd.export_world`."""
    stage = new_stage(_ROOT)
    _add_scene(stage)
    if world.seeds:
        seeds = stage.GetDefaultPrim().CreateAttribute(SEEDS, Sdf.ValueTypeNames.Double2Array)
        seeds.Set([Gf.Vec2d(*seed) for seed in world.seeds])
    UsdGeom.Scope.Define(stage, f"/{_ROOT}/Materials")
    material = friction_material(stage, f"/{_ROOT}/Materials/Ground", FRICTION, lowest=False)
    _add_floor(stage, world, material)
    home = f"/{_ROOT}/Solids"
    UsdGeom.Scope.Define(stage, home)
    names = PrimNames()
    paths = [f"{home}/{names.take(solid.name)}" for solid in world.solids]
    # All at once: a stage recomposes a prim's children for each one that is added.
    with Sdf.ChangeBlock():
        for path in paths:
            Sdf.CreatePrimInLayer(stage.GetRootLayer(), path).specifier = Sdf.SpecifierDef
    for path, solid in zip(paths, world.solids, strict=True):
        bind_friction(add_solid(stage, path, solid), material)
    return stage


def _add_scene(stage: Any) -> None:
    scene = UsdPhysics.Scene.Define(stage, f"/{_ROOT}/PhysicsScene")
    scene.CreateGravityDirectionAttr(Gf.Vec3f(0.0, 0.0, -1.0))
    scene.CreateGravityMagnitudeAttr(9.81)


def _add_floor(stage: Any, world: World, material: Any) -> None:
    """Add a plane under everything, which is infinite in physics."""
    low, high = world.bounds
    middle = (low + high) / 2.0
    floor = UsdGeom.Plane.Define(stage, f"/{_ROOT}/GroundPlane")
    floor.CreateAxisAttr(UsdGeom.Tokens.z)
    floor.CreateWidthAttr(float(high[0] - low[0]) + 2.0 * _FLOOR_MARGIN)
    floor.CreateLengthAttr(float(high[1] - low[1]) + 2.0 * _FLOOR_MARGIN)
    floor.AddTranslateOp().Set(Gf.Vec3d(float(middle[0]), float(middle[1]), world.ground_z or 0.0))
    set_color(floor, _FLOOR_COLOR)
    set_extent(floor)
    make_collider(floor.GetPrim())
    bind_friction(floor.GetPrim(), material)


def add_solid(stage: Any, path: str, solid: Solid) -> Any:
    """Add a solid as a collider with its name, colour and kind, and return its prim."""
    match solid.shape:
        case Box(size):
            gprim = UsdGeom.Cube.Define(stage, path)
            gprim.CreateSizeAttr(1.0)
            set_pose(gprim, solid.pose)
            gprim.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*size))
        case Sphere(radius):
            gprim = UsdGeom.Sphere.Define(stage, path)
            gprim.CreateRadiusAttr(radius)
            set_pose(gprim, solid.pose)
        case Cylinder(radius, length):
            gprim = UsdGeom.Cylinder.Define(stage, path)
            gprim.CreateAxisAttr(UsdGeom.Tokens.z)
            gprim.CreateRadiusAttr(radius)
            gprim.CreateHeightAttr(length)
            set_pose(gprim, solid.pose)
        case Mesh() as mesh:
            gprim = _add_mesh(stage, path, solid, mesh)
        case OccupancyCells() as cells:
            gprim = _add_mesh(stage, path, solid, cells_mesh(cells))
    set_extent(gprim)
    set_color(gprim, solid.color)
    prim = gprim.GetPrim()
    make_collider(prim)
    # A solid may have any name, unlike a prim.
    prim.SetCustomDataByKey(NAME, solid.name)
    if solid.kind:
        prim.AddAppliedSchema("SemanticsLabelsAPI:class")
        labels = prim.CreateAttribute("semantics:labels:class", Sdf.ValueTypeNames.TokenArray, False)
        labels.Set([solid.kind])
    return prim


def _add_mesh(stage: Any, path: str, solid: Solid, mesh: Mesh) -> Any:
    """Define a mesh with centred points, whose single precision suffers far from the origin, and move the prim."""
    middle = _middle(mesh.vertices)
    gprim = define_mesh(stage, path, Mesh(mesh.vertices - middle, mesh.faces))
    set_pose(gprim, solid.pose)
    if middle.any():
        gprim.AddTranslateOp(opSuffix="middle").Set(Gf.Vec3d(*(float(number) for number in middle)))
    return gprim


def _middle(vertices: FloatArray) -> FloatArray:
    """Return the offset [m] that centres a mesh: zero, unless it is farther from the origin than its size."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2.0
    return middle if np.abs(middle).max() > (high - low).max() else np.zeros(3)


def cells_mesh(cells: OccupancyCells) -> Mesh:
    """Return blocked cells as one mesh: a closed box for every rectangle of them, in the cells' frame."""
    rectangles = merge_cells(cells.blocked.astype(np.uint8), most=cells.blocked.size)
    if rectangles is None or len(rectangles.kind) == 0:
        raise OutputError("none of the cells is blocked: there is nothing to write")
    unit = box_mesh((1.0, 1.0, 1.0))
    low = np.column_stack([rectangles.col_begin, rectangles.row_begin, np.zeros(len(rectangles.kind))])
    high = np.column_stack([rectangles.col_end, rectangles.row_end, np.ones(len(rectangles.kind))])
    edges = np.array([cells.resolution, cells.resolution, cells.height])
    corners = (low[:, None] + (unit.vertices + 0.5) * (high - low)[:, None]) * edges
    faces = unit.faces + 8 * np.arange(len(low), dtype=np.int32)[:, None, None]
    return Mesh(corners.reshape(-1, 3), faces.reshape(-1, 3))
