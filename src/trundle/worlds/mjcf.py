"""Worlds from MJCF, MuJoCo's format, and from URDF: their fixed geometry."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trundle.errors import WorldError, WorldWarning
from trundle.files.model_spec import GeometryChoice, compile_spec, drop_textures, read_spec
from trundle.files.uris import Folders, split_folders
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Mesh, Solid, Sphere
from trundle.worlds.options import check_choice
from trundle.worlds.shapes import (
    ENDLESS,
    LevelPlanes,
    Names,
    Part,
    capsule_parts,
    ellipsoid_mesh,
    height_field_mesh,
    make_solids,
)
from trundle.worlds.tessellate import rectangle_mesh
from trundle.worlds.world import World

if TYPE_CHECKING:
    import mujoco

PIECE = " / piece "
"""Separates a visual mesh's name from a number in the name of one of its convex collision pieces."""

_COLLIDES, _SHOWN = 1, 2


def load_mjcf(path: Path, *, geometry: GeometryChoice = "collision", paths: Folders = ()) -> World:
    """Read the fixed geometry of an MJCF or URDF file as a world.

    Boxes, cylinders, spheres, capsules, ellipsoids, meshes and height fields become solids with their colours. A level
    plane that faces up is the ground at its height (`worlds.ground.find_ground` chooses among several), any other a
    rectangle of its size. Planes without a size, bodies moved by joints and mocap bodies are left out with a warning.
    A mesh that trundle exported with convex collision pieces is read back as that mesh.

    Args:
        path: The file.
        geometry: Read collision geometry (MJCF: geoms with a contype or conaffinity) or visual geometry (MJCF: geoms
            of the groups 0 to 2, which MuJoCo shows).
        paths: Folders to search for package:// and model:// names, after those above the file.

    Raises:
        WorldError: If it cannot be read, or a mesh is missing.
        InputError: If an option is out of range.
        MissingExtraError: If it has meshes that need trimesh, and that is not installed.

    Warns:
        WorldWarning: If moving parts were left out.
    """
    import mujoco

    check_choice("geometry", geometry, ("collision", "visual"))
    spec = read_spec(path, folders=split_folders(paths), error=WorldError, geometry=geometry)
    _simplify(spec)
    model, data = compile_spec(path, spec, error=WorldError)
    wanted = _SHOWN if geometry == "visual" else _COLLIDES
    pieces = _pieces(model)
    in_pieces = set(pieces.values())
    names = Names()
    solids: list[Solid] = []
    planes = LevelPlanes()
    endless: list[str] = []
    moving: list[str] = []
    for geom in range(model.ngeom):
        collides_as_pieces = model.geom(geom).name in in_pieces
        if geom in pieces or not (collides_as_pieces or int(model.geom_group[geom]) & wanted):
            continue
        body = int(model.geom_bodyid[geom])
        if model.body_weldid[body] != 0:
            moving.append(model.body(int(model.body_rootid[body])).name or "unnamed")
            continue
        name = _name(model, geom, body)
        matrix = np.eye(4)
        matrix[:3, 3], matrix[:3, :3] = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
        if not np.isfinite(matrix).all():
            raise WorldError(f"{path}: geom {name!r}: its pose is not finite")
        parts, pose, color = _parts(model, geom), Pose3D.from_matrix(matrix), _color(model, geom)
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            if planes.take(name, parts, pose, _plane_area(model, geom), color):
                continue
            endless += [] if parts else [name]
        solids += make_solids(names, name, parts, pose, color=color, kind="model")
    ground, rectangles, without_size = planes.settle(solids, names)
    _warn_of_left_out(path, endless + without_size, moving)
    name = spec.modelname if spec.modelname not in ("", "MuJoCo Model") else path.stem
    return World(name, (*solids, *rectangles), ground_z=ground)


