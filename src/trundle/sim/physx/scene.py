"""`Scene`: the stage that PhysX simulates: a world or an environment, and above it the robot and the movers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdUtils

from trundle.errors import RobotError, WorldError
from trundle.robots import Robot
from trundle.sim.isaac.assets import check_units, check_wheel_joints
from trundle.sim.movers import MoverField
from trundle.usd.isaac import fit_body
from trundle.usd.stage import PrimNames
from trundle.usd.world import add_solid
from trundle.worlds.usd.options import NAME
from trundle.worlds.usd.stage import opened, report_missing, usd_reason

ROBOT = "/trundle_robot"
_MOVERS = "/trundle_movers"
_LAYER = "scene.usda"


@dataclass(frozen=True, slots=True)
class Scene:
    """A stage to simulate.

    Attributes:
        file: Its root layer.
        stage: The same in usd-core, for names and bounds.
        source: What the user knows it by, for messages: the environment, or the world.
        root: Path of the prim of the robot's articulation.
        wheels: Paths of the joints of the driven wheels: left, right, left, right and so on.
        movers: Paths of the movers' bodies, in the field's order.
        mover_names: Their names, by path.
        knows_floor: Whether contacts are reported with everything but the floor. In somebody else's stage the floor
            is not known.
        height: Height at which the robot stands in the stage [m]; the floor is below.
    """

    file: Path
    stage: Any
    source: str
    root: str
    wheels: tuple[str, ...]
    movers: tuple[str, ...]
    mover_names: dict[str, str]
    knows_floor: bool
    height: float

    def name(self, collider: str) -> str:
        """Name of the solid or mover that a collider is a part of; elsewhere the collider's path."""
        mover = "/".join(collider.split("/")[:3])
        if mover in self.mover_names:
            return self.mover_names[mover]
        prim = self.stage.GetPrimAtPath(collider)
        while prim and not prim.IsPseudoRoot():
            given = prim.GetCustomDataByKey(NAME)
            if given:
                return str(given)
            prim = prim.GetParent()
        return collider

    def top(self, collider: str) -> float:
        """Return the height of a collider's highest point [m]; infinity where its bounds are not known."""
        prim = self.stage.GetPrimAtPath(collider)
        if not prim:
            return math.inf
        purposes = [UsdGeom.Tokens.default_, UsdGeom.Tokens.render, UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide]
        box = UsdGeom.BBoxCache(Usd.TimeCode.Default(), purposes).ComputeWorldBound(prim).ComputeAlignedRange()
        return math.inf if box.IsEmpty() else float(box.GetMax()[2])


def compose(
    folder: Path,
    base: Path,
    robot: Robot,
    robot_usd: str,
    *,
    own_world: bool,
    own_robot: bool,
    source: str,
    joints: tuple[str, ...],
    field: MoverField | None,
    height: float,
    timestep: float,
) -> Scene:
    """Write the stage.

    Args:
        folder: Where to.
        base: The world's or the environment's USD file.
        robot: The robot.
        robot_usd: Its USD file.
        own_world: Whether trundle wrote the base.
        own_robot: Whether trundle wrote the robot.
        source: What the user knows the base by.
        joints: Names of the driven joints.
        field: The movers.
        height: Height at which the robot stands in the stage [m].
        timestep: Length of a physics step [s].

    Raises:
        WorldError: If the base is not in metres with z up, has no collider, or cannot be opened.
        RobotError: If the robot's USD is not in metres, or has no articulation with these joints.
    """
    if not own_world:
        with opened(str(base)) as below:
            report_missing(source, below, refuse=False, is_excluded=lambda _: False)
            _check_world(below, source)
    if not own_robot:
        _check_robot_file(robot_usd)
    quiet = UsdUtils.CoalescingDiagnosticDelegate()  # its warnings would go to stderr
    try:
        layer = Sdf.Layer.CreateNew(str(folder / _LAYER))
        layer.subLayerPaths.append(str(base.resolve()))
        stage = Usd.Stage.Open(layer)
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        _set_scenes(stage, timestep)
        root = _add_robot(stage, robot_usd, height)
        if not own_robot:
            check_wheel_joints(robot, robot_usd, stage.GetPrimAtPath(ROBOT))
        movers = _add_movers(stage, field)
        _report_contacts(stage, [*_named_colliders(stage), *movers] if own_world else None)
        layer.Save()
    except Tf.ErrorException as error:
        raise WorldError(f"{source}: no stage with the robot in it can be made: {usd_reason(error)}") from error
    finally:
        quiet.TakeUncoalescedDiagnostics()
    paths = {prim.GetName(): str(prim.GetPath()) for prim in _robot_prims(stage) if prim.IsA(UsdPhysics.Joint)}
    names = dict(zip(movers, field.names if field is not None else (), strict=True))
    return Scene(
        file=folder / _LAYER,
        stage=stage,
        source=source,
        root=root,
        wheels=tuple(paths[name] for name in joints),
        movers=tuple(movers),
        mover_names=names,
        knows_floor=own_world,
        height=height,
    )


def _check_world(stage: Any, source: str) -> None:
    check_units(source, UsdGeom.GetStageMetersPerUnit(stage), str(UsdGeom.GetStageUpAxis(stage)).upper())
    prims = Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies())
    if not any(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in prims):
        raise WorldError(
            f"{source}: it has no physics: none of its prims is a collider, so the robot would fall through its floor. "
            "Add colliders (UsdPhysics' CollisionAPI) to it; `trundle export FILE --to usd` writes them for every shape"
        )


