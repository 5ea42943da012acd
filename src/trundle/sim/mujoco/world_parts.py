"""The floor and a world's solids as MuJoCo geoms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere, solids_bounds
from trundle.sim.convex import FLOOR_TOP, Pieces, take_apart
from trundle.worlds import World
from trundle.worlds.mjcf import PIECE
from trundle.worlds.movers import Mover
from trundle.worlds.movers.crowd import each_body

FLOOR = "world:floor"
MOVER = "mover:"
"""Names of the bodies and geoms of movers begin with this."""

_MOVER_PRIORITY = 10  # their contacts are theirs, not those of the robot's geoms
_MOVER_SOLREF = (0.01, 1.0)  # stiff: they push by overlapping
_MOVER_FRICTION = (0.2, 0.005, 0.0001)  # so little that wheels do not climb them
_OUT_OF_SIGHT = -100.0  # height of a crowd's members before they are placed [m]

GROUP_WORLD = 0
GROUP_CELLS = 1
"""Blocked cells have their own geom group, so that rays can ignore the slopes of their height field."""

GROUP_PIECES = 3
"""Pieces of meshes are hidden colliders, like those of the robot."""

# The robot's colliders have these contype bits and conaffinity 0; the world has the conaffinity and contype 0. So the
# robot collides with the world, and neither with itself. The floor uses MuJoCo's default: an exported robot stands on
# any floor.
FLOOR_TYPE = 1
SOLIDS_TYPE = 2


def add_floor(spec: mujoco.MjSpec) -> None:
    """Add the floor, an infinite plane at z = 0 with a line every metre."""
    spec.add_texture(
        name="world:floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=(0.66, 0.67, 0.68),
        rgb2=(0.66, 0.67, 0.68),
        markrgb=(0.57, 0.58, 0.60),
        width=256,
        height=256,
    )
    textures = [""] * int(mujoco.mjtTextureRole.mjNTEXROLE)
    textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = "world:floor"
    spec.add_material(name="world:floor", textures=textures, texuniform=True, texrepeat=(1.0, 1.0), specular=0.1)
    spec.worldbody.add_geom(
        name=FLOOR,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 0.05),
        material="world:floor",
        contype=0,
        conaffinity=FLOOR_TYPE,
        group=GROUP_WORLD,
    )


def solid_of(geom: str) -> str:
    """Name of the solid that a geom belongs to: the geom's own, or the one whose piece it is."""
    return geom.rpartition(PIECE)[0] or geom


def add_solids(spec: mujoco.MjSpec, world: World, *, ceiling: float = math.inf) -> None:
    """Add a world's solids to the world body, each as one geom of the solid's name.

    MuJoCo collides only convex bodies. A convex mesh collides unchanged; any other is only visual, and collides as
    convex pieces, geoms of a hidden group: see `trundle.sim.convex`. Solids that reach no higher than the floor do not
    collide. Blocked cells become a height field whose slopes cross the floor at the edges of the
    cells, see `cell_heights`.

    Args:
        spec: The model to add to.
        world: The world.
        ceiling: Height [m] above which meshes do not collide.
    """
    _add_to(spec, spec.worldbody, world.solids, ceiling)


def add_movers(spec: mujoco.MjSpec, world: World, *, ceiling: float = math.inf) -> None:
    """Add a world's movers, each as a mocap body `mover:NAME` whose geoms are `mover:NAME/PART`.

    A mover stands where it is at time 0, the members of a crowd out of sight until they are placed.

    Args:
        spec: The model to add to.
        world: The world.
        ceiling: Height [m] above which meshes do not collide.
    """
    places = {mover.name: mover.motion.at(0.0).pose for mover in world.movers if isinstance(mover, Mover)}
    for name, parts in each_body(world.movers):
        body = spec.worldbody.add_body(name=f"{MOVER}{name}", mocap=True)
        pose = places.get(name)
        body.pos = (0.0, 0.0, _OUT_OF_SIGHT) if pose is None else (pose.x, pose.y, 0.0)
        body.quat = (1.0, 0.0, 0.0, 0.0) if pose is None else Pose3D.planar(pose.x, pose.y, yaw=pose.yaw).quaternion
        _add_to(spec, body, [replace(part, name=f"{MOVER}{name}/{part.name}") for part in parts], ceiling)
        for geom in body.geoms:
            geom.priority, geom.solref, geom.friction = _MOVER_PRIORITY, _MOVER_SOLREF, _MOVER_FRICTION


