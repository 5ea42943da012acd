"""`trundle ros2 navigate`: what is refused before anything moves."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from support.command_line import Trundle
from support.room_drives import Drive, write_bag
from trundle.maps import OccupancyGrid
from trundle.mission.steering import goal_directives

pytest.importorskip("rosbags", reason="rosbags is not installed")
pytest.importorskip("cyclonedds", reason="cyclonedds is not installed, or has no wheel here")

NETWORK = ("--transport", "dds", "--domain", "98")
NAVIGATE = ("ros2", "navigate", "warehouse", *NETWORK)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("--localizer", "odometry"), "--localizer odometry needs --start X,Y,YAW"),
        (("--start", "900,0,0"), "the start (900, 0) lies outside of the map"),
        (("--start", "0,0,0", "--goal", "900,0"), "the goal (900, 0) lies outside of the map"),
        (("--backend", "kinematic"), "--backend is for simulated robots"),
        (("--odometry", "scale=0.1"), "--odometry is for simulated robots"),
        (("--lidar-errors", "noise=0.02"), "--lidar-errors is for simulated robots"),
        (("--agent", "a.py:f"), "--agent is for simulated robots"),
        (("--localizer", "amlc"), "There are: amcl, odometry, slam, tf"),
        (("--robot", "nova"), "nova_carter"),
        (("--localizer", "slam"), "leave warehouse out"),
        (("--start", "0,0,0", "--save-map", "made.yaml"), "--save-map is for a map that is made"),
        (("--start", "0,0,0", "--speed", "2"), "--speed is for --bag"),
        (("--bag", "nowhere.mcap"), "nowhere.mcap"),
        (("--bag", "nowhere.mcap", "--goal", "1,1"), "--goal is for a robot that drives"),
        (("--bag", "nowhere.mcap", "--localizer", "tf"), "with --bag give amcl, slam or odometry"),
    ],
)
def test_what_cannot_be_used_is_refused(trundle: Trundle, given: tuple[str, ...], message: str) -> None:
    ended = trundle(*NAVIGATE, *given)
    assert ended.code == 2
    assert message in ended.err


def test_the_help_has_what_a_robot_that_is_not_simulated_takes(trundle: Trundle) -> None:
    text = " ".join(trundle("ros2", "navigate", "--help").out.replace("│", " ").split())
    assert "it waits for a pose on /initialpose" in text
    assert "it waits for goals, until Ctrl-C" in text
    assert "by seed" not in text
    for option in (
        "--backend",
        "--lidar ",
        "--lidar-errors",
        "--odometry ",
        "--map-errors",
        "--start-error",
        "--agent",
    ):
        assert option not in text
    assert "--planner" in text


def test_more_goals_than_a_drive_takes_are_refused(trundle: Trundle, monkeypatch: pytest.MonkeyPatch) -> None:
    # The parser of the command line takes seconds for a thousand options of one name.
    monkeypatch.setattr(goal_directives, "MOST_GOALS", 20)
    ended = trundle(*NAVIGATE, "--start", "0,0,0", *("--goal", "1,1") * 21)
    assert ended.code == 2
    assert "--goal is given 21 times; a drive takes at most 20 goals" in ended.err


def test_without_a_map_the_localizer_has_to_make_one(trundle: Trundle) -> None:
    ended = trundle("ros2", "navigate", *NETWORK)
    assert ended.code == 2
    assert "--localizer slam makes it as it drives" in ended.err


def test_a_recording_is_played_to_a_summary_and_a_map(trundle: Trundle, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", Drive(seconds=6.0, beams=120))
    ended = trundle(
        *("ros2", "navigate", *NETWORK, "--localizer", "slam", "--bag", str(bag), "--json"),
        *("--save-map", str(tmp_path / "made.yaml")),
    )
    assert ended.code == 0, ended.err
    offered, summary = (json.loads(line) for line in ended.out.splitlines())
    assert offered["bag"] == str(bag)
    assert (summary["message"], summary["scans"], summary["damage"]) == ("the recording has ended", 30, None)
    assert summary["states_s"]["localized"] > 5.0
    assert (OccupancyGrid.load(tmp_path / "made.yaml").data == 100).sum() > 100
