"""Robots with several wheels a side, and wheels that are not driven so, from their URDFs."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest

from trundle.errors import InputError, RobotError, RobotWarning
from trundle.export import Scene, export_robot, export_scene
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.path import Path as Plan
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.mujoco.joints import list_joints
from trundle.sim.mujoco.model import robot_spec
from trundle.worlds import World

ROBOT = """<robot name="{name}">
  <link name="base_link">
    <inertial><origin xyz="0 0 0.1"/><mass value="{mass}"/>
      <inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 {up}"/><geometry><box size="{length} {width} {height}"/></geometry></collision></link>
  {wheels}
</robot>"""
WHEEL = """<link name="{name}_link">
    <inertial><mass value="{mass}"/><inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin rpy="1.57079632679 0 0"/><geometry><cylinder radius="{r}" length="{w}"/></geometry></collision>
    {rollers}</link>
  <joint name="{name}" type="continuous"><parent link="base_link"/><child link="{name}_link"/>
    <origin xyz="{x} {y} {z}"/><axis xyz="0 1 0"/></joint>"""

# Clearpath's published dimensions [m, kg].
HUSKY = {"wheelbase": 0.512, "track": 0.5708, "radius": 0.1651, "wheel_width": 0.1143, "z": 0.0345, "wheel_mass": 2.6}
JACKAL = {"wheelbase": 0.262, "track": 0.37559, "radius": 0.098, "wheel_width": 0.04, "z": 0.0345, "wheel_mass": 0.48}
HUSKY_BODY = {
    "mass": 46.0,
    "ixx": 0.6,
    "iyy": 1.7,
    "izz": 2.0,
    "up": 0.12,
    "length": 0.99,
    "width": 0.67,
    "height": 0.2,
}
JACKAL_BODY = {
    "mass": 16.5,
    "ixx": 0.31,
    "iyy": 0.39,
    "izz": 0.44,
    "up": 0.1,
    "length": 0.42,
    "width": 0.31,
    "height": 0.18,
}


def wheel(name, x, y, sizes, rollers=""):
    return WHEEL.format(
        name=name, x=x, y=y, z=sizes["z"], r=sizes["radius"], w=sizes["wheel_width"], mass=sizes["wheel_mass"], i=0.01,
        rollers=rollers,
    )  # fmt: skip


def write(folder: Path, name="husky", sizes=HUSKY, body=HUSKY_BODY, names="{end}_{side}_wheel", ends=("front", "rear")):
    half, across = sizes["wheelbase"] / 2.0, sizes["track"] / 2.0
    places = np.linspace(half, -half, len(ends))
    wheels = "".join(
        wheel(names.format(end=end, side=side), x, sign * across, sizes)
        for end, x in zip(ends, places, strict=True)
        for side, sign in (("left", 1), ("right", -1))
    )
    file = folder / f"{name}.urdf"
    file.write_text(ROBOT.format(name=name, wheels=wheels, **body))
    return file


def read(path, **options) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        return Robot.from_model(path, **options)


def test_wheels_of_a_side_count_as_one_and_the_pivot_lies_between_the_axles(tmp_path):
    robot = read(write(tmp_path))
    assert robot.circumscribed_radius == pytest.approx(0.60, abs=0.005)
    assert [axle.x for axle in robot.drive.axles] == pytest.approx([0.256, -0.256])
    assert robot.drive.track_width == pytest.approx(0.5708)
    assert robot.drive.wheel_radius == pytest.approx(0.1651, rel=1e-3)
    assert robot.casters == ()
    assert robot.total_mass == pytest.approx(46.0 + 4 * 2.6)
    jackal = read(write(tmp_path, "jackal", JACKAL, JACKAL_BODY, "{end}_{side}_wheel_joint"))
    assert [axle.left_joint for axle in jackal.drive.axles] == ["front_left_wheel_joint", "rear_left_wheel_joint"]
    assert jackal.outline.min(axis=0) == pytest.approx(-jackal.outline.max(axis=0), abs=1e-6)


def test_naming_one_wheel_a_side_takes_those_behind_it(tmp_path):
    file = write(tmp_path)
    robot = read(file, left_joint="rear_left_wheel", right_joint="rear_right_wheel")
    assert robot.drive.axles == read(file).drive.axles
    assert robot.footprint == read(file).footprint
    (tmp_path / "husky.yaml").write_text(
        "model: husky.urdf\ndrive: {left_joint: front_left_wheel, right_joint: front_right_wheel}\n"
        "limits: {linear_speed: 1.0, angular_speed: 2.0, linear_acceleration: 1.0, angular_acceleration: 3.0}\n"
    )
    with pytest.warns(RobotWarning, match="2 wheels a side, and is taken as skid-steer"):
        assert Robot.load(tmp_path / "husky.yaml").drive.axles == robot.drive.axles


def test_three_axles_are_one_drive(tmp_path):
    robot = read(write(tmp_path, ends=("front", "middle", "rear")))
    assert [axle.x for axle in robot.drive.axles] == pytest.approx([0.256, 0.0, -0.256])


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
@pytest.mark.parametrize(("v", "w"), [(0.5, 0.0), (0.0, 0.8), (0.3, -0.5)])
def test_it_follows_its_commands(tmp_path, backend, v, w):
    robot = read(write(tmp_path))
    with (
        simulate(World("empty", ()), robot, backend="kinematic") as exact,
        simulate(World("empty", ()), robot, backend=backend) as simulator,
    ):
        for _ in range(60):
            expected, state = exact.step(Twist2D(v, w), 0.05), simulator.step(Twist2D(v, w), 0.05)
    assert state.pose.distance_to(expected.pose) < 0.02
    assert abs(state.pose.yaw - expected.pose.yaw) < math.radians(1.0)
    assert state.odometry.distance_to(state.pose) < 0.02
    assert state.wheel_speeds == pytest.approx(robot.wheel_speeds(Twist2D(v, w)), abs=0.01)


def test_it_pushes_a_wall_and_stands(tmp_path):
    robot = read(write(tmp_path))
    front = float(robot.outline[:, 0].max())
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((front + 0.2 + 0.1, 0.0, 0.5)))
    with simulate(World("w", (wall,)), robot) as simulator:
        states = [simulator.step(Twist2D(1.0, 0.0), 0.005) for _ in range(400)]
    assert any(state.contacts for state in states)
    assert min(state.twist.v for state in states) > -0.1
    assert states[-1].pose.x == pytest.approx(0.2, abs=0.02)


def test_every_wheel_is_drawn_and_turns(tmp_path):
    robot = read(write(tmp_path))
    model = robot_spec(robot).compile()
    looks = [geom for geom in range(model.ngeom) if model.geom_group[geom] == 2]
    seen = {model.body(int(model.geom_bodyid[geom])).name for geom in looks}
    assert {"wheel_left_0", "wheel_right_0", "wheel_left_1", "wheel_right_1"} <= seen
    assert not {"wheel_left", "wheel_right"} & seen
    with simulate(World("empty", ()), robot) as simulator:
        simulator.reset(Pose2D(0.0, 0.0))
        for _ in range(40):
            simulator.step(Twist2D(0.5, 0.0), 0.05)
        speeds = [simulator.data.joint(wheel.joint).qvel[0] for wheel in robot.drive.wheels]
    assert speeds == pytest.approx([0.5 / robot.drive.wheel_radius] * 4, rel=0.01)


def test_joints_says_which_wheels_are_driven(tmp_path):
    file = write(tmp_path)
    names = [f"{end}_{side}_wheel" for end in ("front", "rear") for side in ("left", "right")]
    assert sorted(joint.name for joint in list_joints(file) if joint.drives) == sorted(names)
    listed = list_joints(read(file))
    assert sorted(joint.name for joint in listed if joint.drives) == sorted(names)
    assert not any(joint.name.startswith("traction") for joint in listed)


def test_joints_knows_the_wheels_where_meshes_are_missing(tmp_path):
    file = write(tmp_path)
    mesh = '<collision><geometry><mesh filename="package://gone/hull.stl"/></geometry></collision></link>'
    file.write_text(file.read_text().replace("</link>", mesh, 1))
    assert sum(joint.drives for joint in list_joints(file)) == 4


def test_an_exported_urdf_has_all_wheels_and_reads_back(tmp_path):
    robot = read(write(tmp_path))
    back = read(export_robot(robot, tmp_path / "back.urdf"))
    assert [axle.x for axle in back.drive.axles] == pytest.approx([axle.x for axle in robot.drive.axles], abs=1e-6)
    assert back.total_mass == pytest.approx(robot.total_mass, rel=1e-3)


@pytest.mark.parametrize(("name", "kind"), [("mecanum", "mecanum"), ("omni", "omni")])
def test_wheels_that_roll_sideways_are_named_and_refused(tmp_path, name, kind):
    with pytest.raises(RobotError, match=rf"'front_left_{name}_wheel' is an? {kind} wheel"):
        read(write(tmp_path, names="{end}_{side}_" + name + "_wheel"))


def test_wheels_with_rollers_are_refused(tmp_path):
    file = write(tmp_path)
    rollers = "".join(
        f'<link name="r{i}"><inertial><mass value="0.01"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" '
        f'iyz="0"/></inertial></link><joint name="roller_{i}" type="continuous"><parent link="front_left_wheel_link"/>'
        f'<child link="r{i}"/><origin xyz="0 0 0.1"/><axis xyz="1 1 0"/></joint>'
        for i in range(8)
    )
    file.write_text(file.read_text().replace("</robot>", rollers + "</robot>"))
    with pytest.raises(RobotError, match=r"'front_left_wheel' is a mecanum or omni wheel, with 8 rollers"):
        read(file)


RIDGEBACK_PLUGIN = """<gazebo><plugin name="ridgeback_ros_force_based_move"
  filename="libridgeback_ros_force_based_move.so"><commandTopic>cmd_vel</commandTopic></plugin></gazebo>"""
FRICTIONLESS = '<gazebo reference="front_left_wheel_link"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>'
DIAGONAL = '<gazebo reference="front_left_wheel_link"><mu1>1.0</mu1><mu2>0.0</mu2><fdir1>1 -1 0</fdir1></gazebo>'
DRIVE_PLUGIN = '<gazebo><plugin filename="gz-sim-mecanum-drive-system" name="gz::sim::systems::MecanumDrive"/></gazebo>'


@pytest.mark.parametrize(
    ("part", "why"),
    [
        (RIDGEBACK_PLUGIN, "by its plugin libridgeback_ros_force_based_move.so"),
        (DRIVE_PLUGIN, "by its plugin gz-sim-mecanum-drive-system"),
        (FRICTIONLESS, "'front_left_wheel' is a mecanum or omni wheel, as it has no friction"),
        (DIAGONAL, "'front_left_wheel' is a mecanum wheel, by the diagonal of its friction"),
    ],
)
def test_wheels_that_roll_sideways_are_told_by_what_the_simulator_gets(tmp_path, part, why):
    file = write(tmp_path)
    file.write_text(file.read_text().replace("</robot>", part + "</robot>"))
    with pytest.raises(RobotError, match=why):
        read(file)


def test_wheels_that_roll_sideways_are_told_by_their_meshes(tmp_path):
    file = write(tmp_path)
    mesh = '<visual><geometry><mesh filename="package://r/meshes/Mecanum_left.stl"/></geometry></visual></link>'
    text = file.read_text()
    at = text.index("</link>", text.index("front_left_wheel_link"))
    file.write_text(text[:at] + mesh + text[at + len("</link>") :])
    with pytest.raises(RobotError, match=r"is a mecanum wheel, by its mesh Mecanum_left\.stl"):
        read(file)


def test_a_wheel_across_the_others_is_refused_and_a_caster_is_not(tmp_path):
    file = write(tmp_path, ends=("front",))
    text = file.read_text()
    across = wheel("back_wheel", -0.3, 0.0, HUSKY).replace('axis xyz="0 1 0"', 'axis xyz="1 0 0"')
    file.write_text(text.replace("</robot>", across + "</robot>"))
    with pytest.raises(RobotError, match="'back_wheel' is an omni wheel, by its axis"):
        read(file)
    file.write_text(text.replace("</robot>", across.replace("back_wheel", "back_caster_wheel") + "</robot>"))
    assert read(file).drive.axles == ()


def test_two_plain_wheels_may_be_pushed_by_a_plugin_that_knows_no_wheels(tmp_path):
    file = write(tmp_path, ends=("front",))
    plugin = '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so"/></gazebo>'
    file.write_text(file.read_text().replace("</robot>", plugin + "</robot>"))
    assert read(file).drive.axles == ()


def test_several_plain_wheels_a_side_get_one_warning(tmp_path):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Robot.from_model(write(tmp_path))
    assert sum("2 wheels a side, and is taken as skid-steer" in str(one.message) for one in caught) == 1


def test_wheels_that_are_not_opposite_each_other_are_refused(tmp_path):
    file = write(tmp_path)
    file.write_text(file.read_text().replace('xyz="-0.256 -0.2854', 'xyz="-0.156 -0.2854'))
    with pytest.raises(RobotError, match="rear_right_wheel"):
        read(file)


def test_isaac_refuses_several_axles_before_it_starts(tmp_path):
    robot = read(write(tmp_path))
    with pytest.raises(RobotError, match=r"'husky' has several wheels per side.*use backend mujoco or kinematic"):
        simulate(World("empty", ()), robot, backend="isaac")


def test_a_script_for_isaac_sim_refuses_several_axles(tmp_path):
    robot = read(write(tmp_path))
    plan = Plan(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    scene = Scene("mission", World("empty", ()), robot, Pose2D(0.0, 0.0), (plan,))
    with pytest.raises(InputError, match="'husky' has several wheels on each side"):
        export_scene(scene, tmp_path / "drive.py")
    assert not (tmp_path / "drive.py").exists()
