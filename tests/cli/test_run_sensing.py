"""`trundle run` of a robot that senses: without a map, with a localizer, and with wrong settings of both."""

import json
from pathlib import Path

import numpy as np
import pytest

from trundle.mission import Scenario

QUICK = ("--backend", "kinematic", "--no-video")


def test_a_robot_drives_without_a_map_by_lidar_and_odometry(trundle, tmp_path):
    sensing = ("--lidar", "--no-map", "--localizer", "odometry", "--no-collision-monitor")
    course = ("cylinders", "--set", "length=3", "--set", "density=0.02", "--start", "-1,0,0", "--goal", "4,0")
    trundle("run", *course, *sensing, "--backend", "kinematic", "--time-limit", "2", "--no-video", "-o", str(tmp_path))
    scenario = Scenario.load(tmp_path)
    assert (scenario.lidar, scenario.known_map, scenario.collision_monitor) == (True, False, False)
    assert scenario.localizer.name == "odometry"
    record = json.loads((tmp_path / "episode.json").read_text())
    assert record["monitor_stops"] is None


def test_no_map_needs_lidars(trundle):
    done = trundle("run", "maze", "--no-map")
    assert done.code == 2
    assert "needs lidars: give lidar: true" in done.err


@pytest.mark.slow
def test_settings_of_sensing_are_given_as_pairs(trundle, tmp_path):
    pairs = ("--latency", "scan_age_s=0.1", "--latency", "command_delay_s=0.05", "--odometry", "heading=1deg")
    pairs += (
        "--layers",
        "clear_static=true",
        "--layers",
        "width=12",
        "--monitor",
        "time_before_collision=1.5",
        "--localizer",
        "odometry",
    )
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    done = trundle("scenario", "maze", "--lidar", *pairs, "-o", str(first))
    assert done.code == 0, done.err
    scenario = Scenario.load(first)
    assert scenario.latency.model_dump() == {"scan_age_s": 0.1, "command_delay_s": 0.05}
    assert scenario.odometry.heading == pytest.approx(np.deg2rad(1.0))
    assert (scenario.layers.obstacle.clear_static, scenario.layers.width) == (True, 12.0)
    assert scenario.collision_monitor.time_before_collision == 1.5
    done = trundle("scenario", str(first), "--latency", "scan_age_s=0.2", "-o", str(second))
    assert done.code == 0, done.err
    again = Scenario.load(second)
    assert again.latency.model_dump() == {"scan_age_s": 0.2, "command_delay_s": 0.05}
    assert again.layers == scenario.layers


@pytest.mark.slow
def test_what_a_localizer_has_to_bear_is_given_as_pairs_and_repeated_by_the_scenario_that_is_written(trundle):
    pairs = ("--odometry", "scale=0.05", "--odometry", "slips=6", "--lidar-errors", "noise=0.02")
    pairs += ("--lidar-errors", "dropouts=0.1", "--map-errors", "missing=0.25", "--map-errors", "ghosts=3")
    pairs += ("--localizer", "odometry", "--start-error", "distance=0.5", "--start-error", "heading=10deg")
    done = trundle("run", "office", "--lidar", *pairs, *QUICK, "--time-limit", "5", "--seed", "3", "--json", "-o", "a")
    assert done.code in (0, 1), done.err
    scenario = Scenario.load("a")
    assert scenario.odometry.slips.count == 6
    assert scenario.lidar_errors.model_dump() == {"noise": 0.02, "dropouts": 0.1, "short_returns": 0.0}
    assert (scenario.map_errors.missing, scenario.map_errors.ghosts) == (0.25, (3, 3))
    assert scenario.start_error.heading == pytest.approx(np.deg2rad(10.0))
    assert done.json["localization_error_m"] > 0.3
    trundle("run", "a/scenario.yaml", "--no-video", "-o", "b")
    with np.load("a/trajectory.npz") as first, np.load("b/trajectory.npz") as again:
        for name in first.files:
            np.testing.assert_array_equal(first[name], again[name])


def test_an_unknown_start_is_refused_for_a_localizer_that_needs_one(trundle):
    done = trundle("run", "maze", "--localizer", "odometry", "--start-error", "unknown=true", "--no-video", "-o", "a")
    assert done.code == 2
    assert "needs a start" in done.err
    assert not Path("a").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--latency", "scan_age=0.1"), "scan_age_s"),
        (("--latency", "scan_age_s"), "give KEY=VALUE, for example --latency scan_age_s=0.1"),
        (("--latency", "scan_age_s=9"), "scan_age_s"),
        (("--odometry", "slip=1"), "slip"),
        (("--odometry", "slips=-1"), "odometry.slips: -1 is out of range"),
        (("--lidar-errors", "dropouts"), "give KEY=VALUE, for example --lidar-errors dropouts=0.01"),
        (("--lidar-errors", "droputs=0.1"), "dropouts"),
        (("--map-errors", "missing=2"), "map_errors.missing"),
        (("--start-error", "distance=1"), "give a localizer"),
        (("--localizer", "odometry", "--start-error", "distance=1", "--start-error", "unknown=true"), "give either"),
        (("--monitor", "min_points=4", "--no-collision-monitor"), "not both"),
    ],
)
def test_wrong_settings_of_sensing_are_reported(trundle, options, said):
    done = trundle("run", "maze", "--lidar", *options)
    assert done.code == 2
    assert said in done.err


def test_a_map_for_no_episode_is_refused(trundle):
    done = trundle("run", "office", "--map", "map.yaml")
    assert done.code == 2
    assert "--map goes with --from" in done.err