def _warn_of_left_out(path: Path, endless: list[str], moving: list[str]) -> None:
    if endless:
        names = ", ".join(endless)
        warnings.warn(
            f"{path}: infinite planes other than the floor were left out: {names}; give them a size",
            WorldWarning,
            stacklevel=3,
        )
    if moving:
        names = ", ".join(dict.fromkeys(moving))
        warnings.warn(
            f"{path}: geometry moved by joints was left out: {len(moving)} geoms of {names}", WorldWarning, stacklevel=3
        )


def _simplify(spec: mujoco.MjSpec) -> None:
    """Keep only the fixed geometry, so that nothing else can fail; store in the groups how it is used."""
    import mujoco

    drop_textures(spec)
    for geom in spec.geoms:
        collides = _COLLIDES if geom.contype or geom.conaffinity else 0
        shown = _SHOWN if geom.group <= 2 else 0
        geom.group = collides | shown
        geom.contype = geom.conaffinity = 0
    for body in spec.bodies:
        body.mass, body.explicitinertial = 1.0, True
        body.inertia, body.ipos = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
        body.fullinertia = (float("nan"),) * 6
    for mesh in spec.meshes:
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL


def _pieces(model: mujoco.MjModel) -> dict[int, str]:
    """Return geoms that are convex pieces of others, mapped to the names of those."""
    hidden = [geom for geom in range(model.ngeom) if not int(model.geom_group[geom]) & _SHOWN]
    named = {geom: model.geom(geom).name.rpartition(PIECE)[0] for geom in hidden}
    wholes = {model.geom(geom).name for geom in range(model.ngeom)} - {""}
    return {geom: name for geom, name in named.items() if name in wholes}


def _name(model: mujoco.MjModel, geom: int, body: int) -> str:
    """Return the geom's name; else its body's, else its mesh's, else its type."""
    import mujoco

    own = model.geom(geom).name
    if own or body != 0:
        return own or model.body(body).name or "body"
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        return model.mesh(int(model.geom_dataid[geom])).name
    return mujoco.mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_").lower()


def _color(model: mujoco.MjModel, geom: int) -> Color:
    material = int(model.geom_matid[geom])
    red, green, blue, alpha = (model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]).tolist()
    return (red, green, blue, alpha)


def _plane_area(model: mujoco.MjModel, geom: int) -> float:
    """Return the area of a plane [m²]; one that collides or has no size is infinite."""
    x, y, _ = model.geom_size[geom].tolist()
    drawn = not int(model.geom_group[geom]) & _COLLIDES and x > 0.0 and y > 0.0
    return 4.0 * x * y if drawn else ENDLESS


def _parts(model: mujoco.MjModel, geom: int) -> list[Part]:
    import mujoco

    x, y, z = model.geom_size[geom].tolist()
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_BOX:
            return [Part(Box((2.0 * x, 2.0 * y, 2.0 * z)))]
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return [Part(Cylinder(x, 2.0 * y))]
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return [Part(Sphere(x))]
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return capsule_parts(x, 2.0 * y)
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return [Part(ellipsoid_mesh((x, y, z)))]
        case mujoco.mjtGeom.mjGEOM_PLANE if x > 0.0 and y > 0.0:
            return [Part(rectangle_mesh(2.0 * x, 2.0 * y))]
        case mujoco.mjtGeom.mjGEOM_MESH | mujoco.mjtGeom.mjGEOM_SDF:
            return [Part(_mesh(model, int(model.geom_dataid[geom])))]
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            return [Part(_height_field(model, int(model.geom_dataid[geom])))]
        case _:
            return []


def _mesh(model: mujoco.MjModel, mesh: int) -> Mesh:
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    face, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return Mesh(model.mesh_vert[first : first + count], model.mesh_face[face : face + faces])


def _height_field(model: mujoco.MjModel, field: int) -> Mesh:
    rows, cols, first = (int(values[field]) for values in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
    half_x, half_y, top, base = model.hfield_size[field].tolist()
    heights = model.hfield_data[first : first + rows * cols].reshape(rows, cols).astype(np.float64) * top
    return height_field_mesh(heights, (half_x, half_y), -base)
