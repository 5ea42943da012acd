import math
import sys

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdValidation

from trundle.errors import MissingExtraError, OutputError
from trundle.export.usd import export_robot, export_world
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import OccupancyGrid
from trundle.robots import Caster, Robot, robot_names
from trundle.sim.mujoco.joints import list_joints
from trundle.sim.mujoco.model import robot_spec
from trundle.sim.mujoco.robot_parts import Servo, chassis_inertial
from trundle.sim.mujoco.robot_stage import robot_stage
from trundle.worlds import World
from trundle.worlds.tessellate import cone_mesh
from trundle.worlds.usd import load_usd

TILTED = Pose3D((1.5, -2.25, 0.75), (0.3, -0.5, 0.7, 0.2))
FAR = Mesh(cone_mesh(0.5, 1.0).vertices + np.array([40.0, -70.0, 0.6]), cone_mesh(0.5, 1.0).faces)


def found_by_validators(stage):
    """What any validator of usd-core has against a stage."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    plugins = {validator.GetMetadata().name.partition(":")[0] for validator in validators}
    assert {f"usd{part}Validators" for part in ("Geom", "Physics", "Shade", "Utils")} <= plugins
    return [
        f"{error.GetName()}: {error.GetMessage()}"
        for error in UsdValidation.ValidationContext(validators).Validate(stage)
    ]


@pytest.fixture(scope="module")
def world():
    return World(
        "yard",
        (
            Solid("crate", Box((1.0, 2.0 / 3.0, 3.0)), TILTED, (0.25, 0.5, 0.75, 1.0), "crate"),
            Solid("post 1/a", Cylinder(0.1, 2.0), TILTED),
            Solid("post 1.a", Sphere(1.0 / 3.0), Pose3D((0.0, 5.0, 0.3)), (1.0, 0.0, 0.0, 0.5)),
            Solid("7 cônes", cone_mesh(0.4, 1.0), TILTED, kind="cone"),
            Solid("far", FAR, Pose3D((0.1, 0.2, 0.0))),
        ),
        seeds=((0.1, -3.0), (2.0, 4.0)),
    )


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc"])
def test_a_world_comes_back_as_it_was(tmp_path, world, suffix):
    export_world(world, tmp_path / f"yard{suffix}")
    back = World.load(tmp_path / f"yard{suffix}")
    assert back.name == "yard"
    assert back.seeds == world.seeds
    for before, after in zip(world.solids, back.solids, strict=True):
        assert (after.name, after.kind, type(after.shape)) == (before.name, before.kind, type(before.shape))
        assert after.color == pytest.approx(before.color, abs=1e-6)
        if isinstance(before.shape, Mesh):
            placed = [solid.pose.transform_points(solid.shape.vertices) for solid in (before, after)]
            np.testing.assert_allclose(*placed, atol=1e-6)
            np.testing.assert_array_equal(after.shape.faces, before.shape.faces)
            continue
        assert after.pose.position == pytest.approx(before.pose.position, abs=1e-9)
        np.testing.assert_allclose(after.pose.rotation(), before.pose.rotation(), atol=1e-9)
        if isinstance(before.shape, Box):
            assert after.shape.size == pytest.approx(before.shape.size, abs=1e-9)
        else:
            assert after.shape.radius == pytest.approx(before.shape.radius, abs=1e-9)
    assert back.solids[1].shape.length == pytest.approx(2.0, abs=1e-9)


@pytest.mark.slow
def test_a_second_round_changes_nothing(tmp_path, world):
    export_world(world, tmp_path / "once.usda")
    export_world(World.load(tmp_path / "once.usda"), tmp_path / "twice.usda")
    once, twice = World.load(tmp_path / "once.usda"), World.load(tmp_path / "twice.usda")
    for before, after in zip(once.solids, twice.solids, strict=True):
        np.testing.assert_allclose(after.bounds(), before.bounds(), atol=1e-9)


def test_blocked_cells_come_back_as_walls_of_the_same_map(tmp_path):
    blocked = np.random.default_rng(2).random((30, 40)) < 0.3
    cells = Solid("map", OccupancyCells(blocked, 0.05, 1.2), Pose3D.planar(-1.0, 0.5, 0.0, 0.31))
    export_world(World("cells", (cells,)), tmp_path / "cells.usd")
    back = World.load(tmp_path / "cells.usd")
    (solid,) = back.solids
    assert solid.name == "map"
    np.testing.assert_allclose(solid.bounds()[1][2], 1.2, atol=1e-6)
    a, b, c = np.moveaxis(solid.shape.vertices[solid.shape.faces], 1, 0)
    assert (np.cross(a, b) * c).sum() / 6.0 == pytest.approx(blocked.sum() * 0.05**2 * 1.2, rel=1e-5)
    bounds = ((-2.0, 0.0), (2.0, 3.0))
    first, second = (
        OccupancyGrid.from_world(each, resolution=0.05, bounds=bounds, coverage="centre", seeds=[(-1.9, 0.1)])
        for each in (World("cells", (cells,)), back)
    )
    np.testing.assert_array_equal(first.data, second.data)


def test_cells_of_which_none_is_blocked_are_refused(tmp_path):
    empty = Solid("map", OccupancyCells(np.zeros((3, 3), dtype=bool), 0.05, 1.0))
    with pytest.raises(OutputError, match="none of the cells"):
        export_world(World("cells", (empty,)), tmp_path / "cells.usd")


def test_a_written_world_is_in_metres_with_z_up_on_a_ground_plane(tmp_path, world):
    export_world(world, tmp_path / "yard.usda")
    stage = Usd.Stage.Open(str(tmp_path / "yard.usda"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert stage.GetDefaultPrim().GetPath() == "/World"
    shapes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Gprim)]
    assert len(shapes) == len(world.solids) + 1
    assert all(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in shapes)
    ground = UsdGeom.Plane(stage.GetPrimAtPath("/World/GroundPlane"))
    assert ground.GetAxisAttr().Get() == "Z"
    low, high = world.bounds
    assert ground.GetWidthAttr().Get() >= high[0] - low[0]
    material = UsdShade.MaterialBindingAPI(shapes[1]).ComputeBoundMaterial("physics")[0]
    assert UsdPhysics.MaterialAPI(material).GetDynamicFrictionAttr().Get() == 1.0


def test_no_validator_of_usd_has_anything_against_a_written_world(tmp_path, world):
    export_world(world, tmp_path / "yard.usda")
    assert found_by_validators(Usd.Stage.Open(str(tmp_path / "yard.usda"))) == []


def test_the_validators_find_what_is_wrong(tmp_path):
    stage = robot_stage(Robot.load("nova_carter"))
    wheel = UsdPhysics.RevoluteJoint.Get(stage, "/nova_carter/joints/joint_wheel_left")
    wheel.GetBody1Rel().SetTargets([Sdf.Path("/nowhere")])
    stage.ClearDefaultPrim()
    said = " ".join(found_by_validators(stage))
    assert "JointInvalidPrimRel" in said
    assert "MissingDefaultPrim" in said


def test_an_empty_world_is_a_floor(tmp_path):
    export_world(World("empty", ()), tmp_path / "empty.usda")
    assert load_usd(tmp_path / "empty.usda").solids == ()


def test_what_was_there_stays_when_a_file_cannot_be_written(tmp_path, world):
    with pytest.raises(OutputError, match=r"\.usda"):
        export_world(world, tmp_path / "yard.glb")
    with pytest.raises(OutputError, match="cannot write"):
        export_world(world, tmp_path / "nowhere" / "yard.usda")
    assert list(tmp_path.iterdir()) == []


def test_without_usd_core_the_install_line_is_given(tmp_path, world, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)
    with pytest.raises(MissingExtraError, match=r"\[usd\]"):
        export_world(world, tmp_path / "yard.usda")


ROBOTS = robot_names()

URDF = """<robot name="my cart">
  <link name="base"><inertial><origin xyz="0.02 0 0.15"/><mass value="12"/>
    <inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.6 0.36 0.2"/></geometry></collision></link>
  <link name="l"><inertial><mass value="0.8"/><inertia ixx="0.003" iyy="0.004" izz="0.003" ixy="0" ixz="0" iyz="0"/>
    </inertial><collision><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.1" length="0.04"/>
    </geometry></collision></link>
  <link name="r"><inertial><mass value="0.8"/><inertia ixx="0.003" iyy="0.004" izz="0.003" ixy="0" ixz="0" iyz="0"/>
    </inertial><collision><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.1" length="0.04"/>
    </geometry></collision></link>
  <link name="ball"><inertial><mass value="0.2"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0"
    iyz="0"/></inertial><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="left wheel/joint" type="continuous"><parent link="base"/><child link="l"/><origin xyz="0 0.2 0.1"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="right wheel/joint" type="continuous"><parent link="base"/><child link="r"/><origin xyz="0 -0.2 0.1"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="mount" type="fixed"><parent link="base"/><child link="ball"/><origin xyz="0.2 0 0.05"/></joint>
