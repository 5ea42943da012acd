"""Checks that a robot can drive in a stage."""

from __future__ import annotations

import warnings
from typing import Any

from trundle.errors import RobotError, RobotWarning, WorldError
from trundle.robots import Robot

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
    """Check that the stage has the robot's wheel joints below a prim path, before Isaac Sim looks for them.

    Raises:
        RobotError: If a joint is missing; the message lists the existing ones.

    Warns:
        RobotWarning: If a wheel joint has no velocity drive.
    """
    import omni.usd
    from pxr import Usd, UsdPhysics

    stage: Any = omni.usd.get_context().get_stage()
    moving = {
        prim.GetName(): prim
        for prim in Usd.PrimRange(stage.GetPrimAtPath(path))
        if prim.IsA(UsdPhysics.RevoluteJoint) or prim.IsA(UsdPhysics.PrismaticJoint)
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
