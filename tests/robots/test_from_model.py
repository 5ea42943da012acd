from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
import shapely

from trundle.errors import InputError, RobotError, RobotWarning, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Limits, Robot
from trundle.robots.model_shape import MOST_CORNERS, simplify_outline
from trundle.sim import simulate
from trundle.worlds import World

# TurtleBot3 Burger's proportions: base_footprint on the floor, base_link 1 cm above, the axle 3.3 cm above the floor.
URDF = """
<robot name="mini">
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed">
    <parent link="base_footprint"/><child link="base_link"/><origin xyz="0 0 0.01"/></joint>
  <link name="base_link">
    <visual><geometry><mesh filename="package://mini/meshes/gone.stl"/></geometry></visual>
    <collision><origin xyz="-0.03 0 0.07"/><geometry><box size="0.14 0.12 0.12"/></geometry></collision>
    <inertial><origin xyz="-0.02 0 0.06"/><mass value="0.8"/>
      <inertia ixx="0.003" iyy="0.004" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></link>
  {wheel_left}{wheel_right}
  <link name="caster"><collision><geometry><sphere radius="0.01"/></geometry></collision>
    <inertial><mass value="0.005"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="caster_joint" type="fixed">
    <parent link="base_link"/><child link="caster"/><origin xyz="-0.08 0 0"/></joint>
</robot>
"""
WHEEL = """
  <link name="wheel_{side}"><collision><geometry><cylinder radius="0.033" length="0.018"/></geometry></collision>
    <inertial><mass value="0.03"/><inertia ixx="2e-5" iyy="2e-5" izz="2e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="wheel_{side}_joint" type="continuous"><parent link="base_link"/><child link="wheel_{side}"/>
    <origin xyz="0 {y} 0.023" rpy="-1.5707963267948966 0 0"/><axis xyz="0 0 1"/>
    <limit effort="10" velocity="6.67"/></joint>
"""


def urdf(folder: Path, **changes: str) -> Path:
    parts = {f"wheel_{side}": WHEEL.format(side=side, y=y) for side, y in (("left", 0.08), ("right", -0.08))}
    file = folder / "mini.urdf"
    file.write_text(URDF.format(**(parts | changes)))
    return file


@pytest.fixture
def mini(tmp_path: Path) -> Path:
    return urdf(tmp_path)


def read(path: Path, **options) -> Robot:
    with pytest.warns(RobotWarning, match="assumed"):
        return Robot.from_model(path, **options)


def test_a_urdf_robot_is_read_off_its_model(mini):
    robot = read(mini)
    assert robot.name == "mini"
    drive = robot.drive
    assert (drive.left_joint, drive.right_joint) == ("wheel_left_joint", "wheel_right_joint")
    assert drive.wheel_radius == pytest.approx(0.033, rel=1e-3)
    assert drive.track_width == pytest.approx(0.16)
    assert drive.wheel_width == pytest.approx(0.018)
    assert drive.wheel_mass == pytest.approx(0.03)
    assert robot.total_mass == pytest.approx(0.865)
    assert robot.body.height == pytest.approx(0.14, abs=1e-4)
    assert robot.body.clearance == pytest.approx(0.02, abs=1e-4)
    np.testing.assert_allclose(robot.body.center_of_mass, (-0.08 * 0.005 / 0.805 - 0.016 / 0.805, 0, 0.07), atol=1e-3)
    caster = robot.casters[0]
    assert (caster.x, caster.y) == pytest.approx((-0.08, 0.0), abs=1e-6)
    assert len(robot.casters) == 1
    # Chassis from -0.1 to 0.04 by ±0.06, wheels to ±0.033 by ±0.089.
    assert robot.outline.min(axis=0) == pytest.approx((-0.1, -0.089), abs=1e-4)
    assert robot.outline.max(axis=0) == pytest.approx((0.04, 0.089), abs=1e-4)
    assert robot.limits.linear_speed == pytest.approx(6.67 * 0.033, rel=1e-3)
    assert robot.limits.angular_speed == pytest.approx(2 * 6.67 * 0.033 / 0.16, rel=1e-3)