def _set_scenes(stage: Any, timestep: float) -> None:
    """Let every physics scene run on the CPU at our rate; add one where there is none."""
    scenes = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)]
    if not scenes:
        scene = UsdPhysics.Scene.Define(stage, "/trundle_physics_scene")
        scene.CreateGravityDirectionAttr(Gf.Vec3f(0.0, 0.0, -1.0))
        scene.CreateGravityMagnitudeAttr(9.81)
        scenes = [scene.GetPrim()]
    for prim in scenes:
        prim.AddAppliedSchema("PhysxSceneAPI")
        _write(prim, "physxScene:timeStepsPerSecond", Sdf.ValueTypeNames.UInt, round(1.0 / timestep))
        _write(prim, "physxScene:enableGPUDynamics", Sdf.ValueTypeNames.Bool, False)
        _write(prim, "physxScene:broadphaseType", Sdf.ValueTypeNames.Token, "MBP")


def _check_robot_file(usd: str) -> None:
    try:
        layer = Sdf.Layer.FindOrOpen(usd)
    except Tf.ErrorException as error:
        raise RobotError(f"the robot's USD {usd} cannot be read as a USD file: {usd_reason(error)}") from None
    if layer is None or not layer.defaultPrim:
        raise RobotError(f"the robot's USD {usd} has no default prim to refer to: set its defaultPrim to the robot")
    meters = layer.pseudoRoot.GetInfo("metersPerUnit") if layer.pseudoRoot.HasInfo("metersPerUnit") else 1.0
    if abs(float(meters) - 1.0) > 1e-6:
        raise RobotError(
            f"the robot's USD {usd} is in units of {float(meters):g} m, it must be in metres: reference it, scaled by "
            f"{float(meters):g}, from a stage in metres"
        )


def _add_robot(stage: Any, usd: str, height: float) -> str:
    """Reference the robot, upright at the origin; return the path of its articulation's root prim."""
    prim = stage.DefinePrim(ROBOT, "Xform")
    prim.GetReferences().AddReference(str(Path(usd).resolve()))
    xformable = UsdGeom.Xformable(prim)
    scale = Gf.Transform(xformable.GetLocalTransformation()).GetScale()
    xformable.ClearXformOpOrder()
    xformable.AddTranslateOp(opSuffix="start").Set(Gf.Vec3d(0.0, 0.0, height))
    if not Gf.IsClose(scale, Gf.Vec3d(1.0), 1e-9):
        xformable.AddScaleOp(UsdGeom.XformOp.PrecisionDouble, "start").Set(scale)
    roots = [prim for prim in _robot_prims(stage) if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    if len(roots) != 1:
        found = "it has none" if not roots else ", ".join(str(root.GetPath()) for root in roots)
        raise RobotError(
            f"the robot's USD {usd} must have one articulation (a prim with UsdPhysics' ArticulationRootAPI), found: "
            f"{found}. Is it the file of a robot with physics?"
        )
    return str(roots[0].GetPath())


def _robot_prims(stage: Any) -> list[Any]:
    return list(Usd.PrimRange(stage.GetPrimAtPath(ROBOT)))


def _add_movers(stage: Any, field: MoverField | None) -> list[str]:
    """Add a kinematic body for each mover, far below the floor until it is placed; return their paths."""
    paths: list[str] = []
    for index, kind in enumerate(field.kinds if field is not None else ()):
        path = f"{_MOVERS}/mover_{index}"
        body = UsdGeom.Xform.Define(stage, path)
        body.AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, -1000.0))
        rigid = UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
        rigid.CreateKinematicEnabledAttr(True)
        names = PrimNames()
        for part in field.bodies[kind] if field is not None else ():
            prim = add_solid(stage, f"{path}/{names.take(part.name)}", part)
            if prim.IsA(UsdGeom.Mesh):
                # PhysX takes no triangle mesh on a body that moves.
                UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Set("convexHull")
        paths.append(path)
    return paths


def _named_colliders(stage: Any) -> list[str]:
    """Return paths of the colliders that are solids of a world that trundle wrote: all but the floor."""
    return [
        str(prim.GetPath())
        for prim in stage.Traverse()
        if prim.HasAPI(UsdPhysics.CollisionAPI) and prim.GetCustomDataByKey(NAME)
    ]


def _report_contacts(stage: Any, others: list[str] | None) -> None:
    """Report the contacts of the robot's bodies, and push them out of what they overlap slowly.

    Args:
        stage: The stage.
        others: What contacts are reported with: paths of bodies and static colliders; with everything if None. Without
            the floor there is nothing to report in most steps, and reading nothing costs a third.
    """
    for prim in _robot_prims(stage):
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
            continue
        fit_body(prim)
        if others is not None:
            prim.CreateRelationship("physxContactReport:reportPairs", False).SetTargets(others)


def report_contacts(prim: Any) -> None:
    """Report every contact of a body or a static collider, however light."""
    prim.AddAppliedSchema("PhysxContactReportAPI")
    _write(prim, "physxContactReport:threshold", Sdf.ValueTypeNames.Float, 0.0)


def _write(prim: Any, name: str, kind: Any, value: object) -> None:
    prim.CreateAttribute(name, kind, False).Set(value)
