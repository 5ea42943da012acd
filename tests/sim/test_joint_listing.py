import math

import pytest

from trundle.errors import RobotError, UnknownNameError
from trundle.robots import Robot
from trundle.sim.mujoco.joints import list_joints

MJCF = """
<mujoco>
  <compiler angle="degree" meshdir="nowhere"/>
  <default><default class="arm"><joint axis="0 0 2" range="-90 45" limited="true"/></default></default>
  <asset>
    <mesh name="shell" file="missing.stl"/>
    <texture name="skin" type="2d" file="missing.png"/>
    <material name="skin" texture="skin"/>
  </asset>
  <worldbody>
    <body name="base">
      <freejoint name="root"/>
      <geom type="mesh" mesh="shell" material="skin"/>
      <body name="link"><joint name="turn" class="arm"/><geom type="mesh" mesh="shell"/>
        <body name="tip"><joint name="slide" type="slide" axis="1 0 0"/>
          <body name="eye"><joint name="look" type="ball"/></body>
        </body>
      </body>
      <body name="left"><joint name="wheel_left" axis="0 1 0"/><geom size="0.1"/></body>
      <body name="right"><joint name="wheel_right" axis="0 1 0"/><geom size="0.1"/></body>
    </body>
  </worldbody>
  <tendon><fixed name="both"><joint joint="wheel_left" coef="1"/><joint joint="wheel_right" coef="1"/></fixed></tendon>
  <actuator><motor joint="turn"/><motor tendon="both"/></actuator>
</mujoco>
"""

URDF = """<?xml version="1.0"?>
<robot name="cart">
  <link name="base"><visual><geometry><mesh filename="package://nowhere/base.dae"/></geometry></visual></link>
  <link name="wheel"/><link name="mast"/><link name="lift"/><link name="arm"/>
  <joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 2 0"/></joint>
  <joint name="bolt" type="fixed"><parent link="base"/><child link="mast"/></joint>
  <joint name="lifter" type="prismatic">
    <parent link="mast"/><child link="lift"/><axis xyz="0 0 1"/><limit lower="0" upper="1.5" effort="9" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="lift"/><child link="arm"/><limit lower="-1" upper="1" effort="9" velocity="1"/>
  </joint>
  <transmission name="t"><joint name="axle"/><actuator name="m"/></transmission>
  <ros2_control name="c" type="system">
    <joint name="lifter"><command_interface name="position"/></joint>
    <joint name="elbow"><state_interface name="position"/></joint>
  </ros2_control>
</robot>
"""


def urdf_joint(kind, inside):
    return f'<robot><joint name="a" type="{kind}"><parent link="p"/><child link="c"/>{inside}</joint></robot>'


def write(path, text):
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_nova_carter_has_two_driving_wheels_and_two_swivel_casters():
    joints = {joint.name: joint for joint in list_joints(Robot.load("nova_carter"))}
    assert list(joints) == [
        "joint_wheel_left",
        "joint_wheel_right",
        "joint_caster_base",
        "joint_swing_left",
        "joint_caster_left",
        "joint_swing_right",
        "joint_caster_right",
    ]
    assert [name for name, joint in joints.items() if joint.drives] == ["joint_wheel_left", "joint_wheel_right"]
    wheel = joints["joint_wheel_left"]
    assert (wheel.type, wheel.axis, wheel.limits) == ("continuous", (0.0, 1.0, 0.0), None)
    assert (wheel.parent, wheel.child) == ("base_link", "wheel_left")
    assert joints["joint_swing_left"].axis == (0.0, 0.0, 1.0)
    base = joints["joint_caster_base"]
    assert (base.type, base.axis, base.parent, base.child) == ("revolute", (1.0, 0.0, 0.0), "base_link", "caster_frame")
    assert base.limits == pytest.approx((-math.radians(2.0), math.radians(2.0)))


