"""Worlds and robots as USD with UsdPhysics, for Isaac Sim and others: in metres, z up."""

from __future__ import annotations

import os

from trundle.export.scene import Scene
from trundle.robots import Robot
from trundle.usd.write import Profile, check_profile, write_world
from trundle.worlds import World


def export_world(world: World, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a world as a USD stage: every solid a collider of its name and colour, on a ground plane at z = 0.

    `World.load` gives back the same solids, seeds, colours and kinds, to single precision where they are meshes and to
    double precision where not; blocked cells come back as one mesh of their walls.

    Args:
        world: What to write.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim wants: settings of PhysX, and light.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its name ends otherwise.
        MissingExtraError: If usd-core is not installed.
    """
    write_world(world, path, profile=profile)


def export_robot(robot: Robot, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a robot as a USD stage with an articulation whose root is its chassis.

    Bodies have the masses and inertias that trundle simulates with. Joints lie under `joints`, have the robot's names,
    and those of the drive wheels an angular velocity drive (its damping is per degree). base_link is on the ground, so
    a robot that is referenced at z = 0 stands on the floor. Wheels collide as narrow cylinders in their middle.
    Colliders are of the purpose guide; what is seen is apart from them.

    Args:
        robot: What to write.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim wants: settings of PhysX, and a robot that stands clear of the ground.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its name ends otherwise.
        MissingExtraError: If usd-core is not installed.
    """
    check_profile(profile)
    from trundle.export.usd_robot import robot_stage
    from trundle.usd.stage import save

    stage = robot_stage(robot)
    if profile == "isaac":
        from trundle.usd.isaac import fit_for_isaac, lift

        fit_for_isaac(stage)
        lift(stage.GetDefaultPrim())
    save(stage, path)


def export_scene(scene: Scene, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a robot in a world as one USD stage: the world as `export_world` writes it, and in it the robot.

    The robot is a prim of its own name beside the solids, with its base_link on the ground at the start. Its paths are
    not written.

    Args:
        scene: What to write.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.
        profile: "isaac" adds what Isaac Sim wants: settings of PhysX, light, and a robot that stands clear of the
            ground.

    Raises:
        UnknownNameError: If there is no such profile.
        OutputError: If the file cannot be written, or its name ends otherwise.
        MissingExtraError: If usd-core is not installed.
    """
    check_profile(profile)
    from trundle.export.usd_scene import scene_stage
    from trundle.usd.stage import save

    if profile == "isaac":
        from trundle.usd.isaac import fit_for_isaac
        from trundle.usd.isaac_physics import GROUND_OFFSET

        stage = scene_stage(scene, height=GROUND_OFFSET)
        fit_for_isaac(stage)
    else:
        stage = scene_stage(scene)
    save(stage, path)