def test_what_is_given_goes_before_what_is_read(mini):
    limits = Limits(linear_speed=0.2, angular_speed=1.0, linear_acceleration=1.0, angular_acceleration=2.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot = Robot.from_model(mini, wheel_radius=0.04, track_width=0.2, limits=limits, name="wide")
    assert (robot.drive.wheel_radius, robot.drive.track_width, robot.limits, robot.name) == (0.04, 0.2, limits, "wide")


YAML = """
model: models/mini.urdf
drive: {left_joint: wheel_left_joint, right_joint: wheel_right_joint, max_wheel_speed: 6.0}
limits: {linear_speed: 0.2, angular_speed: 1.0, linear_acceleration: 1.0, angular_acceleration: 2.0}
body: {color: [1, 0, 0]}
lidars: {scan: {x: 0, y: 0, z: 0.1}}
"""


def test_a_yaml_can_name_a_model_and_add_to_it(tmp_path):
    (tmp_path / "models").mkdir()
    urdf(tmp_path / "models")
    (tmp_path / "mini.yaml").write_text(YAML)
    robot = Robot.load(tmp_path / "mini.yaml")
    assert robot.drive.max_wheel_speed == 6.0
    assert robot.drive.track_width == pytest.approx(0.16)
    assert robot.body.color == (1.0, 0.0, 0.0)
    assert robot.body.mass == pytest.approx(0.795)
    assert set(robot.lidars) == {"scan"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("modle: mini.urdf\n", "r.yaml:1:1: modle: unknown key. Did you mean 'model'? There are: name, "),
        (YAML.replace("models/", "") + "path: [here]\n", "path: unknown key. Did you mean 'paths'?"),
        ("model: mini.step\n", "model must be the path of a .urdf, .xacro, .xml, .mjcf file, got 'mini.step'"),
        ("model: gone.urdf\n", "gone.urdf: no such file"),
        (YAML.replace("models/", "") + "colour: red\n", "colour: unknown key"),
        (YAML.replace("models/", "") + "paths: here\n", "paths must be a list"),
        (
            YAML.replace("models/", "").replace("drive: {", "drive: {wheel_radius: -1, "),
            "wheel_radius must be a positive",
        ),
        (YAML.replace("models/", "").replace("[1, 0, 0]", "red"), "body.color: must be a list, got 'red'"),
        ("model: mini.urdf\ndrive: 3\n", "drive must be a mapping"),
    ],
)
def test_mistakes_in_such_a_yaml_are_named(mini, text, message):
    file = mini.parent / "r.yaml"
    file.write_text(text)
    with pytest.raises(RobotError) as caught:
        Robot.load(file)
    assert message in str(caught.value)


def test_a_urdf_robot_follows_commands_in_both_simulators(mini):
    robot = read(mini)
    for backend in ("mujoco", "kinematic"):
        with simulate(World("floor", ()), robot, backend=backend) as sim:
            sim.reset(Pose2D(0.0, 0.0))
            for _ in range(80):
                state = sim.step(Twist2D(0.15, 0.5), 0.05)
        assert state.twist.v == pytest.approx(0.15, rel=0.02)
        assert state.twist.w == pytest.approx(0.5, rel=0.02)
        assert state.pose.yaw == pytest.approx(0.5 * 4.0, abs=0.12)


