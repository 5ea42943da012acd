"""Tests of --nav2-params, in each verb that takes it."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from support.command_line import Trundle
from trundle.mission import Scenario
from trundle.nav2.notes import ROS_OWN

NAV2 = Path(__file__).parents[1] / "nav2" / "data" / "humble.yaml"
ENDS = ("--start", "0.5,0.5", "--goal", "2.5,1.5")
ROBOT = ("--robot", "turtlebot3_waffle")


def test_a_run_takes_them_and_its_scenario_repeats_it(trundle: Trundle, room_map: Path) -> None:
    quick = ("--backend", "kinematic", "--no-video", "--no-report")
    done = trundle("run", room_map, "--nav2-params", NAV2, *ROBOT, *ENDS, *quick, "--out", "a", "--json")
    assert done.code == 0, done.err
    written = Scenario.load("a/scenario.yaml")
    assert written.planner.name == "least_cost"
    assert written.inflation_radius == 0.55
    assert written.assumed is not None
    assert written.lidar is True
    assert written.localizer is not None
    assert (written.localizer.name, dict(written.localizer.options)) == ("amcl", {"max_particles": 2000})
    again = trundle("run", "a/scenario.yaml", "--no-video", "--no-report", "--out", "b", "--json")
    assert "nav2_params" not in again.json
    with np.load("a/trajectory.npz") as first, np.load("b/trajectory.npz") as second:
        np.testing.assert_array_equal(first["x"], second["x"])


def test_what_has_no_counterpart_is_listed_on_stderr_and_in_the_json(trundle: Trundle, room_map: Path) -> None:
    done = trundle("scenario", room_map, "--nav2-params", NAV2, "--json")
    remarks = done.json["nav2_params"]["remarks"]
    assert done.json["nav2_params"]["file"] == str(NAV2)
    named = {(remark["node"], remark["name"]): remark for remark in remarks}
    assert ("amcl", "max_particles") not in named
    assert named["amcl", "base_frame_id"]["kind"] == "no counterpart"
    assert named["controller_server", "FollowPath.plugin"]["kind"] == "changed"
    assert all(name in done.err for (_, name), remark in named.items() if remark["text"] != ROS_OWN)
    assert "left to ROS" in done.err
    quiet = trundle("scenario", room_map, "--nav2-params", NAV2, "--quiet", "-o", "other.yaml")
    assert len(quiet.err.strip().splitlines()) == 1
    assert "--json lists them" in quiet.err


def test_options_come_before_the_file_and_the_file_before_a_scenario(trundle: Trundle, room_map: Path) -> None:
    plain = Path("plain.yaml")
    Scenario.make(map=str(room_map), inflation_radius=0.9, goal_tolerance=0.1, start=(0.5, 0.5)).save(plain)
    given = ("--goal-tolerance", "0.4", "--planner", "astar", "--no-lidar")
    done = trundle("scenario", plain, "--nav2-params", NAV2, *given, "-o", "out.yaml")
    assert done.code == 0, done.err
    scenario = Scenario.load("out.yaml")
    assert (scenario.inflation_radius, scenario.goal_tolerance, scenario.planner.name) == (0.55, 0.4, "astar")
    assert scenario.start == (0.5, 0.5)
    assert (scenario.lidar, scenario.collision_monitor, scenario.localizer) == (False, None, None)


def test_plan_takes_its_planner_and_its_outline(trundle: Trundle, room_map: Path) -> None:
    done = trundle("plan", room_map, "--nav2-params", NAV2, *ENDS, "--json")
    assert done.code == 0, done.err
    assert (done.json["planner"], done.json["found_by"]) == ("least_cost", "least_cost")
    assert done.json["nav2_params"]["remarks"]
    other = trundle("plan", room_map, "--nav2-params", NAV2, *ENDS, "--planner", "any_angle", "--json")
    assert other.json["planner"] == "any_angle"
    table = trundle("plan", room_map, "--nav2-params", NAV2, *ENDS, "--compare", "--json")
    assert {row["planner"] for row in table.json["planners"]} >= {"auto", "astar"}


def test_evaluate_takes_them_for_every_episode(trundle: Trundle, room_map: Path) -> None:
    quick = ("--backends", "kinematic", "--seeds", "1", "--workers", "1", "--robots", "turtlebot3_waffle")
    done = trundle("evaluate", room_map, "--nav2-params", NAV2, *quick, "--time-limit", "60", "-o", "e", "--json")
    assert done.code == 0, done.err
    suite = yaml.safe_load(Path("e/suite.yaml").read_text())
    assert suite["planners"] == [{"name": "least_cost", "options": {"goal_tolerance": 0.5}}]
    assert len(suite["assumed"]) == 1
    assert json.loads(done.out.strip().splitlines()[-1])["nav2_params"]["remarks"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\n", "'a' in the file is not under ros__parameters"),
        (
            "controller_server:\n  ros__parameters:\n    controller_frequency: fast\n",
            "params.yaml:3:5: controller_server: controller_frequency must be a finite number, got 'fast'",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_bad_input(trundle: Trundle, room_map: Path, text: str, message: str) -> None:
    Path("params.yaml").write_text(text)
    done = trundle("run", room_map, "--nav2-params", "params.yaml")
    assert done.code == 2
    assert message in done.err
    assert trundle("run", room_map, "--nav2-params", "missing.yaml").code == 2
