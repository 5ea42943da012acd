"""USD for Isaac Sim: what the profile adds, whole scenes, and every number against where it comes from."""

import math

import mujoco
import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade, UsdValidation

from trundle.errors import UnknownNameError
from trundle.export import Scene, export_robot, export_scene, export_world
from trundle.export.usd import scene_stage
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid, Sphere
from trundle.robots import Robot, robot_names
from trundle.sim import simulate
from trundle.sim.mujoco.robot_parts import Servo, chassis_inertial
from trundle.sim.mujoco.robot_stage import robot_stage
from trundle.usd import GROUND_OFFSET
from trundle.worlds import World

START = Pose2D(1.5, -2.25, 2.0)


def found_by_validators(stage):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    return [error.GetMessage() for error in UsdValidation.ValidationContext(validators).Validate(stage)]


def numbers(stage):
    """Every value of every attribute of a stage, by path."""
    return {
        str(attribute.GetPath()): attribute.Get()
        for prim in stage.Traverse()
        for attribute in prim.GetAttributes()
        if attribute.IsAuthored()
    }


@pytest.fixture(scope="module")
def scene():
    world = World(
        "hall",
        (Solid("Lights", Box((1.0, 2.0, 3.0)), Pose3D((4.0, 0.0, 1.5))), Solid("ball", Sphere(1.0 / 3.0))),
        seeds=((1.5, -2.25),),
    )
    return Scene("trip", world, Robot.load("nova_carter"), START)


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc"])
def test_every_number_of_a_scene_comes_back(scene, suffix, tmp_path):
    stage = scene_stage(scene)
    path = export_scene(scene, tmp_path / f"scene{suffix}")
    written, read = numbers(stage), numbers(Usd.Stage.Open(str(path)))
    assert written.keys() == read.keys()
    assert len(written) > 300
    assert [name for name, value in written.items() if value != read[name]] == []


@pytest.mark.parametrize("profile", [None, "isaac"])
@pytest.mark.parametrize("name", robot_names())
def test_no_validator_has_anything_against_a_scene(name, profile, tmp_path):
    scene = Scene("s", World.generate("maze", rows=3), Robot.load(name), START)
    stage = Usd.Stage.Open(str(export_scene(scene, tmp_path / "scene.usda", profile=profile)))
    assert found_by_validators(stage) == []
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdGeom.GetStageUpAxis(stage) == "Z"


def test_the_robot_stands_at_the_start_and_all_its_joints_hold_its_own_bodies(scene, tmp_path):
    stage = Usd.Stage.Open(str(export_scene(scene, tmp_path / "scene.usda", profile="isaac")))
    base = UsdGeom.Xformable(stage.GetPrimAtPath("/World/nova_carter/base_link"))
    place = UsdGeom.XformCache().GetLocalToWorldTransform(base.GetPrim())
    np.testing.assert_allclose(place.ExtractTranslation(), (START.x, START.y, GROUND_OFFSET))
    turn = place.ExtractRotation()
    assert math.radians(turn.GetAngle()) * turn.GetAxis()[2] == pytest.approx(START.yaw)
    roots = [str(prim.GetPath()) for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    assert roots == ["/World/nova_carter/base_link"]
    joints = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    assert len(joints) == 7
    for joint in joints:
        for end in (UsdPhysics.Joint(joint).GetBody0Rel(), UsdPhysics.Joint(joint).GetBody1Rel()):
            (body,) = end.GetTargets()
            assert stage.GetPrimAtPath(body).HasAPI(UsdPhysics.RigidBodyAPI)
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            assert UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0], prim.GetPath()


def test_a_scene_loads_back_to_its_world(scene, tmp_path):
    path = export_scene(scene, tmp_path / "hall.usd", profile="isaac")
    back = World.load(path, exclude="/World/nova_carter")
    assert [solid.name for solid in back.solids] == ["Lights", "ball"]
    assert back.seeds == scene.world.seeds


def test_a_robot_called_as_a_part_of_the_world_is_gets_a_name_of_its_own(tmp_path):
    robot = Robot.load("jackal").model_copy(update={"name": "Solids"})
    scene = Scene("s", World("w", (Solid("a", Box((1.0, 1.0, 1.0))),)), robot, START)
    stage = Usd.Stage.Open(str(export_scene(scene, tmp_path / "s.usda")))
    assert stage.GetPrimAtPath("/World/Solids_2/base_link").HasAPI(UsdPhysics.ArticulationRootAPI)
    assert stage.GetPrimAtPath("/World/Solids/a")


