"""Worlds and robots as USD with UsdPhysics, for Isaac Sim and others: in metres, z up."""

from __future__ import annotations

import os

from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.usd import need_usd


def export_world(world: World, path: str | os.PathLike[str]) -> None:
    """Write a world as a USD stage: every solid a collider of its name and colour, on a ground plane at z = 0.

    `World.load` gives back the same solids, seeds, colours and kinds, to single precision where they are meshes and to
    double precision where not; blocked cells come back as one mesh of their walls.

    Args:
        world: What to write.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.

    Raises:
        OutputError: If the file cannot be written, or its name ends otherwise.
        MissingExtraError: If usd-core is not installed.
    """
    need_usd("writing USD")
    from trundle.export.usd_stage import save
    from trundle.export.usd_world import world_stage

    save(world_stage(world), path)


def export_robot(robot: Robot, path: str | os.PathLike[str]) -> None:
    """Write a robot as a USD stage with an articulation whose root is its chassis.

    Bodies have the masses and inertias that trundle simulates with. Joints lie under `joints`, have the robot's names,
    and those of the drive wheels an angular velocity drive (its damping is per degree). base_link is on the ground, so
    a robot that is referenced at z = 0 stands on the floor. Wheels collide as cylinders. Colliders are of the purpose
    guide; what is seen is apart from them.

    Args:
        robot: What to write.
        path: A .usd (binary), .usdc (binary) or .usda (text) file.

    Raises:
        OutputError: If the file cannot be written, or its name ends otherwise.
        MissingExtraError: If usd-core is not installed.
    """
    need_usd("writing USD")
    from trundle.export.usd_robot import robot_stage
    from trundle.export.usd_stage import save

    save(robot_stage(robot), path)