MJCF = """
<mujoco model="cart">
  <worldbody>
    <geom type="plane" size="0 0 1"/><geom name="wall" type="box" size="9 9 9" pos="30 0 0"/>
    <body name="base" pos="2 3 0.2" euler="0 0 90"><freejoint/>
      <geom type="box" size="0.3 0.2 0.1" mass="10"/>
      <body pos="0.1 0.25 -0.1"><joint name="l" axis="0 1 0"/>
        <geom type="ellipsoid" size="0.1 0.02 0.1" mass="1"/></body>
      <body pos="0.1 -0.25 -0.1"><joint name="r" axis="0 -1 0"/>
        <geom type="ellipsoid" size="0.1 0.02 0.1" mass="1"/></body>
      <body pos="-0.2 0 -0.15"><joint name="swivel" axis="0 0 1"/>
        <geom type="sphere" size="0.05" mass="0.5"/></body>
    </body>
  </worldbody>
</mujoco>
"""


def test_an_mjcf_robot_is_read_wherever_it_stands(tmp_path):
    (tmp_path / "cart.xml").write_text(MJCF)
    robot = read(tmp_path / "cart.xml", left_joint="l", right_joint="r")
    assert robot.drive.wheel_radius == pytest.approx(0.1)
    assert robot.drive.track_width == pytest.approx(0.5)
    assert robot.total_mass == pytest.approx(12.5)
    assert robot.body.height == pytest.approx(0.3)
    # base_link is under the axle, 0.1 m ahead of the box's middle.
    assert robot.outline.min(axis=0) == pytest.approx((-0.4, -0.27), abs=1e-3)
    assert robot.outline.max(axis=0) == pytest.approx((0.2, 0.27), abs=1e-3)
    assert [(round(c.x, 6), round(c.y, 6)) for c in robot.casters] == [(-0.3, 0.0)]
    assert robot.body.inertia[0] < robot.body.inertia[1] < robot.body.inertia[2]


def test_a_robot_that_would_tip_over_gets_a_ball_with_a_word(tmp_path):
    text = MJCF.replace('<geom type="sphere" size="0.05" mass="0.5"/>', '<geom type="sphere" size="0.02" mass="0.5"/>')
    (tmp_path / "cart.xml").write_text(text)
    with pytest.warns(RobotWarning) as caught:
        robot = Robot.from_model(tmp_path / "cart.xml", left_joint="l", right_joint="r")
    assert any("nothing supports the back of the robot" in str(one.message) for one in caught)
    assert len(robot.casters) == 1
    assert robot.casters[0].x < robot.body.center_of_mass[0]


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({}, RobotError, "which joints drive the robot? Its revolute joints are: l, r, swivel"),
        ({"left_joint": "l", "right_joint": "rr"}, UnknownNameError, "Did you mean 'r'"),
        ({"left_joint": "l", "right_joint": "l"}, RobotError, "are both 'l'"),
        ({"left_joint": "r", "right_joint": "l"}, RobotError, "swap the two"),
        ({"left_joint": "l", "right_joint": "swivel"}, RobotError, "not horizontal"),
        (
            {"left_joint": "l", "right_joint": "r", "track_width": math.nan},
            RobotError,
            "track_width must be a positive",
        ),
    ],
)
def test_wheels_that_cannot_be_are_refused(tmp_path, options, kind, message):
    (tmp_path / "cart.xml").write_text(MJCF)
    with pytest.raises(kind) as caught:
        Robot.from_model(tmp_path / "cart.xml", **options)
    assert message in str(caught.value)


WHEEL_GEOM = '<geom type="ellipsoid" size="0.1 0.02 0.1" mass="1"/>'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (WHEEL_GEOM, '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>', "has no geometry to read its radius from"),
        (WHEEL_GEOM, WHEEL_GEOM.replace("0.1", "0.2"), "they must be equal"),
        ('pos="0.1 -0.25 -0.1"', 'pos="-0.2 -0.25 -0.1"', "do not rotate about one axis"),
        ('pos="0.1 -0.25 -0.1"', 'pos="0.1 0.25 -0.1"', "are in one place"),
    ],
)
def test_models_without_two_wheels_on_one_axle_are_refused(tmp_path, old, new, message):
    assert old in MJCF
    (tmp_path / "cart.xml").write_text(MJCF.replace(old, new, 1))
    with pytest.raises(RobotError) as caught:
        Robot.from_model(tmp_path / "cart.xml", left_joint="l", right_joint="r")
    assert message in str(caught.value)