@pytest.mark.parametrize("name", robot_names())
def test_the_profile_says_to_physx_what_it_would_guess(name, tmp_path):
    robot = Robot.load(name)
    stage = Usd.Stage.Open(str(export_robot(robot, tmp_path / "robot.usd", profile="isaac")))
    assert found_by_validators(stage) == []
    base = stage.GetPrimAtPath(f"/{name}/base_link")
    assert "PhysxArticulationAPI" in base.GetPrimTypeInfo().GetAppliedAPISchemas()
    assert base.GetAttribute("physxArticulation:solverPositionIterationCount").Get() == 64
    assert base.GetAttribute("physxArticulation:solverVelocityIterationCount").Get() == 1
    assert base.GetAttribute("physxArticulation:enabledSelfCollisions").Get() is False
    materials = [prim for prim in stage.Traverse() if prim.IsA(UsdShade.Material)]
    for prim in materials:
        friction = UsdPhysics.MaterialAPI(prim).GetDynamicFrictionAttr().Get()
        mode = prim.GetAttribute("physxMaterial:frictionCombineMode").Get()
        assert mode == ("min" if friction < 1.0 else "average")
        assert "PhysxMaterialAPI" in prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    assert len(materials) >= 2
    offset = UsdGeom.Xformable(stage.GetDefaultPrim()).GetLocalTransformation().ExtractTranslation()
    assert tuple(offset) == (0.0, 0.0, GROUND_OFFSET)


@pytest.mark.parametrize("name", robot_names())
def test_every_body_leaves_solids_slowly_and_reports_its_contacts(name, tmp_path):
    stage = Usd.Stage.Open(str(export_robot(Robot.load(name), tmp_path / "robot.usd", profile="isaac")))
    bodies = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert len(bodies) >= 3
    for prim in bodies:
        schemas = prim.GetPrimTypeInfo().GetAppliedAPISchemas()
        assert {"PhysxRigidBodyAPI", "PhysxContactReportAPI"} <= set(schemas), prim.GetPath()
        assert prim.GetAttribute("physxRigidBody:maxDepenetrationVelocity").Get() == pytest.approx(0.1)
        assert prim.GetAttribute("physxContactReport:threshold").Get() == 0.0


def test_the_spring_of_the_casters_frame_has_no_limits_that_physx_cannot_keep(tmp_path):
    stage = Usd.Stage.Open(str(export_robot(Robot.load("nova_carter"), tmp_path / "robot.usd", profile="isaac")))
    joint = UsdPhysics.RevoluteJoint(stage.GetPrimAtPath("/nova_carter/joints/joint_caster_base"))
    assert (joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()) == (-math.inf, math.inf)
    assert joint.GetPrim().GetAttribute("physxJointAxis:angular:staticFrictionEffort").Get() == 10.0
    assert UsdPhysics.DriveAPI.Get(joint.GetPrim(), "angular").GetStiffnessAttr().Get() == pytest.approx(100.0)


