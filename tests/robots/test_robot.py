import math
from importlib import resources

import numpy as np
import pytest

from trundle.errors import AngleWarning, RobotError, UnknownNameError
from trundle.robots import Robot, robot_names

CATALOGUE = ["jackal", "nova_carter", "turtlebot3_burger", "turtlebot3_waffle"]


def text_of(name):
    return (resources.files("trundle.robots") / "catalogue" / f"{name}.yaml").read_text()


def load_changed(tmp_path, old, new, name="nova_carter"):
    text = text_of(name)
    assert old in text
    path = tmp_path / "mine.yaml"
    path.write_text(text.replace(old, new, 1))
    return Robot.load(path)


def test_the_catalogue_is_complete():
    assert set(CATALOGUE) <= set(robot_names())


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_catalogue_robot_stands_and_fits_its_footprint(name):
    robot = Robot.load(name)
    assert robot.name == name
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    wheel = robot.drive.track_width / 2.0 + robot.drive.wheel_width / 2.0
    assert wheel <= high[1]
    assert -wheel >= low[1]
    for caster in robot.casters:
        assert low[0] <= caster.x - caster.trail - caster.radius * 0.5
        assert caster.x <= high[0]
    assert all(lidar.z < robot.body.height for lidar in robot.lidars.values())
    assert robot.z_range[0] < robot.z_range[1]


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_users_file_works_as_ours(name, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(text_of(name))
    assert Robot.load(path) == Robot.load(name)
    assert Robot.load(str(path)) == Robot.load(name)


def test_a_robot_is_taken_as_it_is():
    robot = Robot.load("jackal")
    assert Robot.load(robot) is robot


def test_nova_carter_is_off_centre():
    robot = Robot.load("nova_carter")
    assert robot.drive.track_width == 0.4132
    assert robot.drive.wheel_radius == 0.14
    assert robot.circumscribed_radius == pytest.approx(math.hypot(0.607, 0.25))
    assert robot.inscribed_radius == pytest.approx(0.14)
    assert robot.total_mass == pytest.approx(57.5, abs=0.05)
    assert robot.z_range == (0.10, 0.62)


def test_the_outline_goes_counter_clockwise_whichever_way_it_was_given(tmp_path):
    ours = Robot.load("nova_carter").outline
    square = "footprint: [[0.14, 0.25], [-0.607, 0.25], [-0.607, -0.25], [0.14, -0.25]]"
    mirrored = "footprint: [[0.14, -0.25], [-0.607, -0.25], [-0.607, 0.25], [0.14, 0.25]]"
    theirs = load_changed(tmp_path, square, mirrored).outline
    for outline in (ours, theirs):
        x, y = outline.T
        assert (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0 == pytest.approx(0.747 * 0.5)


def test_an_unknown_name_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean 'nova_carter'"):
        Robot.load("nova_cartr")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "wheel_radius: 0.14",
            "wheel_radius: -0.14",
            "mine.yaml:8:17: drive.wheel_radius: -0.14 is out of range",
        ),
        ("wheel_radius: 0.14", "wheel_radius: 100", "drive.wheel_radius: 100 is out of range: .* at most 5 m"),
        (
            "mass: 52.91",
            "mass: 5.46e7",
            "body.mass: 54600000 is out of range: it must be above 0 and at most 1000000 kg",
        ),
        ("linear_speed: 0.8", "linear_speed: 800", "limits.linear_speed: 800 .* at most 100 m/s"),
        ("[[0.14, 0.25], ", "[[140, 250], ", "footprint.0.1: 250 is out of range: it must be .* at most 50 m"),
        ("yaw: 3.141592653589793", "yaw: north", "lidars.front.yaw: 'north' is not an angle; .* 90deg"),
        ("wheel_radius: 0.14", "wheel_radius: .nan", "mine.yaml:8:17: drive.wheel_radius: .*finite"),
        ("wheel_radius: 0.14", "wheel_radius: big", "mine.yaml:8:17: drive.wheel_radius: .*number"),
        (
            "wheel_radius: 0.14",
            "wheel_radious: 0.14",
            "8:3: drive.wheel_radious: unknown key. Did you mean 'wheel_radius'",
        ),
        ("  type: differential", "  type: ackermann", "mine.yaml:7:9: drive.type"),
        (
            "angular_speed: 0.7",
            "angular_speed: 0",
            "mine.yaml:18:18: limits.angular_speed: 0 is out of range",
        ),
        ("[[0.14, 0.25], ", "[", "must lie inside the footprint"),
        ("[-0.607, 0.25], ", "[0.14, -0.25], ", "convex outline"),
        ("[[0.14, 0.25], ", "[[-0.14, 0.25], ", "must lie inside the footprint"),
        ("clearance: 0.06", "clearance: 0.7", "clearance 0.7 must be below height 0.62"),
        (", swivel_joint: joint_swing_left", "", "name both swivel_joint and wheel_joint"),
        ("trail: 0.04", "trail: 0", "a swivel caster needs a trail"),
        ("z: 0.418, yaw", "z: -1, yaw", "lidars.front.z"),
        ("[0.10, 0.62]", "[0.62, 0.10]", "from low to high"),
        ("name: nova_carter\n", "", "name: is missing"),
    ],
)
def test_a_bad_value_is_refused_with_its_place(old, new, message, tmp_path):
    with pytest.raises(RobotError, match=message) as caught:
        load_changed(tmp_path, old, new)
    assert "mine.yaml:" in str(caught.value)


def test_every_mistake_of_a_file_is_reported(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(text_of("nova_carter").replace("0.14\n", "-1\n").replace("mass: 52.91", "mass: heavy"))
    with pytest.raises(RobotError) as caught:
        Robot.load(path)
    assert len(str(caught.value).splitlines()) == 2


def test_a_missing_file_is_a_robot_error(tmp_path):
    with pytest.raises(RobotError, match="cannot read"):
        Robot.load(tmp_path / "none.yaml")


def test_a_misspelt_key_is_one_mistake_and_not_two(tmp_path):
    with pytest.raises(RobotError) as caught:
        load_changed(tmp_path, "track_width: ", "track_widht: ")
    assert len(str(caught.value).splitlines()) == 1
    assert "Did you mean 'track_width'" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n", "a map"),
        ("world: warehouse\nstart: [0, 0]\ngoal: [1, 1]\n", "a scenario"),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(text, kind, tmp_path):
    (tmp_path / "other.yaml").write_text(text)
    with pytest.raises(RobotError) as caught:
        Robot.load(tmp_path / "other.yaml")
    assert str(caught.value) == f"{tmp_path / 'other.yaml'}: this is {kind}, not a robot"


def test_angles_may_be_in_degrees(tmp_path):
    robot = load_changed(tmp_path, "yaw: 3.141592653589793", "yaw: 180deg, fov: 90deg")
    assert robot.lidars["front"].yaw == pytest.approx(math.pi)
    assert robot.lidars["front"].fov == pytest.approx(math.pi / 2.0)


def test_an_angle_beyond_a_whole_turn_is_warned_of_with_its_place(tmp_path):
    with pytest.warns(AngleWarning, match=r"mine.yaml:46:44: lidars.front.yaw: 180 is more than .* 180deg"):
        robot = load_changed(tmp_path, "yaw: 3.141592653589793", "yaw: 180")
    assert robot.lidars["front"].yaw == math.remainder(180.0, math.tau)
