"""Isaac Sim's environments and robots: their names and places, and whether a robot can drive in a stage."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any

from trundle.errors import InputError, RobotError, RobotWarning, UnknownNameError, WorldError
from trundle.files.opening import advise_missing
from trundle.robots import Robot

ASSETS_VARIABLE = "TRUNDLE_ISAAC_ASSETS"
"""Environment variable for the asset root, used without the option."""

ENVIRONMENTS = {
    "warehouse": "Isaac/Environments/Simple_Warehouse/warehouse.usd",
    "warehouse_with_forklifts": "Isaac/Environments/Simple_Warehouse/warehouse_with_forklifts.usd",
    "full_warehouse": "Isaac/Environments/Simple_Warehouse/full_warehouse.usd",
    "hospital": "Isaac/Environments/Hospital/hospital.usd",
    "office": "Isaac/Environments/Office/office.usd",
}
"""Environments by name, below the asset root."""

ROBOTS = {
    "nova_carter": "Isaac/Robots/NVIDIA/NovaCarter/nova_carter.usd",
    "turtlebot3_burger": "Isaac/Robots/Turtlebot/Turtlebot3/turtlebot3_burger.usd",
}
"""Catalogue robots that Isaac Sim also has, below the asset root."""

_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
_SCHEMES = ("http://", "https://", "omniverse://")


def is_usd(text: str) -> bool:
    """Return whether a text is the path or address of a USD file rather than a name."""
    return text.lower().endswith(_SUFFIXES)


def given_root(option: str | None) -> str | None:
    """Return the given asset root: the option, or the variable; None to ask Isaac Sim.

    Raises:
        InputError: If it is a folder that does not exist, or has no subfolder Isaac.
    """
    root = option or os.environ.get(ASSETS_VARIABLE)
    if not root:
        return None
    if root.startswith(_SCHEMES):
        return root.rstrip("/")
    folder = Path(root).expanduser()
    source = "--assets-root" if option else ASSETS_VARIABLE
    if not (folder / "Isaac").is_dir():
        raise InputError(
            f"{source} {root}: {'it has no subfolder Isaac' if folder.is_dir() else 'there is no such folder'}. "
            "Give the folder that contains Isaac/Environments and Isaac/Robots, such as …/Assets/Isaac/5.1 of the "
            "downloaded asset packs"
        )
    return str(folder.resolve())


def find_root(option: str | None) -> str:
    """Return the asset root: the given one, else Isaac Sim's own, for which it must be running.

    Raises:
        InputError: If the given one is not an asset root, or Isaac Sim's cannot be reached.
    """
    root = given_root(option)
    if root is not None:
        return root
    from isaacsim.storage.native import get_assets_root_path

    try:
        return get_assets_root_path().rstrip("/")
    except RuntimeError as error:
        raise InputError(
            f"Isaac Sim's assets cannot be reached: {error}. Without a network, download the asset packs of your "
            f"version, and give their folder (it contains Isaac/Environments) with --assets-root or {ASSETS_VARIABLE}"
        ) from error


def environment_path(name: str) -> str | None:
    """Return an environment's path below the asset root; None for the path of a USD file.

    Raises:
        UnknownNameError: If it is neither; the nearest name is offered.
        InputError: If it is a local path without a file.
    """
    if name in ENVIRONMENTS:
        return ENVIRONMENTS[name]
    if not is_usd(name):
        raise UnknownNameError("environment", name, ENVIRONMENTS)
    _check_file("environment", name)
    return None


def robot_path(name: str, usd: str | None) -> str | None:
    """Return a robot's path below the asset root; None if the path of its USD was given.

    Raises:
        InputError: If there is no USD of this robot, or its file is missing.
    """
    if usd is not None:
        if not is_usd(usd):
            raise InputError(f"--robot-usd {usd}: give a file that ends in {', '.join(_SUFFIXES)}")
        _check_file("--robot-usd", usd)
        return None
    if name not in ROBOTS:
        raise InputError(
            f"Isaac Sim has no robot {name!r} that trundle knows of (it knows {', '.join(sorted(ROBOTS))}). Give its "
            f"USD with --robot-usd; if MuJoCo is installed, `trundle export {name} --to usd` writes one"
        )
    return ROBOTS[name]


def local_environment(name: str, option: str | None = None) -> Path:
    """Return the file of an environment on this machine, to make a map of it without Isaac Sim.

    Raises:
        UnknownNameError: If there is no such environment.
        InputError: If no folder of assets is given, or the file is not in it.
    """
    below = environment_path(name)
    if below is None:
        return Path(name)
    root = given_root(option)
    if root is None or root.startswith(_SCHEMES):
        raise InputError(
            f"environment {name!r} is in Isaac Sim's assets, which are not on this machine: give the folder of "
            f"the downloaded asset packs with --assets-root or {ASSETS_VARIABLE}"
        )
    file = Path(root) / below
    if not file.is_file():
        raise InputError(f"environment {name!r}: there is no file {file}; is the environment pack unpacked there?")
    return file


def _check_file(what: str, text: str) -> None:
    if not text.startswith(_SCHEMES) and not Path(text).is_file():
        raise InputError(f"{what} {text}: no such file{advise_missing(text)}")


_UNITS = {0.01: "centimetres", 0.001: "millimetres"}


def check_units(path: str, meters: float, up: str) -> None:
    """Check that a stage is in metres with z up.

    Raises:
        WorldError: If it is not.
    """
    if abs(meters - 1.0) > 1e-6:
        raise WorldError(
            f"{path}: the stage is in {_UNITS.get(round(meters, 6), f'units of {meters:g} m')}, but robots and maps "
            f"are in metres: everything would be {1.0 / meters:g} times too large for the robot. Reference it, scaled "
            f"by {meters:g}, from a stage in metres"
        )
    if up != "Z":
        raise WorldError(f"{path}: the up axis is {up}, it must be Z. Reference it, rotated, from a stage with Z up")


def check_joints(robot: Robot, usd: str, path: str) -> None:
    """Check that Isaac Sim's stage has the robot's wheel joints below a prim path; see `check_wheel_joints`."""
    import omni.usd

    stage: Any = omni.usd.get_context().get_stage()
    check_wheel_joints(robot, usd, stage.GetPrimAtPath(path))


def check_wheel_joints(robot: Robot, usd: str, prim: Any) -> None:
    """Check that a stage has the robot's wheel joints below a prim, before a simulator looks for them.

    Raises:
        RobotError: If a joint is missing; the message lists the existing ones.

    Warns:
        RobotWarning: If a wheel joint has no velocity drive.
    """
    from pxr import Usd, UsdPhysics

    moving = {
        each.GetName(): each
        for each in Usd.PrimRange(prim)
        if each.IsA(UsdPhysics.RevoluteJoint) or each.IsA(UsdPhysics.PrismaticJoint)
    }
    missing = [name for name in (robot.drive.left_joint, robot.drive.right_joint) if name not in moving]
    if missing:
        raise RobotError(
            f"the robot's USD {usd} has no joint {' and no joint '.join(missing)}; it has "
            f"{', '.join(sorted(moving)) or 'none'}. Give its wheel joints as left_joint and right_joint in "
            "the robot's YAML"
        )
    for name in (robot.drive.left_joint, robot.drive.right_joint):
        drive = UsdPhysics.DriveAPI(moving[name], "angular")
        stiffness, damping = (
            float((drive and attribute().Get()) or 0.0) for attribute in (drive.GetStiffnessAttr, drive.GetDampingAttr)
        )
        if damping <= 0.0 or stiffness > 0.0:
            warnings.warn(
                f"{usd}: the drive of {name} has a damping of {damping:g} and a stiffness of {stiffness:g}: it will "
                "not follow a commanded speed. Give it a damping (per degree, in UsdPhysics) and a stiffness of 0",
                RobotWarning,
                stacklevel=3,
            )