def _add_to(spec: mujoco.MjSpec, body: mujoco.MjsBody, solids: Sequence[Solid], ceiling: float) -> None:
    """Add solids to a body, in its frame."""
    if not solids:
        return
    pieces = take_apart(solids, ceiling=ceiling)
    tops = solids_bounds(solids)[1][:, 2].tolist()
    for solid, top in zip(solids, tops, strict=True):
        geom = _add_solid(spec, body, solid)
        if solid.name in pieces and not pieces[solid.name].whole:
            geom.conaffinity = 0
            _add_pieces(spec, body, solid.name, pieces[solid.name])
        elif top <= FLOOR_TOP:
            geom.conaffinity = 0


def _add_solid(spec: mujoco.MjSpec, body: mujoco.MjsBody, solid: Solid) -> mujoco.MjsGeom:
    match solid.shape:
        case Box(size):
            return _add_geom(body, solid, mujoco.mjtGeom.mjGEOM_BOX, [edge / 2.0 for edge in size])
        case Cylinder(radius, length):
            return _add_geom(body, solid, mujoco.mjtGeom.mjGEOM_CYLINDER, [radius, length / 2.0, 0.0])
        case Sphere(radius):
            return _add_geom(body, solid, mujoco.mjtGeom.mjGEOM_SPHERE, [radius, 0.0, 0.0])
        case Mesh(vertices, faces):
            _add_mesh(spec, solid.name, vertices, faces)
            geom = _add_geom(body, solid, mujoco.mjtGeom.mjGEOM_MESH, [0.0, 0.0, 0.0])
            geom.meshname = solid.name
            return geom
        case OccupancyCells() as cells:
            return _add_cells(spec, body, solid, cells)


def _add_mesh(spec: mujoco.MjSpec, name: str, vertices: FloatArray, faces: npt.NDArray[np.int32] | None = None) -> None:
    corners = at_least_four(vertices).ravel().tolist()
    mesh = spec.add_mesh(name=name, uservert=corners, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    if faces is not None:
        mesh.userface = faces.ravel().tolist()


def at_least_four(vertices: FloatArray) -> FloatArray:
    """Return vertices [m], shape (N, 3), the first repeated if there are fewer than MuJoCo needs."""
    missing = max(0, 4 - len(vertices))
    return np.vstack([vertices, np.repeat(vertices[:1], missing, axis=0)])


def _add_pieces(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, pieces: Pieces) -> None:
    first_box = len(pieces.hulls) - pieces.boxes
    for index, (corners, _) in enumerate(pieces.hulls):
        piece = f"{name}{PIECE}{index}"
        geom = body.add_geom(name=piece, contype=0, conaffinity=SOLIDS_TYPE, group=GROUP_PIECES)
        if index < first_box:
            _add_mesh(spec, piece, corners)
            geom.type = mujoco.mjtGeom.mjGEOM_MESH
            geom.meshname = piece
        else:
            low, high = corners.min(axis=0), corners.max(axis=0)
            geom.type = mujoco.mjtGeom.mjGEOM_BOX
            geom.size, geom.pos = (high - low) / 2.0, (high + low) / 2.0


def cell_heights(cells: OccupancyCells) -> npt.NDArray[np.float32]:
    """Heights of a field with one sample at the centre of every cell, 0 (free) to 1 (blocked), with a free rim around.

    Shape (rows + 2, cols + 2). The field is lowered by the walls' height: the slope from a blocked to a free cell then
    crosses the floor at the edge between the two, and free cells are well below the floor.
    """
    return np.pad(cells.blocked, 1).astype(np.float32)


def _add_cells(spec: mujoco.MjSpec, body: mujoco.MjsBody, solid: Solid, cells: OccupancyCells) -> mujoco.MjsGeom:
    rows, cols = cells.blocked.shape
    heights = cell_heights(cells)
    half = ((cols + 1) * cells.resolution / 2.0, (rows + 1) * cells.resolution / 2.0)
    spec.add_hfield(
        name=solid.name,
        nrow=rows + 2,
        ncol=cols + 2,
        size=(*half, 2.0 * cells.height, 0.01),
        userdata=heights.ravel(),
    )
    middle = (cols * cells.resolution / 2.0, rows * cells.resolution / 2.0, -cells.height)
    geom = _add_geom(body, solid, mujoco.mjtGeom.mjGEOM_HFIELD, [0.0, 0.0, 0.0])
    geom.pos = solid.pose.transform_points([middle])[0]
    geom.hfieldname = solid.name
    geom.group = GROUP_CELLS
    return geom


def _add_geom(body: mujoco.MjsBody, solid: Solid, kind: mujoco.mjtGeom, size: list[float]) -> mujoco.MjsGeom:
    return body.add_geom(
        name=solid.name,
        type=kind,
        size=size,
        pos=solid.pose.position,
        quat=solid.pose.quaternion,
        rgba=solid.color,
        contype=0,
        conaffinity=SOLIDS_TYPE,
        group=GROUP_WORLD,
    )
