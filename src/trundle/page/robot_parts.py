"""The visible parts of a robot: those of pictures and videos, as MuJoCo lays them out."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from trundle.geometry import FloatArray
from trundle.page.encoding import pack_array, rounded
from trundle.robots import Robot
from trundle.sim.mujoco.model import robot_spec
from trundle.sim.mujoco.robot_looks import GROUP_LOOKS

_SIDES = {1: "left", -1: "right"}


def engine_parts(robot: Robot) -> list[dict[str, Any]]:
    """Return the parts, each with its shape, pose in base_link, size, colour, and the wheel that it is part of."""
    model = robot_spec(robot).compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    sides = {int(model.jnt_bodyid[model.joint(wheel.joint).id]): _SIDES[wheel.side] for wheel in robot.drive.wheels}
    return [
        _part_of(model, data, geom, sides.get(int(model.geom_bodyid[geom])))
        for geom in range(model.ngeom)
        if model.geom_group[geom] == GROUP_LOOKS
    ]


def _part_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int, wheel: str | None) -> dict[str, Any]:
    turned = np.zeros(4)
    mujoco.mju_mat2Quat(turned, data.geom_xmat[geom])
    shape, size, mesh = _shape_of(model, geom)
    color = np.rint(255.0 * np.clip(model.geom_rgba[geom], 0.0, 1.0)).astype(int).tolist()
    return {
        "shape": shape,
        "pose": rounded([*data.geom_xpos[geom], *turned], 5),
        "size": rounded(size.tolist(), 5),
        "color": color,
        "wheel": wheel,
        "axis": None if wheel is None else [0, 1, 0],
        **mesh,
    }


def _shape_of(model: mujoco.MjModel, geom: int) -> tuple[str, FloatArray, dict[str, Any]]:
    """Return the name, size and, of a mesh, the triangles of a geom."""
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case mujoco.mjtGeom.mjGEOM_BOX:
            return "box", 2.0 * size, {}
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return "cylinder", np.array([size[0], size[0], 2.0 * size[1]]), {}
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return "sphere", np.full(3, size[0]), {}
        case _:
            mesh = model.geom_dataid[geom]
            first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            face, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            vertices = model.mesh_vert[first : first + count]
            return (
                "mesh",
                np.ptp(vertices, axis=0),
                {
                    "vertices": pack_array(vertices, "f4"),
                    "triangles": pack_array(model.mesh_face[face : face + faces], "u4"),
                },
            )
