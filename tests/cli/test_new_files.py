"""`trundle scenario` and `trundle robot`: files to edit."""

import json
from pathlib import Path

import pytest

from trundle.export import export_robot
from trundle.mission import Scenario
from trundle.robots import Robot


def test_a_scenario_has_what_its_options_say_and_runs(trundle):
    options = ("--seed", 3, "--inflation-radius", 0.9, "--planner-option", "max_replans=5", "--backend", "kinematic")
    done = trundle("scenario", "maze", *options, "-o", "s.yaml")
    assert done.code == 0, done.err
    scenario = Scenario.load("s.yaml")
    assert (scenario.seed, scenario.inflation_radius, scenario.planner.options) == (3, 0.9, {"max_replans": 5})
    assert trundle("run", "s.yaml", "--no-video", "-o", "run").code == 0


def test_a_file_is_not_replaced_unasked(trundle):
    for verb in (("scenario", "maze", "-o", "a.yaml"), ("robot", "new", "mine", "-o", "a.yaml")):
        Path("a.yaml").unlink(missing_ok=True)
        assert trundle(*verb).code == 0
        before = Path("a.yaml").read_bytes()
        done = trundle(*verb)
        assert done.code == 2
        assert "--overwrite" in done.err
        assert Path("a.yaml").read_bytes() == before
        assert trundle(*verb, "--overwrite").code == 0


def test_a_scenario_needs_a_place(trundle):
    done = trundle("scenario")
    assert done.code == 2
    assert "give a map, a world" in done.err


def test_schemas_are_printed(trundle):
    assert json.loads(trundle("scenario", "--schema").out)["title"] == "trundle scenario"
    assert json.loads(trundle("robot", "schema").out)["title"] == "trundle robot"


def test_a_new_robot_drives(trundle):
    assert trundle("robot", "new", "mine").code == 0
    assert Robot.load("mine.yaml").name == "mine"
    done = trundle("run", "maze", "--robot", "mine.yaml", "--no-video", "-o", "run", "--backend", "kinematic")
    assert done.code == 0, done.err


@pytest.mark.filterwarnings("ignore::trundle.errors.RobotWarning")
def test_a_new_robot_of_a_model(trundle):
    export_robot(Robot.load("turtlebot3_burger"), "burger.urdf")
    assert trundle("robot", "new", "copy", "--urdf", "burger.urdf").code == 0
    copy = Robot.load("copy.yaml")
    assert copy.drive.track_width == pytest.approx(0.16)
    assert Path("copy.yaml").read_text(encoding="utf-8").count("burger.urdf") == 1


@pytest.mark.parametrize("name", ["../up", "", ".hidden"])
def test_a_robot_has_a_plain_name(trundle, name):
    done = trundle("robot", "new", name)
    assert done.code == 2
    assert "cannot name a robot" in done.err