@pytest.mark.parametrize("name", robot_names())
def test_every_number_of_the_robot_is_in_its_usd(name, tmp_path):
    robot = Robot.load(name)
    stage = Usd.Stage.Open(str(export_robot(robot, tmp_path / "robot.usd", profile="isaac")))
    drive, servo = robot.drive, Servo.of(robot)
    for side, sign, joint in (("left", 1.0, drive.left_joint), ("right", -1.0, drive.right_joint)):
        wheel = stage.GetPrimAtPath(f"/{name}/wheel_{side}")
        center = UsdGeom.Xformable(wheel).GetLocalTransformation().ExtractTranslation()
        assert tuple(center) == pytest.approx((0.0, sign * drive.track_width / 2.0, drive.wheel_radius), abs=1e-12)
        assert UsdPhysics.MassAPI(wheel).GetMassAttr().Get() == pytest.approx(drive.wheel_mass)
        tyre = UsdGeom.Cylinder(stage.GetPrimAtPath(f"/{name}/wheel_{side}/wheel_{side}_collider"))
        assert tyre.GetRadiusAttr().Get() == pytest.approx(drive.wheel_radius)
        assert tyre.GetHeightAttr().Get() == pytest.approx(0.004)
        prim = stage.GetPrimAtPath(f"/{name}/joints/{joint}")
        damping = UsdPhysics.DriveAPI.Get(prim, "angular").GetDampingAttr().Get()
        assert damping * 180.0 / math.pi == pytest.approx(servo.gain)
        assert UsdPhysics.DriveAPI.Get(prim, "angular").GetMaxForceAttr().Get() == pytest.approx(servo.torque)
        for armature in ("physxJoint:armature", "physxJointAxis:angular:armature"):
            assert prim.GetAttribute(armature).Get() == pytest.approx(servo.armature)
        assert "PhysxJointAxisAPI:angular" in prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    base = UsdPhysics.MassAPI(stage.GetPrimAtPath(f"/{name}/base_link"))
    center, moments = chassis_inertial(robot)
    assert base.GetMassAttr().Get() == pytest.approx(robot.body.mass)
    assert tuple(base.GetCenterOfMassAttr().Get()) == pytest.approx(tuple(center), rel=1e-6, abs=1e-7)
    assert sorted(base.GetDiagonalInertiaAttr().Get()) == pytest.approx(sorted(moments), rel=1e-6)
    for index, caster in enumerate(robot.casters):
        body = stage.GetPrimAtPath(f"/{name}/caster_{index}")
        place = UsdGeom.Xformable(body).GetLocalTransformation().ExtractTranslation()
        behind = caster.trail if caster.is_swivel else 0.0
        assert tuple(place) == pytest.approx((caster.x - behind, caster.y, caster.radius), abs=1e-12)
    for key, lidar in robot.lidars.items():
        frame = stage.GetPrimAtPath(f"/{name}/base_link/{key if 'lidar' in key else f'lidar_{key}'}")
        place = UsdGeom.Xformable(frame).GetLocalTransformation()
        assert tuple(place.ExtractTranslation()) == pytest.approx((lidar.x, lidar.y, lidar.z), abs=1e-12)


def test_a_world_for_isaac_sim_has_light_and_settings_of_its_physics(scene, tmp_path):
    stage = Usd.Stage.Open(str(export_world(scene.world, tmp_path / "w.usda", profile="isaac")))
    assert found_by_validators(stage) == []
    assert sum(prim.HasAPI(UsdLux.LightAPI) for prim in stage.Traverse()) == 2
    physics = stage.GetPrimAtPath("/World/PhysicsScene")
    assert physics.GetAttribute("physxScene:timeStepsPerSecond").Get() == 200
    assert physics.GetAttribute("physxScene:solverType").Get() == "TGS"
    assert physics.GetAttribute("physxScene:enableGPUDynamics").Get() is False
    assert {solid.name for solid in World.load(tmp_path / "w.usda").solids} == {"Lights", "ball"}


def test_without_a_profile_there_is_none_of_it(scene, tmp_path):
    stage = scene_stage(scene)
    words = {name for prim in stage.Traverse() for name in prim.GetPropertyNames()}
    assert not [
        name for name in words if name.startswith(("physxScene", "physxArticulation", "physxRigidBody", "physxContact"))
    ]
    assert not [prim for prim in stage.Traverse() if prim.HasAPI(UsdLux.LightAPI)]
    assert not robot_stage(scene.robot).GetDefaultPrim().HasAttribute("xformOp:translate")


@pytest.mark.parametrize("write", [export_world, export_robot, export_scene])
def test_an_unknown_profile_is_refused(write, scene, tmp_path):
    thing = {export_world: scene.world, export_robot: scene.robot, export_scene: scene}[write]
    with pytest.raises(UnknownNameError, match="Did you mean 'isaac'"):
        write(thing, tmp_path / "a.usd", profile="isac")
    assert list(tmp_path.iterdir()) == []


def test_a_scene_as_mjcf_starts_where_the_simulator_does(scene, tmp_path):
    model = mujoco.MjModel.from_xml_path(str(export_scene(scene, tmp_path / "scene.xml")))
    data = mujoco.MjData(model)
    for _ in range(400):
        mujoco.mj_step(model, data)
    with simulate(scene.world, scene.robot) as sim:
        rest = sim.reset(START)
        np.testing.assert_allclose(data.qpos[:3], sim.data.qpos[:3], atol=2e-3)
    assert Pose3D(quaternion=tuple(data.qpos[3:7])).yaw() == pytest.approx(rest.pose.yaw, abs=2e-3)
