"""Worlds from mesh files."""

from __future__ import annotations

from pathlib import Path

from trundle.files.mesh import read_mesh
from trundle.geometry import Pose3D
from trundle.worlds.shapes import Names, Part, make_solids
from trundle.worlds.world import World


def load_mesh(path: Path, *, up: str | None = None, unit: str | float | None = None) -> World:
    """Read a mesh file (GLB, glTF, OBJ, STL, PLY, COLLADA) as a world: every mesh of its scene is a solid.

    Maps and lidars use the exact mesh. For collisions, a mesh that is not convex is decomposed into convex
    pieces: see `trundle.sim.convex`.

    Args:
        path: The file.
        up: The file's upward axis, "y" or "z". If None, it is the format's, see `trundle.files.mesh.read_mesh`.
        unit: The file's unit: m, cm, mm, km, in, ft, or its length in metres. If None, it is the format's.

    Raises:
        WorldError: If it cannot be read, has no faces, has vertices that are not finite numbers, or a scale of 0.
        InputError: If an option is out of range.
        MissingExtraError: If trimesh is not installed.
    """
    names = Names()
    parts = read_mesh(path, up=up, unit=unit)
    same = (1.0, 1.0, 1.0)
    solids = [
        solid
        for part in parts
        for solid in make_solids(names, part.name, [Part(part.scaled(same))], Pose3D(), color=part.color, kind="mesh")
    ]
    return World(path.stem, tuple(solids))
