"""Tests of `trundle export --to nav2`."""

from pathlib import Path

from support.command_line import Trundle
from trundle.mission import Scenario
from trundle.nav2 import read_nav2_params

NAV2 = Path(__file__).parents[1] / "nav2" / "data" / "jazzy.yaml"


def test_a_map_with_a_robot_becomes_a_folder_that_says_what_was_left_out(trundle: Trundle, room_map: Path) -> None:
    done = trundle("export", room_map, "--robot", "jackal", "--to", "nav2", "-o", "out", "--json")
    assert done.code == 0, done.err
    assert (done.json["robot"], done.json["folder"]) == ("jackal", "out")
    assert done.json["files"] == ["nav2_params.yaml", "map.yaml", "nav2.launch.py", "no_counterpart.txt"]
    assert all((Path("out") / name).is_file() for name in done.json["files"])
    names = [remark["name"] for remark in done.json["remarks"]]
    listed = (Path("out") / "no_counterpart.txt").read_text()
    assert names
    assert all(name in done.err and name in listed for name in names)
    quiet = trundle("export", room_map, "--to", "nav2", "-o", "out", "--quiet")
    assert len(quiet.err.strip().splitlines()) == 1
    assert "no_counterpart.txt" in quiet.err


def test_the_parameters_of_a_robot_go_through_a_scenario_and_come_back(trundle: Trundle, room_map: Path) -> None:
    assert trundle("scenario", room_map, "--nav2-params", NAV2, "-o", "first.yaml").code == 0
    assert trundle("export", "first.yaml", "--to", "nav2", "--distro", "humble", "-o", "out").code == 0
    assert trundle("scenario", room_map, "--nav2-params", "out/nav2_params.yaml", "-o", "second.yaml").code == 0
    assert Scenario.load("first.yaml") == Scenario.load("second.yaml")
    assert trundle("export", room_map, "--nav2-params", NAV2, "--to", "nav2", "-o", "direct").code == 0
    first, direct = (read_nav2_params(f"{name}/nav2_params.yaml", "nova_carter") for name in ("out", "direct"))
    assert first.settings == direct.settings


def test_a_run_can_be_driven_with_its_own_export(trundle: Trundle, room_map: Path) -> None:
    assert trundle("export", room_map, "--robot", "turtlebot3_waffle", "--to", "nav2", "-o", "out").code == 0
    ends = ("--start", "0.5,0.5", "--goal", "2.5,1.5", "--robot", "turtlebot3_waffle", "--backend", "kinematic")
    given = ("--nav2-params", "out/nav2_params.yaml", "--no-video", "--no-report", "--json")
    done = trundle("run", "out/map.yaml", *given, *ends)
    assert done.code == 0, done.err
    assert done.json["outcome"] == "arrived"


def test_options_of_other_formats_are_refused(trundle: Trundle, room_map: Path) -> None:
    for arguments, text in (
        (("--to", "nav2", "--resolution", "0.1"), "--resolution is for a world --to map"),
        (("--to", "nav2", "-o", "out.yaml"), "give a folder"),
        (("--to", "map", "--distro", "jazzy"), "--distro and --nav2-params are for --to nav2"),
        (("--to", "nav"), "Did you mean 'nav2'"),
    ):
        done = trundle("export", room_map, *arguments)
        assert done.code == 2
        assert text in done.err
    robot = trundle("export", "nova_carter", "--to", "nav2")
    assert robot.code == 2
    assert "give it with --robot nova_carter" in robot.err
