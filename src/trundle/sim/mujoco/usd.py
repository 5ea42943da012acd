"""The joints of a robot's USD file: UsdPhysics' joints, in URDF's terms."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from trundle.errors import RobotError, WorldError
from trundle.sim.mujoco.joint import Joint
from trundle.worlds.usd.stage import opened, report_missing

_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}
_TURNS, _SLIDES = ("rotX", "rotY", "rotZ"), ("transX", "transY", "transZ")


def usd_joints(path: Path) -> list[Joint]:
    """List the joints of a stage, in its order, named by their prims' paths.

    The type of a generic joint follows from the degrees of freedom that its limits leave. A missing body of a joint is
    the `world`. A joint is driven if it has a drive.

    Raises:
        RobotError: If the file cannot be read; the message names the invalid prim.

    Warns:
        WorldWarning: About missing references, whose joints are not listed.
    """
    try:
        with opened(str(path)) as stage:
            report_missing(str(path), stage, refuse=False, is_excluded=lambda _: False)
            unit = float(UsdGeom.GetStageMetersPerUnit(stage))
            prims = Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate))
            return [_joint(prim, unit) for prim in prims if prim.IsA(UsdPhysics.Joint)]
    except WorldError as error:
        raise RobotError(str(error)) from error
    except RobotError as error:
        raise RobotError(f"{path}: {error}") from error


def _joint(prim: Any, unit: float) -> Joint:
    joint = UsdPhysics.Joint(prim)
    try:
        kind, axis, limits = _freedom(prim, unit)
    except RobotError as error:
        raise RobotError(f"{prim.GetPath()}: {error}") from error
    if axis is not None:
        # From the joint's frame to the child body's.
        turn = joint.GetLocalRot1Attr().Get()
        x, y, z = (float(number) + 0.0 for number in np.round(turn.Transform(axis), 9))
        axis = (x, y, z)
    return Joint(
        name=str(prim.GetPath()),
        type=kind,
        axis=axis,
        limits=limits,
        parent=_body(joint.GetBody0Rel()),
        child=_body(joint.GetBody1Rel()),
        drives=bool(UsdPhysics.DriveAPI.GetAll(prim)),
    )


def _freedom(prim: Any, unit: float) -> tuple[str, Any, tuple[float, float] | None]:
    """Type, axis in the joint's frame, and limits [rad or m]."""
    match str(prim.GetTypeName()):
        case "PhysicsRevoluteJoint":
            joint = UsdPhysics.RevoluteJoint(prim)
            return _revolute(joint.GetAxisAttr().Get(), _limits(joint, math.pi / 180.0))
        case "PhysicsPrismaticJoint":
            joint = UsdPhysics.PrismaticJoint(prim)
            return "prismatic", _axis(joint.GetAxisAttr().Get()), _limits(joint, unit)
        case "PhysicsFixedJoint":
            return "fixed", None, None
        case "PhysicsSphericalJoint":
            return "ball", None, None
        case "PhysicsJoint":
            return _generic(prim, unit)
        case _:
            return "floating", None, None


def _generic(prim: Any, unit: float) -> tuple[str, Any, tuple[float, float] | None]:
    """Return a joint that is free except where limits lock it; a lower limit above the upper one locks an axis."""
    limits: dict[str, tuple[float, float]] = {}
    for name in (*_TURNS, *_SLIDES):
        low, high = -math.inf, math.inf
        if prim.HasAPI(UsdPhysics.LimitAPI, name):
            limit = UsdPhysics.LimitAPI.Get(prim, name)
            low, high = float(limit.GetLowAttr().Get()), float(limit.GetHighAttr().Get())
        if low <= high:
            limits[name] = (low, high)
    turns, slides = [name for name in _TURNS if name in limits], [name for name in _SLIDES if name in limits]
    match len(turns), len(slides):
        case 0, 0:
            return "fixed", None, None
        case 1, 0:
            return _revolute(turns[0][-1], _finite(limits[turns[0]], math.pi / 180.0))
        case 0, 1:
            return "prismatic", _axis(slides[0][-1]), _finite(limits[slides[0]], unit)
        case 3, 0:
            return "ball", None, None
        case 1, 2 if turns[0][-1] not in "".join(name[-1] for name in slides):
            return "planar", _axis(turns[0][-1]), None
        case _:
            return "floating", None, None


def _revolute(axis: str, limits: tuple[float, float] | None) -> tuple[str, Any, tuple[float, float] | None]:
    return ("continuous" if limits is None else "revolute"), _axis(axis), limits


def _axis(name: str) -> Any:
    if str(name) not in _AXES:
        raise RobotError(f"its axis must be X, Y or Z, got {str(name)!r}")
    return Gf.Vec3f(*_AXES[str(name)])


def _limits(joint: Any, unit: float) -> tuple[float, float] | None:
    return _finite((float(joint.GetLowerLimitAttr().Get()), float(joint.GetUpperLimitAttr().Get())), unit)


def _finite(limits: tuple[float, float], unit: float) -> tuple[float, float] | None:
    low, high = limits
    if math.isinf(low) and math.isinf(high):
        return None
    return low * unit, high * unit


def _body(relationship: Any) -> str:
    targets = relationship.GetTargets()
    return str(targets[0]) if targets else "world"