def test_a_wheel_without_geometry_needs_only_a_radius(tmp_path):
    text = MJCF.replace(WHEEL_GEOM, '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>')
    (tmp_path / "cart.xml").write_text(text)
    robot = read(tmp_path / "cart.xml", left_joint="l", right_joint="r", wheel_radius=0.1)
    assert (robot.drive.wheel_radius, robot.drive.track_width) == (0.1, pytest.approx(0.5))


def test_a_model_file_is_loaded_by_its_path(mini):
    with pytest.warns(RobotWarning):
        assert Robot.load(mini).name == "mini"
    with pytest.raises(InputError, match="no such file"):
        Robot.load(mini.parent / "gone.urdf")


def test_an_outline_of_many_corners_is_enclosed_in_one_of_fewer():
    angles = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    circle = np.c_[np.cos(angles), 0.5 * np.sin(angles)]
    outline = simplify_outline(circle)
    assert len(outline) <= MOST_CORNERS
    assert shapely.Polygon(outline).buffer(2e-4).contains(shapely.Polygon(circle))
    assert shapely.Polygon(outline).area < 1.03 * shapely.Polygon(circle).area


@pytest.mark.parametrize(
    ("inertial", "shape", "message"),
    [
        ('diaginertia="1 1 1"', "", "none of its links has a shape"),
        ('diaginertia=""', '<geom size=".1"/>', "mass and inertia of moving bodies"),
        ('fullinertia=" "', '<geom size=".1"/>', "mass and inertia of moving bodies"),
        ("", '<geom size=".1"/>', "mass and inertia of moving bodies"),
    ],
)
def test_a_chassis_without_a_shape_or_an_inertia_is_refused(tmp_path, inertial, shape, message):
    mass = '<inertial pos="0 0 0" mass="1" {}/>'
    round_mass = mass.format('diaginertia=".1 .1 .1"')
    wheels = "".join(
        f'<body pos="0 {y} .05">{round_mass}<joint name="{side}_wheel" axis="0 1 0"/></body>'
        for side, y in (("left", 0.1), ("right", -0.1))
    )
    chassis = f'<body pos="0 0 .1"><freejoint/>{mass.format(inertial)}{shape}{wheels}</body>'
    (tmp_path / "m.xml").write_text(f"<mujoco><worldbody>{chassis}</worldbody></mujoco>")
    (tmp_path / "r.yaml").write_text("model: m.xml\ndrive: {wheel_radius: 0.05}\n")
    with pytest.raises(RobotError, match=rf"m\.xml: .*{message}"):
        Robot.load(tmp_path / "r.yaml", trusted=True)


@pytest.mark.parametrize("place", ["0 0 1e300", "nan 0 0", "0 1e20 0"])
def test_geometry_that_is_nowhere_is_refused(tmp_path, place):
    """Found by mutated files: the lowest points of a part could not be distinguished from its others."""
    wheels = "".join(
        f"<body pos='0 {y} -.05'><joint name='{side}_wheel' type='hinge' axis='0 1 0'/>"
        "<geom type='cylinder' size='.05 .02' euler='90 0 0'/></body>"
        for side, y in (("left", 0.12), ("right", -0.12))
    )
    (tmp_path / "r.xml").write_text(
        "<mujoco><worldbody><body pos='0 0 .1'><freejoint/><inertial pos='0 0 0' mass='5' diaginertia='1 1 1'/>"
        f"<geom type='box' size='.2 .1 .05'/><geom type='box' size='.1 .1 .1' pos='{place}'/>{wheels}</body>"
        "</worldbody></mujoco>"
    )
    with pytest.raises(RobotError):
        Robot.from_model(tmp_path / "r.xml")
