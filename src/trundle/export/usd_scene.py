"""A world with a robot in it as one USD stage."""

from __future__ import annotations

from typing import Any

from pxr import Gf, Sdf, UsdGeom

from trundle.export.plain import Scene
from trundle.geometry import Pose3D
from trundle.sim.mujoco.robot_stage import robot_stage
from trundle.usd.stage import PrimNames
from trundle.usd.world import world_stage


def scene_stage(scene: Scene, *, height: float = 0.0) -> Any:
    """Make the stage of a world with the robot in it, at its start.

    Args:
        scene: The scene.
        height: Height of base_link above the floor [m].
    """
    stage = world_stage(scene.world)
    root = stage.GetDefaultPrim()
    names = PrimNames()
    for taken in (*root.GetAllChildrenNames(), "Lights"):
        names.take(taken)
    robot = robot_stage(scene.robot)
    source = robot.GetDefaultPrim()
    path = root.GetPath().AppendChild(names.take(source.GetName()))
    # Joints, materials and filtered pairs refer to prims within the robot, and are remapped with it.
    Sdf.CopySpec(robot.GetRootLayer(), source.GetPath(), stage.GetRootLayer(), path)
    start = scene.start
    w, x, y, z = Pose3D.planar(start.x, start.y, height, start.yaw).quaternion
    placed = UsdGeom.Xformable(stage.GetPrimAtPath(path))
    placed.AddTranslateOp().Set(Gf.Vec3d(start.x, start.y, height))
    placed.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z))
    return stage