</robot>"""


@pytest.mark.filterwarnings("ignore::trundle.errors.RobotWarning")
def test_a_users_urdf_becomes_an_articulation_with_its_wheels_and_masses(tmp_path):
    (tmp_path / "cart.urdf").write_text(URDF)
    robot = Robot.load(tmp_path / "cart.urdf")
    export_robot(robot, tmp_path / "cart.usda")
    stage = Usd.Stage.Open(str(tmp_path / "cart.usda"))
    assert found_by_validators(stage) == []
    driven = [str(prim.GetPath()) for prim in stage.Traverse() if UsdPhysics.DriveAPI.GetAll(prim)]
    assert driven == ["/my_cart/joints/left_wheel_joint", "/my_cart/joints/right_wheel_joint"]
    masses = [
        UsdPhysics.MassAPI(prim).GetMassAttr().Get() for prim in stage.Traverse() if prim.HasAPI("PhysicsMassAPI")
    ]
    assert sum(masses) == pytest.approx(12.0 + 2 * 0.8 + 0.2)
    wheel = UsdPhysics.MassAPI(stage.GetPrimAtPath("/my_cart/wheel_left"))
    assert wheel.GetDiagonalInertiaAttr().Get()[1] == pytest.approx(0.8 * 0.1**2 / 2.0)
    assert UsdGeom.Xformable(wheel).GetLocalTransformation().ExtractTranslation() == pytest.approx((0.0, 0.2, 0.1))


@pytest.mark.parametrize("name", ROBOTS)
def test_no_validator_of_usd_has_anything_against_a_written_robot(tmp_path, name):
    export_robot(Robot.load(name), tmp_path / "robot.usda")
    assert found_by_validators(Usd.Stage.Open(str(tmp_path / "robot.usda"))) == []


@pytest.mark.parametrize("name", ROBOTS)
def test_masses_and_inertias_are_the_robots(name):
    robot = Robot.load(name)
    model = robot_spec(robot).compile()
    stage = robot_stage(robot)
    bodies = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert len(bodies) == model.nbody - 1
    assert sum(UsdPhysics.MassAPI(prim).GetMassAttr().Get() for prim in bodies) == pytest.approx(robot.total_mass)
    base = UsdPhysics.MassAPI(stage.GetPrimAtPath(f"/{name}/base_link"))
    center, inertia = chassis_inertial(robot)
    assert base.GetMassAttr().Get() == pytest.approx(robot.body.mass)
    assert tuple(base.GetCenterOfMassAttr().Get()) == pytest.approx(tuple(center), abs=1e-6)
    for prim in bodies:
        api, body = UsdPhysics.MassAPI(prim), model.body(prim.GetName())
        principal = Pose3D(quaternion=_wxyz(api.GetPrincipalAxesAttr().Get())).rotation()
        tensor = principal @ np.diag(api.GetDiagonalInertiaAttr().Get()) @ principal.T
        expected = Pose3D(quaternion=tuple(body.iquat)).rotation()
        np.testing.assert_allclose(tensor, expected @ np.diag(body.inertia) @ expected.T, rtol=1e-5, atol=1e-9)
        if prim.GetName() == "base_link":
            np.testing.assert_allclose(tensor, np.diag(inertia), rtol=1e-6, atol=1e-6)


def _wxyz(quaternion):
    return (quaternion.GetReal(), *quaternion.GetImaginary())


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_joints_have_the_robots_names_and_places(tmp_path, name):
    robot = Robot.load(name)
    export_robot(robot, tmp_path / "robot.usd")
    written = {joint.name.rpartition("/")[2]: joint for joint in list_joints(tmp_path / "robot.usd")}
    for joint in list_joints(robot):
        other = written[joint.name]
        sprung = robot.caster_frame is not None and joint.name == robot.caster_frame.joint
        assert (other.type, other.axis, other.limits, other.drives) == (
            joint.type,
            pytest.approx(joint.axis),
            None if joint.limits is None else pytest.approx(joint.limits),
            joint.drives or sprung,  # a spring is a drive in USD
        )
        assert (other.parent, other.child) == (f"/{name}/{joint.parent}", f"/{name}/{joint.child}")
    fixed = {joint.child for joint in written.values() if joint.type == "fixed"}
    assert len(fixed) == sum(not caster.is_swivel for caster in robot.casters)

    stage = Usd.Stage.Open(str(tmp_path / "robot.usd"))
    places = UsdGeom.XformCache()
    for joint in written.values():
        prim = UsdPhysics.Joint.Get(stage, joint.name)
        ends = [
            places.GetLocalToWorldTransform(stage.GetPrimAtPath(body)).Transform(local)
            for body, local in (
                (joint.parent, prim.GetLocalPos0Attr().Get()),
                (joint.child, prim.GetLocalPos1Attr().Get()),
            )
        ]
        np.testing.assert_allclose(*[np.array(end) for end in ends], atol=1e-6)
        side = 1.0 if joint.name.endswith(robot.drive.left_joint) else -1.0
        if joint.drives and joint.type == "continuous":
            half = robot.drive.track_width / 2.0
            np.testing.assert_allclose(ends[0], (0.0, side * half, robot.drive.wheel_radius), atol=1e-6)


def test_the_root_is_the_chassis_and_the_wheels_have_velocity_drives():
    robot = Robot.load("nova_carter")
    stage = robot_stage(robot)
    roots = [str(prim.GetPath()) for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    assert roots == ["/nova_carter/base_link"]
    assert stage.GetDefaultPrim().GetPath() == "/nova_carter"
    servo = Servo.of(robot)
    driven = [prim for prim in stage.Traverse() if UsdPhysics.DriveAPI.GetAll(prim)]
    assert [prim.GetName() for prim in driven] == ["joint_wheel_left", "joint_wheel_right", "joint_caster_base"]
    for prim in driven[:2]:
        drive = UsdPhysics.DriveAPI.Get(prim, "angular")
        assert drive.GetStiffnessAttr().Get() == 0.0
        assert drive.GetDampingAttr().Get() == pytest.approx(servo.gain * math.pi / 180.0)
        assert drive.GetMaxForceAttr().Get() == pytest.approx(servo.torque)
        assert UsdPhysics.RevoluteJoint(prim).GetAxisAttr().Get() == "Y"


def test_the_frame_of_the_casters_rocks_on_a_spring_as_in_isaac_sims_nova_carter():
    stage = robot_stage(Robot.load("nova_carter"))
    prim = stage.GetPrimAtPath("/nova_carter/joints/joint_caster_base")
    joint, spring = UsdPhysics.RevoluteJoint(prim), UsdPhysics.DriveAPI.Get(prim, "angular")
    assert joint.GetAxisAttr().Get() == "X"
    assert (joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()) == pytest.approx((-2.0, 2.0))
    assert spring.GetStiffnessAttr().Get() == pytest.approx(100.0)
    assert spring.GetDampingAttr().Get() == pytest.approx(10.0)
    assert [str(body) for body in joint.GetBody1Rel().GetTargets()] == ["/nova_carter/caster_frame"]
    swing = UsdPhysics.RevoluteJoint(stage.GetPrimAtPath("/nova_carter/joints/joint_swing_left"))
    assert [str(body) for body in swing.GetBody0Rel().GetTargets()] == ["/nova_carter/caster_frame"]


def test_casters_slide_and_wheels_hold():
    stage = robot_stage(Robot.load("turtlebot3_burger"))

    def material(path):
        return UsdShade.MaterialBindingAPI(stage.GetPrimAtPath(path)).ComputeBoundMaterial("physics")[0].GetPrim()

    caster = material("/turtlebot3_burger/caster_0/caster_0_collider")
    assert UsdPhysics.MaterialAPI(caster).GetDynamicFrictionAttr().Get() == 0.0
    assert caster.GetAttribute("physxMaterial:frictionCombineMode").Get() == "min"
    wheel = material("/turtlebot3_burger/wheel_left/wheel_left_collider")
    assert UsdPhysics.MaterialAPI(wheel).GetDynamicFrictionAttr().Get() == 1.0
    assert not wheel.GetAttribute("physxMaterial:frictionCombineMode")


def test_a_robot_stands_on_the_floor_within_its_footprint(tmp_path):
    for name in ROBOTS:
        robot = Robot.load(name)
        export_robot(robot, tmp_path / f"{name}.usda")
        with pytest.warns(UserWarning, match="articulation"):
            body = load_usd(tmp_path / f"{name}.usda", geometry="collision")
        low, _ = body.bounds
        assert low[2] == pytest.approx(0.0, abs=1e-6)
        chassis = next(solid for solid in body.solids if "chassis" in solid.name)
        np.testing.assert_allclose(chassis.bounds()[0][:2], robot.outline.min(axis=0), atol=1e-5)
        np.testing.assert_allclose(chassis.bounds()[1][:2], robot.outline.max(axis=0), atol=1e-5)


def test_names_that_usd_does_not_take_are_made_valid_and_stay_apart(tmp_path):
    plain = Robot.load("nova_carter")
    swivel = {"radius": 0.05, "trail": 0.02, "x": -0.4}
    casters = (
        Caster(y=0.1, swivel_joint="swing 1", wheel_joint="roll/1", **swivel),
        Caster(y=-0.1, swivel_joint="swing/1", wheel_joint="roll 1", **swivel),
    )
    robot = plain.model_copy(update={"name": "my robot", "casters": casters})
    export_robot(robot, tmp_path / "robot.usda")
    names = {joint.name for joint in list_joints(tmp_path / "robot.usda")}
    assert {"/my_robot/joints/swing_1", "/my_robot/joints/swing_1_2", "/my_robot/joints/roll_1"} <= names
    assert found_by_validators(Usd.Stage.Open(str(tmp_path / "robot.usda"))) == []


def test_a_joint_about_any_axis_turns_about_it():
    from trundle.sim.mujoco.robot_stage import _axis, _frame

    for axis in ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8), (-0.36, 0.48, 0.8)):
        frame = _frame(np.array(axis))
        assert np.linalg.det(frame) == pytest.approx(1.0)
        column = "XYZ".index(_axis(np.array(axis)) or "X")
        np.testing.assert_allclose(frame[:, column], axis, atol=1e-12)
