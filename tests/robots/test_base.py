"""Robots whose file builds on another robot."""

import numpy as np
import pytest

from trundle.errors import RobotError
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World
from trundle.worlds.generators.clutter import PALLET_SIZE, pallet
from trundle.worlds.generators.props import place

LOW = "base: nova_carter\nlidars:\n  low: {x: 0.13, y: 0.0, z: 0.1, fov: 180deg}\n"


def write(folder, text, name="carter_low.yaml"):
    (folder / name).write_text(text)
    return folder / name


def test_a_lidar_is_added_to_a_robot_of_the_catalogue(tmp_path):
    robot, carter = Robot.load(write(tmp_path, LOW)), Robot.load("nova_carter")
    assert robot.name == "carter_low"
    assert list(robot.lidars) == ["front", "back", "low"]
    assert robot.model_copy(update={"name": carter.name, "lidars": carter.lidars}) == carter


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_low_lidar_sees_a_pallet(tmp_path, backend):
    robot = Robot.load(write(tmp_path, LOW))
    x = 1.5 + PALLET_SIZE[0] / 2.0
    empty = [part for part in pallet(np.random.default_rng(0)) if part.kind == "pallet"]
    with simulate(
        World("pallet", tuple(place(empty, "pallet", x, 0.0, 0.0))), robot, backend=backend, lidar=True
    ) as sim:
        scans = {scan.lidar: scan for scan in sim.reset(Pose2D(0.0, 0.0)).scans}
    assert np.isinf(scans["front"].ranges).all()
    assert scans["low"].points()[:, 0].min() == pytest.approx(1.5, abs=1e-3)


def test_settings_within_a_mapping_are_replaced_one_by_one_and_lists_as_a_whole(tmp_path):
    text = "base: nova_carter\nname: slow\nlimits: {linear_speed: 0.3}\nlidars: {front: {noise: 0.01}}\ncasters: []\n"
    robot, carter = Robot.load(write(tmp_path, text)), Robot.load("nova_carter")
    assert robot.name == "slow"
    assert robot.limits == carter.limits.model_copy(update={"linear_speed": 0.3})
    assert robot.lidars["front"] == carter.lidars["front"].model_copy(update={"noise": 0.01})
    assert robot.casters == ()


def test_a_base_may_have_a_base_and_is_relative_to_its_file(tmp_path):
    (tmp_path / "more").mkdir()
    write(tmp_path, LOW)
    second = write(tmp_path / "more", "base: ../carter_low.yaml\nlidars: {low: {noise: 0.02}}\n", "noisy.yaml")
    robot = Robot.load(second)
    assert robot.name == "noisy"
    assert (robot.lidars["low"].z, robot.lidars["low"].noise) == (0.1, 0.02)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("base: nova_cartr\n", "Did you mean 'nova_carter'"),
        ("base: 3\n", "base must be the name of a robot or the path of its file, got 3"),
        ("base: carter_low.yaml\n", "is based on this file itself"),
        ("base: gone.yaml\n", r"gone\.yaml"),
        ("base: nova_carter\nmodel: a.urdf\n", "either model or base"),
        ("base: nova_carter\nlidars: {low: {x: 0.1, y: 0.0}}\n", r"carter_low\.yaml:2:15: lidars\.low\.z: "),
        ("base: nova_carter\nlidar: {}\n", "Did you mean 'lidars'"),
    ],
)
def test_a_base_that_cannot_be_used_is_reported(tmp_path, text, words):
    with pytest.raises(RobotError, match=words):
        Robot.load(write(tmp_path, text))


def test_a_round_of_bases_is_reported(tmp_path):
    first = write(tmp_path, "base: b.yaml\n", "a.yaml")
    write(tmp_path, "base: a.yaml\n", "b.yaml")
    with pytest.raises(RobotError, match="is based on this file itself"):
        Robot.load(first)
