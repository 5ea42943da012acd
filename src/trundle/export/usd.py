"""Worlds and robots as USD with UsdPhysics, for Isaac Sim and others: in metres, z up."""

from __future__ import annotations

import os
from typing import Any

from trundle.export.plain import Scene
from trundle.geometry import Pose3D
from trundle.robots import Robot
from trundle.usd.write import Profile, check_profile, write_world
from trundle.worlds import World


def export_world(world: World, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a world as a USD stage: every solid is a collider with its name and colour, on a ground plane at z = 0.

    `World.load` returns the same solids, seeds, colours and kinds, meshes in single precision and other shapes in
    double precision; blocked cells come back as one mesh of their walls.

    Args:
        world: The world.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim needs: PhysX settings and a light.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its suffix is not one of USD's.
        MissingExtraError: If usd-core is not installed.
    """
    write_world(world, path, profile=profile)


def export_robot(robot: Robot, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a robot as a USD stage with an articulation whose root is its chassis.

    Bodies have the masses and inertias that trundle simulates with. Joints lie under `joints`, have the robot's names,
    and those of the drive wheels an angular velocity drive (its damping is per degree). base_link is on the ground, so
    a robot that is referenced at z = 0 stands on the floor. Wheels collide as narrow cylinders in their middle.
    Colliders have the purpose guide; visuals are separate.

    Args:
        robot: The robot.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim needs: PhysX settings, and a start slightly above the ground.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its suffix is not one of USD's.
        MissingExtraError: If usd-core is not installed.
    """
    check_profile(profile)
    from trundle.sim.mujoco.robot_stage import robot_stage
    from trundle.usd.stage import save

    stage = robot_stage(robot)
    if profile == "isaac":
        from trundle.usd.isaac import fit_for_isaac, lift

        fit_for_isaac(stage)
        lift(stage.GetDefaultPrim())
    save(stage, path)


def export_scene(scene: Scene, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a robot in a world as one USD stage: the world as `export_world` writes it, and in it the robot.

    The robot is a prim with its name beside the solids, with base_link on the ground at the start. Its paths are
    not written.

    Args:
        scene: The scene.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim needs: PhysX settings, a light, and a start slightly above the ground.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its suffix is not one of USD's.
        MissingExtraError: If usd-core is not installed.
    """
    check_profile(profile)
    from trundle.usd.stage import save

    if profile == "isaac":
        from trundle.usd import GROUND_OFFSET
        from trundle.usd.isaac import fit_for_isaac

        stage = scene_stage(scene, height=GROUND_OFFSET)
        fit_for_isaac(stage)
    else:
        stage = scene_stage(scene)
    save(stage, path)


def scene_stage(scene: Scene, *, height: float = 0.0) -> Any:
    """Make the stage of a world with the robot in it, at its start.

    Args:
        scene: The scene.
        height: Height of base_link above the floor [m].
    """
    from pxr import Gf, Sdf, UsdGeom

    from trundle.sim.mujoco.robot_stage import robot_stage
    from trundle.usd.stage import PrimNames
    from trundle.usd.world import world_stage

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
