"""`trundle explore`: the files that it writes, what it prints, and its exit codes."""

from pathlib import Path

import pytest

from support.command_line import Trundle
from trundle.mapping.pose_graph_file import load_pose_graph
from trundle.maps import OccupancyGrid

QUICK = ("--backend", "kinematic", "--no-video", "--no-report")


@pytest.fixture
def small_map(tmp_path: Path) -> Path:
    """A room of 6 x 4 m with a corner that cannot be seen from everywhere."""
    import numpy as np

    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:44, 58:62] = 100
    OccupancyGrid(cells, 0.05).save(tmp_path / "small.yaml")
    return tmp_path / "small.yaml"


def test_a_room_is_explored_to_the_end(trundle: Trundle, small_map: Path) -> None:
    ends = ("--start", "1.2,1.5", "--robot", "turtlebot3_burger", "--folder", "run")
    done = trundle("explore", small_map, *ends, *QUICK, "-o", "out.yaml", "--posegraph", "site.posegraph", "--json")
    assert done.code == 0, done.err
    assert done.json["finished"]
    assert (done.json["map"], done.json["posegraph"], done.json["contacts"]) == ("out.yaml", "site.posegraph", [])
    assert done.json["open_frontiers"] == []
    grid = OccupancyGrid.load("out.yaml")
    assert (grid.data == 0).sum() * 0.05**2 == pytest.approx(22.6, rel=0.1)
    assert len(load_pose_graph("site.posegraph").poses) > 3
    assert Path("run/own_map_overlay.png").is_file()


def test_the_time_limit_leaves_the_map_so_far_and_says_what_was_left(trundle: Trundle, small_map: Path) -> None:
    ends = ("--start", "1.2,1.5", "--robot", "turtlebot3_burger", "--time-limit", "2")
    done = trundle("explore", small_map, *ends, *QUICK, "-o", "out.yaml")
    assert done.code == 1
    assert "timed_out: not finished within 2.0 s" in done.out
    assert "left to see" in done.out
    assert OccupancyGrid.load("out.yaml").shape[0] > 10


@pytest.mark.parametrize("option", [("--lidar-errors", "dropouts=0.01"), ("--start-error", "distance=0.3")])
def test_options_of_what_it_has_by_itself_are_taken(trundle: Trundle, small_map: Path, option: tuple[str, str]) -> None:
    ends = ("--start", "1.2,1.5", "--robot", "turtlebot3_burger", "--time-limit", "1")
    done = trundle("explore", small_map, *ends, *option, *QUICK, "-o", "out.yaml")
    assert done.code == 1
    assert "timed_out" in done.out


def test_amcl_of_nav2s_parameters_does_not_take_the_place_of_slam(trundle: Trundle, small_map: Path) -> None:
    Path("nav2.yaml").write_text(
        "amcl:\n  ros__parameters: {max_particles: 3000}\n"
        "global_costmap:\n  global_costmap:\n    ros__parameters:\n      plugins: [static_layer, obstacle_layer]\n"
        "      static_layer: {plugin: 'nav2_costmap_2d::StaticLayer'}\n"
        "      obstacle_layer:\n        plugin: nav2_costmap_2d::ObstacleLayer\n"
        "        observation_sources: scan\n        scan: {topic: scan}\n"
    )
    ends = ("--start", "1.2,1.5", "--robot", "turtlebot3_burger", "--time-limit", "1", "--nav2-params", "nav2.yaml")
    done = trundle("explore", small_map, *ends, *QUICK, "-o", "out.yaml")
    assert done.code == 1, done.err
    assert Path("out.yaml").is_file()


def test_options_of_a_localizer_are_those_of_the_one_that_the_file_names(trundle: Trundle, small_map: Path) -> None:
    Path("own.yaml").write_text(f"map: {small_map}\nlocalizer: odometry\n")
    done = trundle("explore", "own.yaml", "--localizer-option", "wrong=2", *QUICK, "-o", "out.yaml")
    assert done.code == 2
    assert "localizer 'odometry' has no option 'wrong'" in done.err


def test_a_goal_is_refused(trundle: Trundle) -> None:
    done = trundle("explore", "maze", "--goal", "3,1")
    assert done.code == 2
    assert "an exploration has no goal" in done.err


def test_a_map_that_was_edited_is_not_replaced(trundle: Trundle, small_map: Path) -> None:
    small_map.write_text(small_map.read_text() + "# edited\n")
    done = trundle("explore", "maze", "-o", small_map)
    assert done.code == 2
    assert "may have been edited by hand" in done.err


def test_options_of_the_explorer_and_of_slam_need_no_names(trundle: Trundle, small_map: Path) -> None:
    done = trundle("explore", small_map, "--backend", "kinematic", "--agent-option", "tries=none", "--no-video")
    assert done.code == 2
    assert "tries" in done.err
    done = trundle("explore", small_map, "--backend", "kinematic", "--localizer-option", "nothing=1", "--no-video")
    assert done.code == 2
    assert "nothing" in done.err
