"""What a stage must be like for a robot to drive in it."""

from __future__ import annotations

from typing import Any

from trundle.errors import RobotError, WorldError
from trundle.robots import Robot

_UNITS = {0.01: "centimetres", 0.001: "millimetres"}


def check_units(path: str, meters: float, up: str) -> None:
    """See that a stage is in metres, with z up.

    Raises:
        WorldError: If it is not.
    """
    if abs(meters - 1.0) > 1e-6:
        raise WorldError(
            f"{path}: the stage is in {_UNITS.get(round(meters, 6), f'units of {meters:g} m')}, and robots and maps "
            f"are in metres: everything would be {1.0 / meters:g} times too large for the robot. Reference it, scaled "
            f"by {meters:g}, from a stage in metres"
        )
    if up != "Z":
        raise WorldError(f"{path}: in this stage {up} is up, and must be Z. Reference it, turned, from one with Z up")


def check_joints(robot: Robot, usd: str, path: str) -> None:
    """See that the stage has the joints of the robot's wheels below a prim's path, before Isaac Sim looks for them.

    Raises:
        RobotError: If it has not; the message lists those that it has.
    """
    import omni.usd
    from pxr import Usd, UsdPhysics

    stage: Any = omni.usd.get_context().get_stage()
    prims = Usd.PrimRange(stage.GetPrimAtPath(path))
    moving = [
        prim.GetName() for prim in prims if prim.IsA(UsdPhysics.RevoluteJoint) or prim.IsA(UsdPhysics.PrismaticJoint)
    ]
    missing = [name for name in (robot.drive.left_joint, robot.drive.right_joint) if name not in moving]
    if missing:
        raise RobotError(
            f"the robot's USD {usd} has no joint {' and no joint '.join(missing)}; it has "
            f"{', '.join(sorted(moving)) or 'none that moves'}. Name its wheel joints as left_joint and right_joint in "
            "the robot's YAML"
        )