def test_mjcf_joints_have_urdf_types_unit_axes_and_limits_in_radians(tmp_path):
    joints = {joint.name: joint for joint in list_joints(write(tmp_path / "robot.xml", MJCF))}
    assert {name: joint.type for name, joint in joints.items()} == {
        "root": "floating",
        "turn": "revolute",
        "slide": "prismatic",
        "look": "ball",
        "wheel_left": "continuous",
        "wheel_right": "continuous",
    }
    assert joints["turn"].axis == (0.0, 0.0, 1.0)
    assert joints["turn"].limits == pytest.approx((-math.pi / 2.0, math.pi / 4.0))
    assert (joints["slide"].parent, joints["slide"].child) == ("link", "tip")
    assert joints["root"].parent == "world"
    assert joints["look"].axis is None
    assert {name for name, joint in joints.items() if joint.drives} == {"turn", "wheel_left", "wheel_right"}


def test_urdf_joints_keep_fixed_ones_and_names_without_any_mesh(tmp_path):
    joints = {joint.name: joint for joint in list_joints(str(write(tmp_path / "cart.urdf", URDF)))}
    assert {name: joint.type for name, joint in joints.items()} == {
        "axle": "continuous",
        "bolt": "fixed",
        "lifter": "prismatic",
        "elbow": "revolute",
    }
    assert joints["axle"].axis == (0.0, 1.0, 0.0)
    assert joints["elbow"].axis == (1.0, 0.0, 0.0)
    assert joints["bolt"].axis is None
    assert joints["lifter"].limits == (0.0, 1.5)
    assert joints["axle"].limits is None
    assert (joints["bolt"].parent, joints["bolt"].child) == ("base", "mast")
    assert {name for name, joint in joints.items() if joint.drives} == {"axle", "lifter"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not XML"),
        ("hello", "not XML"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "not XML"),
        ("<robot><joint>", "not XML"),
        ("<html/>", "<html>"),
        ('<!DOCTYPE robot [<!ENTITY a "b">]><robot/>', "DOCTYPE"),
        ('<?xml version="1.0"?><!DOCTYPE robot SYSTEM "file:///etc/passwd"><robot/>', "DOCTYPE"),
        ('<robot xmlns:xacro="x"><xacro:include filename="a"/></robot>', "xacro"),
        ('<robot><joint type="fixed"/></robot>', "no name"),
        ('<robot><joint name="a" type="hinge"/></robot>', "'hinge'"),
        ('<robot><joint name="a" type="fixed"/></robot>', "parent"),
        (urdf_joint("continuous", '<axis xyz="0 0 0"/>'), "axis"),
        (urdf_joint("continuous", '<axis xyz="0 1"/>'), "axis"),
        (urdf_joint("revolute", '<limit lower="x"/>'), "lower"),
        (urdf_joint("revolute", '<limit lower="nan"/>'), "finite"),
        (urdf_joint("prismatic", '<limit lower="2" upper="1"/>'), "above"),
        (
            '<robot><joint name="a" type="fixed"><parent link="p"/><child link="c"/></joint>'
            '<joint name="a" type="fixed"><parent link="p"/><child link="d"/></joint></robot>',
            "two joints",
        ),
        ('<mujoco><worldbody><body><joint type="screw"/></body></worldbody></mujoco>', "MuJoCo cannot read"),
        ('<mujoco><include file="missing.xml"/></mujoco>', "MuJoCo cannot read"),
    ],
)
def test_files_that_are_no_robot_are_refused_with_the_reason(tmp_path, text, message):
    path = write(tmp_path / "robot.xml", text)
    with pytest.raises(RobotError, match=message) as caught:
        list_joints(path)
    assert "robot.xml" in str(caught.value)


def test_a_missing_file_a_folder_and_an_unknown_name_are_refused(tmp_path):
    with pytest.raises(RobotError, match="cannot read"):
        list_joints(tmp_path / "missing.urdf")
    (tmp_path / "folder.xml").mkdir()
    with pytest.raises(RobotError, match="cannot read"):
        list_joints(tmp_path / "folder.xml")
    with pytest.raises(UnknownNameError, match="nova_carter"):
        list_joints("nova_carte")


def test_a_robot_is_found_by_name():
    assert list_joints("nova_carter") == list_joints(Robot.load("nova_carter"))
