"""Worlds as GLB, the binary form of glTF 2.0: triangles with colours, for viewers and modelling programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.errors import WorldError
from trundle.export.plain import plain_solids
from trundle.extras import missing_extra
from trundle.files.writing import write_bytes
from trundle.geometry.solids import Box, Cylinder, Mesh, Shape, Sphere
from trundle.worlds import World
from trundle.worlds.tessellate import box_mesh, cylinder_mesh, sphere_mesh

_Y_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""From trundle's axes, z up, to glTF's, y up."""


def export_world(world: World, path: Path) -> None:
    """Write a world: each solid is a node with its name, a mesh and a material of its colour.

    glTF has no boxes or cylinders: they are written as meshes, round ones at most 0.5 % larger and never smaller.

    Raises:
        WorldError: If there are too many cells.
        OutputError: If the file cannot be written.
        MissingExtraError: If trimesh is not installed.
    """
    try:
        import trimesh
        from trimesh.visual import TextureVisuals
        from trimesh.visual.material import PBRMaterial
    except ImportError as error:
        raise missing_extra("writing GLB files", "trimesh", "mesh") from error
    # trimesh's functions are untyped.
    scene = cast("Any", trimesh.Scene())
    for solid in plain_solids(world):
        mesh = _mesh(solid.shape)
        material = cast("Any", PBRMaterial)(
            baseColorFactor=np.round(np.asarray(solid.color) * 255.0).astype(np.uint8),
            alphaMode="OPAQUE" if solid.color[3] >= 1.0 else "BLEND",
            metallicFactor=0.0,
            roughnessFactor=0.8,
        )
        visual = cast("Any", TextureVisuals)(material=material)
        shape = cast("Any", trimesh.Trimesh)(mesh.vertices, mesh.faces, visual=visual, process=False)
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = solid.pose.rotation(), solid.pose.position
        scene.add_geometry(shape, node_name=solid.name, geom_name=solid.name, transform=_Y_UP @ place)
    write_bytes(path, cast("bytes", scene.export(file_type="glb")))


def _mesh(shape: Shape) -> Mesh:
    match shape:
        case Box(size):
            return box_mesh(size)
        case Cylinder(radius, length):
            return cylinder_mesh(radius, length)
        case Sphere(radius):
            return sphere_mesh(radius)
        case Mesh():
            return shape
        case _:
            raise WorldError("a GLB file cannot hold blocked cells")
