"""The floor and a world's solids as MuJoCo geoms."""

from __future__ import annotations

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.worlds import World

FLOOR = "world:floor"
GROUP_WORLD = 0
GROUP_CELLS = 1
"""Blocked cells lie in a group of their own, so that rays can leave out the slopes of their height field."""

# The robot's colliders are of type 1 and answer nothing; the world answers type 1 and is of no type. So the robot meets
# the world, and neither meets itself.
ROBOT_TYPE = 1


def add_floor(spec: mujoco.MjSpec) -> None:
    """Add the floor, one endless plane at z = 0 with a line every metre."""
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
        conaffinity=ROBOT_TYPE,
        group=GROUP_WORLD,
    )


def add_solids(spec: mujoco.MjSpec, world: World) -> None:
    """Add a world's solids to the world body, each as one geom of the solid's name.

    A mesh collides as its convex hull. Blocked cells become a height field whose slopes cross the floor at the edges of
    the cells, see `cell_heights`.
    """
    for solid in world.solids:
        match solid.shape:
            case Box(size):
                _add_geom(spec, solid, mujoco.mjtGeom.mjGEOM_BOX, [edge / 2.0 for edge in size])
            case Cylinder(radius, length):
                _add_geom(spec, solid, mujoco.mjtGeom.mjGEOM_CYLINDER, [radius, length / 2.0, 0.0])
            case Sphere(radius):
                _add_geom(spec, solid, mujoco.mjtGeom.mjGEOM_SPHERE, [radius, 0.0, 0.0])
            case Mesh(vertices, faces):
                spec.add_mesh(
                    name=solid.name,
                    uservert=vertices.ravel().tolist(),
                    userface=faces.ravel().tolist(),
                    inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
                )
                geom = _add_geom(spec, solid, mujoco.mjtGeom.mjGEOM_MESH, [0.0, 0.0, 0.0])
                geom.meshname = solid.name
            case OccupancyCells() as cells:
                _add_cells(spec, solid, cells)


def cell_heights(cells: OccupancyCells) -> npt.NDArray[np.float32]:
    """Heights of a field with one point in the middle of every cell, 0 (free) to 1 (blocked), with a free rim around.

    Shape (rows + 2, cols + 2). The field is sunk by the walls' own height: the slope from a blocked to a free cell then
    crosses the floor at the edge between the two, and free cells lie well below the floor.
    """
    return np.pad(cells.blocked, 1).astype(np.float32)


def _add_cells(spec: mujoco.MjSpec, solid: Solid, cells: OccupancyCells) -> None:
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
    geom = _add_geom(spec, solid, mujoco.mjtGeom.mjGEOM_HFIELD, [0.0, 0.0, 0.0])
    geom.pos = solid.pose.transform_points([middle])[0]
    geom.hfieldname = solid.name
    geom.group = GROUP_CELLS


def _add_geom(spec: mujoco.MjSpec, solid: Solid, kind: mujoco.mjtGeom, size: list[float]) -> mujoco.MjsGeom:
    return spec.worldbody.add_geom(
        name=solid.name,
        type=kind,
        size=size,
        pos=solid.pose.position,
        quat=solid.pose.quaternion,
        rgba=solid.color,
        contype=0,
        conaffinity=ROBOT_TYPE,
        group=GROUP_WORLD,
    )
