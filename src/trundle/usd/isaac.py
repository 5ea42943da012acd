"""Additions to a stage for Isaac Sim besides UsdPhysics: PhysX settings, a light, and a raised robot.

PhysX's schemas are not in usd-core. Their attributes are written by name, which is how Isaac Sim reads them. Names and
types are those of Omniverse PhysX' PhysxSchema.
"""

from __future__ import annotations

from typing import Any

from pxr import Gf, Sdf, UsdGeom, UsdLux, UsdPhysics, UsdShade

from trundle.usd import GROUND_OFFSET, TIMESTEP

POSITION_ITERATIONS, VELOCITY_ITERATIONS = 64, 1
"""Iterations of PhysX's solver for the robot, explicit so that they do not depend on a version's defaults.

With 4 position iterations a spin falls 4 to 6 % short; with 32 Jackal drifts 13.5 mm in 2 m, with 64 1.4 mm."""

_DEPENETRATION_SPEED = 0.1
"""Largest speed at which PhysX pushes a body of the robot out of a solid [m/s].

Without it, a robot that starts in a solid is thrown up to 24 m, or its pose becomes NaN. Of 20 depths none of that is
left at 0.1 m/s, and at 0.5 m/s 5 still end in NaN. Driving is the same to every digit."""

_SLEEP_THRESHOLD = 0.0
"""Kinetic energy by mass below which a robot falls asleep [m²/s²]: disabled."""


def fit_for_isaac(stage: Any) -> None:
    """Add what Isaac Sim needs to the stage of a world, a robot or both."""
    prims = list(stage.Traverse())
    for prim in prims:
        if prim.IsA(UsdPhysics.Scene):
            _set_scene(prim)
        if prim.HasAPI(UsdPhysics.ArticulationRootAPI):
            _set_articulation(prim)
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            fit_body(prim)
        if prim.IsA(UsdPhysics.RevoluteJoint):
            _leave_limits_to_spring(prim)
        if prim.IsA(UsdShade.Material) and not prim.GetAttribute("physxMaterial:frictionCombineMode"):
            _write(prim, "PhysxMaterialAPI", "physxMaterial:frictionCombineMode", Sdf.ValueTypeNames.Token, "average")
    if any(prim.IsA(UsdPhysics.Scene) for prim in prims):
        _add_light(stage)


def fit_body(prim: Any) -> None:
    """Limit how fast PhysX pushes a rigid body out of solids, unless it says so itself, and report all its contacts.

    PhysX reports no contacts by default.
    """
    kind, speed = Sdf.ValueTypeNames.Float, "physxRigidBody:maxDepenetrationVelocity"
    if not prim.GetAttribute(speed).HasAuthoredValue():
        _write(prim, "PhysxRigidBodyAPI", speed, kind, _DEPENETRATION_SPEED)
    _write(prim, "PhysxContactReportAPI", "physxContactReport:threshold", kind, 0.0)


def lift(prim: Any) -> None:
    """Raise a robot slightly above the ground: one that starts in the floor falls through it."""
    UsdGeom.Xformable(prim).AddTranslateOp().Set(Gf.Vec3d(0.0, 0.0, GROUND_OFFSET))


def _set_scene(prim: Any) -> None:
    types = Sdf.ValueTypeNames
    _write(prim, "PhysxSceneAPI", "physxScene:timeStepsPerSecond", types.UInt, round(1.0 / TIMESTEP))
    _write(prim, "PhysxSceneAPI", "physxScene:solverType", types.Token, "TGS", uniform=True)
    # One robot is faster on the CPU, and deterministic.
    _write(prim, "PhysxSceneAPI", "physxScene:enableGPUDynamics", types.Bool, False)
    _write(prim, "PhysxSceneAPI", "physxScene:broadphaseType", types.Token, "MBP", uniform=True)


def _set_articulation(prim: Any) -> None:
    types = Sdf.ValueTypeNames
    name = "PhysxArticulationAPI"
    _write(prim, name, "physxArticulation:solverPositionIterationCount", types.Int, POSITION_ITERATIONS)
    _write(prim, name, "physxArticulation:solverVelocityIterationCount", types.Int, VELOCITY_ITERATIONS)
    _write(prim, name, "physxArticulation:enabledSelfCollisions", types.Bool, False)
    _write(prim, name, "physxArticulation:sleepThreshold", types.Float, _SLEEP_THRESHOLD)


def _leave_limits_to_spring(prim: Any) -> None:
    """Remove the limits of a joint that a spring holds, which is the casters' frame.

    A robot that starts in a solid ends in NaN with them (4 of 40 depths), and in none of 160 poses without them. On the
    floor the spring, 100 N·m/°, does not let it reach them.
    """
    spring = UsdPhysics.DriveAPI.Get(prim, "angular")
    if spring and spring.GetStiffnessAttr().Get():
        prim.RemoveProperty("physics:lowerLimit")
        prim.RemoveProperty("physics:upperLimit")


def _write(prim: Any, schema: str, name: str, kind: Any, value: object, *, uniform: bool = False) -> None:
    if schema not in prim.GetPrimTypeInfo().GetAppliedAPISchemas():
        prim.AddAppliedSchema(schema)
    variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
    prim.CreateAttribute(name, kind, False, variability).Set(value)


def _add_light(stage: Any) -> None:
    """Add a light: an opened stage has only its own lights, and without one the window stays black."""
    root = stage.GetDefaultPrim().GetPath()
    lights = UsdGeom.Scope.Define(stage, root.AppendChild("Lights")).GetPath()
    sky = UsdLux.DomeLight.Define(stage, lights.AppendChild("Sky"))
    sky.CreateIntensityAttr(500.0)
    sun = UsdLux.DistantLight.Define(stage, lights.AppendChild("Sun"))
    sun.CreateIntensityAttr(1500.0)
    sun.CreateAngleAttr(0.53)
    # A distant light shines along its -z.
    sun.AddRotateXYZOp().Set(Gf.Vec3f(35.0, -25.0, 0.0))
