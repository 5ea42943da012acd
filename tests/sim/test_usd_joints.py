import math

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from trundle.errors import RobotError, WorldWarning
from trundle.sim.mujoco.joints import Joint, list_joints


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    for name in ("base", "wheel", "mast"):
        UsdGeom.Xform.Define(stage, f"/bot/{name}")

    def join(schema, name):
        joint = schema.Define(stage, f"/bot/joints/{name}")
        joint.CreateBody0Rel().SetTargets([Sdf.Path("/bot/base")])
        joint.CreateBody1Rel().SetTargets([Sdf.Path("/bot/wheel")])
        return joint

    wheel = join(UsdPhysics.RevoluteJoint, "wheel")
    wheel.CreateAxisAttr("Z")
    wheel.CreateLocalRot1Attr(Gf.Quatf(math.sqrt(0.5), math.sqrt(0.5), 0, 0))
    UsdPhysics.DriveAPI.Apply(wheel.GetPrim(), "angular")
    arm = join(UsdPhysics.RevoluteJoint, "arm")
    arm.CreateAxisAttr("X")
    arm.CreateLowerLimitAttr(-90)
    arm.CreateUpperLimitAttr(45)
    lift = join(UsdPhysics.PrismaticJoint, "lift")
    lift.CreateAxisAttr("Z")
    lift.CreateLowerLimitAttr(0)
    lift.CreateUpperLimitAttr(50)
    join(UsdPhysics.SphericalJoint, "eye")
    fixed = UsdPhysics.FixedJoint.Define(stage, "/bot/joints/mount")
    fixed.CreateBody1Rel().SetTargets([Sdf.Path("/bot/mast")])
    join(UsdPhysics.DistanceJoint, "rope")

    def generic(name, free, low=-30.0, high=30.0):
        prim = join(UsdPhysics.Joint, name).GetPrim()
        for freedom in ("transX", "transY", "transZ", "rotX", "rotY", "rotZ"):
            limit = UsdPhysics.LimitAPI.Apply(prim, freedom)
            limit.CreateLowAttr(low if freedom in free else 1.0)
            limit.CreateHighAttr(high if freedom in free else -1.0)

    generic("generic_turn", ["rotY"])
    generic("generic_slide", ["transX"])
    generic("generic_none", [])
    generic("generic_ball", ["rotX", "rotY", "rotZ"])
    generic("generic_planar", ["transX", "transY", "rotZ"])
    generic("generic_odd", ["transX", "rotZ"])
    join(UsdPhysics.Joint, "generic_free")
    stage.Save()
    return path


def test_usd_joints_have_type_axis_limits_bodies_and_drives(robot):
    joints = {joint.name.removeprefix("/bot/joints/"): joint for joint in list_joints(robot)}
    assert joints["wheel"] == Joint(
        "/bot/joints/wheel", "continuous", (0.0, -1.0, 0.0), None, "/bot/base", "/bot/wheel", drives=True
    )
    assert joints["arm"].type == "revolute"
    assert joints["arm"].limits == pytest.approx((-math.pi / 2.0, math.pi / 4.0))
    assert not joints["arm"].drives
    assert joints["lift"].limits == pytest.approx((0.0, 0.5))
    assert (joints["mount"].parent, joints["mount"].child) == ("world", "/bot/mast")
    assert {name: joint.type for name, joint in joints.items()} == {
        "wheel": "continuous",
        "arm": "revolute",
        "lift": "prismatic",
        "eye": "ball",
        "mount": "fixed",
        "rope": "floating",
        "generic_turn": "revolute",
        "generic_slide": "prismatic",
        "generic_none": "fixed",
        "generic_ball": "ball",
        "generic_planar": "planar",
        "generic_odd": "floating",
        "generic_free": "floating",
    }
    assert joints["generic_turn"].axis == (0.0, 1.0, 0.0)
    assert joints["generic_turn"].limits == pytest.approx((-math.pi / 6.0, math.pi / 6.0))
    assert joints["generic_slide"].limits == pytest.approx((-0.3, 0.3))


def test_a_usd_file_that_cannot_be_read_is_a_robots_error(tmp_path):
    (tmp_path / "bad.usda").write_text("#usda 1.0\ndef what")
    with pytest.raises(RobotError, match=r"bad\.usda:2"):
        list_joints(tmp_path / "bad.usda")
    with pytest.raises(RobotError, match="no such file"):
        list_joints(tmp_path / "none.usd")


def test_references_that_hide_joints_are_reported(tmp_path):
    (tmp_path / "part.usda").write_text('#usda 1.0\ndef "arm" (references = @arm.usd@) {}\n')
    with pytest.warns(WorldWarning, match=r"/arm.*arm\.usd"):
        assert list_joints(tmp_path / "part.usda") == []
