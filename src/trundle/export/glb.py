"""Worlds as GLB, the binary form of glTF 2.0: triangles with colours, for viewers and modelling programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.export.plain import plain_solids
from trundle.extras import missing_extra
from trundle.files.writing import write_bytes
from trundle.geometry.solids import Box, Cylinder, Mesh, Sphere
from trundle.worlds import World
from trundle.worlds.tessellate import as_mesh

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
        mesh = as_mesh(cast("Box | Cylinder | Sphere | Mesh", solid.shape))
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
