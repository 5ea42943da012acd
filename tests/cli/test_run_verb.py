"""`trundle run`: what a command leaves and prints, and what it refuses."""

import json
import os
import re
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml

from support.command_line import Trundle, room, stopped
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit

ENDS = ("--start", "0.5,0.5,1.57", "--goal", "5.5,1.5,0")
SHORT = ("--start", "0.5,0.5", "--goal", "0.9,0.5", "--robot", "turtlebot3_burger")
QUICK = ("--backend", "kinematic", "--no-video")
KEYS = {
    "outcome",
    "time_s",
    "distance_m",
    "path_length_m",
    "min_clearance_m",
    "planning_ms",
    "real_time_factor",
    "contacts",
    "run_dir",
}


def test_a_run_arrives_and_leaves_its_folder(trundle: Trundle, room_map: Path) -> None:
    done = trundle("run", room_map, "--robot", "nova_carter", *ENDS, "--no-video", "--json", "--out", "a")
    assert done.code == 0, done.err
    assert set(done.json) >= KEYS
    assert (done.json["outcome"], done.json["run_dir"], done.json["contacts"]) == ("arrived", "a", [])
    assert done.json["distance_m"] == pytest.approx(done.json["path_length_m"], rel=0.1)
    assert done.json["min_clearance_m"] > 0.0
    folder = Path("a")
    assert {path.name for path in folder.iterdir()} == {
        "episode.json",
        "trajectory.npz",
        "paths.npz",
        "scenario.yaml",
        "report.html",
        "overlay.png",
    }
    assert json.loads((folder / "episode.json").read_text()) | {"files": done.json["files"]} == done.json
    with np.load(folder / "trajectory.npz") as trajectory:
        assert (trajectory["x"][-1], trajectory["y"][-1]) == pytest.approx((5.5, 1.5), abs=0.25)


def test_the_scenario_that_was_written_repeats_the_run(trundle: Trundle, room_map: Path) -> None:
    first = trundle("run", room_map, "--seed", 4, *QUICK, "--json", "--out", "a").json
    again = trundle("run", "a/scenario.yaml", "--no-video", "--json", "--out", "b").json
    changing = {"run_dir", "planning_ms", "real_time_factor", "written"}
    assert {key: value for key, value in first.items() if key not in changing} == {
        key: value for key, value in again.items() if key not in changing
    }
    assert Path("a/trajectory.npz").read_bytes() == Path("b/trajectory.npz").read_bytes()


def test_the_table_says_how_it_went(trundle: Trundle, room_map: Path) -> None:
    done = trundle("run", room_map, *ENDS, *QUICK)
    assert done.code == 0, done.err
    lines = dict(re.split(r"\s{2,}", line, maxsplit=1) for line in done.out.splitlines())
    assert lines["outcome"] == "arrived"
    assert {"time", "distance", "smallest clearance", "planning time", "real-time factor"} <= set(lines)
    assert (Path(lines["folder"]) / "episode.json").is_file()


def test_the_table_says_why_there_was_no_progress(
    trundle: Trundle, room_map: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "periods without progress" not in trundle("run", room_map, *ENDS, *QUICK).out
    monkeypatch.setattr(RegulatedPurePursuit, "reason", "blocked by a mover", raising=False)
    done = trundle("run", room_map, *ENDS, *QUICK)
    assert re.search(r"^periods without progress  +blocked by a mover \d+$", done.out, re.MULTILINE), done.out


def test_several_goals_and_a_robot_of_your_own(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    robot = Path(__file__).parents[1] / "plugin_package" / "trundle_example_plugin" / "mini_cart.yaml"
    goals = ("--goal", "3,2", "--goal", "-0.5,-.5,3.14", "--goal", "5,0")
    done = trundle("run", room_map, "--robot", robot, "--start", "0,0", *goals, *QUICK, "--json")
    assert done.code == 0, done.err
    assert done.json["goals"] == [[3.0, 2.0], [-0.5, -0.5, 3.14], [5.0, 0.0]]
    assert done.json["goals_reached"] == 3


def test_options_change_a_scenario(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    scenario = {"map": "maps/room.yaml", "robot": "nova_carter", "start": [0.5, 0.5], "goals": [[1, 1], [2, 2]]}
    (tmp_path / "scenario.yaml").write_text(yaml.safe_dump(scenario))
    done = trundle("run", "scenario.yaml", "--goal", "5,1", "--robot", "turtlebot3_burger", *QUICK, "--json")
    assert done.code == 0, done.err
    assert (done.json["goals"], done.json["robot"]) == ([[5.0, 1.0]], "turtlebot3_burger")


def test_a_video_is_written_by_default(trundle: Trundle, room_map: Path) -> None:
    done = trundle("run", room_map, *SHORT, "--json")
    assert done.code == 0, done.err
    assert (Path(done.json["run_dir"]) / "video.mp4").stat().st_size > 1000


def test_without_opengl_the_video_is_drawn_and_the_packages_are_named(
    trundle: Trundle, room_map: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trundle.viewer.gl.find_gl", lambda: None)
    done = trundle("run", room_map, *SHORT, "--json")
    assert done.code == 0, done.err
    assert (Path(done.json["run_dir"]) / "video.mp4").stat().st_size > 1000
    assert "The video is drawn from above." in done.err
    assert "libegl1" in done.err
    assert trundle("run", room_map, *SHORT, "--quiet").err == ""


def test_a_planning_deadline_is_an_outcome(trundle: Trundle, room_map: Path) -> None:
    done = trundle("run", room_map, *ENDS, *QUICK, "--planning-deadline", "1e-9", "--json", "--out", "a")
    assert done.code == 1
    assert done.json["outcome"] == "planning_timed_out"
    assert "planning_deadline_s: 1.0e-09" in Path("a/scenario.yaml").read_text()


def test_a_time_limit_is_an_outcome(trundle: Trundle, room_map: Path) -> None:
    done = trundle("run", room_map, *ENDS, *QUICK, "--time-limit", "1", "--json")
    assert done.code == 1
    assert done.json["outcome"] == "timed_out"
    assert (Path(done.json["run_dir"]) / "overlay.png").is_file()


@pytest.mark.parametrize("door_m", [0.0, pytest.param(0.4, marks=pytest.mark.slow)])
def test_a_goal_that_cannot_be_reached_is_an_outcome(trundle: Trundle, tmp_path: Path, door_m: float) -> None:
    """Behind a wall, or behind a door that the robot is too wide for."""
    room(door_m=door_m).save(tmp_path / "door.yaml")
    done = trundle("run", "door.yaml", "--start", "0.5,0.5", "--goal", "5.5,0.5", *QUICK)
    assert done.code == 1
    assert done.out.startswith("outcome             no_path: ")


def test_a_map_becomes_a_world_as_its_options_say(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    options = ("--set", "height=0.3", "--set", "unknown=free")
    first = trundle("run", room_map, *options, *SHORT, *QUICK, "-o", "first", "--json")
    assert first.code == 0, first.err
    assert "map_options: {height: 0.3, unknown: free}" in (tmp_path / "first" / "scenario.yaml").read_text()
    again = trundle("run", "first/scenario.yaml", "--no-video", "-o", "again", "--json")
    assert again.json["time_s"] == first.json["time_s"]


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("hieght=0.3", "did you mean 'height'?"),
        ("height=0", "map_options.height"),
        ("unknown=wall", "There are: solid, free"),
    ],
)
def test_options_that_a_map_does_not_take(trundle: Trundle, room_map: Path, option: str, words: str) -> None:
    done = trundle("run", room_map, "--set", option, "--no-video")
    assert done.code == 2
    assert words in done.err


def test_a_seed_among_the_settings_is_the_worlds(trundle: Trundle, tmp_path: Path) -> None:
    images = []
    for name, options in (("a", ("--seed", 4)), ("b", ("--set", "seed=4")), ("c", ("--seed", 5))):
        assert trundle("map", "build", "maze", *options, "-o", f"{name}.yaml").code == 0
        images.append((tmp_path / f"{name}.png").read_bytes())
    assert images[0] == images[1] != images[2]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("warehose",), "Did you mean 'warehouse'?"),
        (("none.yaml",), "none.yaml: no such file"),
        (("warehouse", "--set", "isle=2"), "isle"),
        (("warehouse", "--robot", "nova_cartr"), "Did you mean 'nova_carter'?"),
        (("warehouse", "--planner", "lest_cost"), "Did you mean 'least_cost'?"),
        (("warehouse", "--controller", "lookahed"), "Did you mean 'lookahead'?"),
        (("warehouse", "--backend", "kinematics"), "Did you mean 'kinematic'?"),
        (("warehouse", "--seed", "-1"), "seed"),
        (("warehouse", "--start", "1,a"), "X,Y or X,Y,YAW"),
        (("warehouse", "--goal", "900,900", "--start", "0,0", "--backend", "kinematic"), "outside"),
        (("warehouse", "--time-limit", "-3"), "time_limit_s"),
        (("warehouse", "--time-limit", "nan"), "time_limit_s"),
        (("warehouse", "--planning-deadline", "0"), "--planning-deadline '0' is out of range"),
    ],
)
def test_bad_input_leaves_nothing(trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("run", *arguments, "--no-video")
    assert done.code == 2
    assert words in done.err
    assert "Traceback" not in done.err
    assert done.out == ""
    assert [path for path in tmp_path.rglob("*") if path.name != "runs"] == []


def test_a_start_inside_a_rack(trundle: Trundle, tmp_path: Path) -> None:
    from trundle.worlds import World

    rack = next(solid for solid in World.generate("warehouse", seed=0).solids if solid.kind == "rack")
    x, y, _ = rack.pose.position
    done = trundle("run", "warehouse", "--start", f"{x},{y}", "--goal", "0,0", *QUICK)
    assert done.code == 2
    assert "start" in done.err
    assert " m away" in done.err or "nearest" in done.err
    assert [path for path in tmp_path.rglob("*") if path.name != "runs"] == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the file is empty"),
        ("map: a.yaml\nworld: warehouse\n", "give either world or map"),
        ("world: warehouse\nrobt: nova_carter\n", "scenario.yaml:2:1: robt"),
        ("world: warehouse\nseed: lots\n", "scenario.yaml:2:7: seed"),
        ("world: warehouse\nstart: [.nan, 0]\n", "scenario.yaml:2:9: start"),
        ("world: warehouse\nstart: &a [0, 0]\ngoal: *a\n", "anchors and aliases"),
        ("world: warehouse\nworld: warehouse\n", "given twice"),
        ("[1, 2", "not valid YAML"),
    ],
)
def test_a_scenario_that_cannot_be_used(trundle: Trundle, tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "scenario.yaml").write_text(text)
    done = trundle("run", "scenario.yaml")
    assert done.code == 2
    assert words in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["scenario.yaml"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("wheel_radius: 0.05", "wheel_radius: -1", "cart.yaml:2:23: drive.wheel_radius"),
        ("track_width: 0.24", "track_with: 0.24", "drive.track_with"),
        ("mass: 4.0", "mass: .nan", "body.mass"),
        ("[[0.15, 0.15]", "[[0.0, 0.0]", "convex"),
        ("casters", "castors", "castors"),
    ],
)
def test_a_robot_that_cannot_be_used(
    trundle: Trundle, room_map: Path, tmp_path: Path, old: str, new: str, words: str
) -> None:
    text = (Path(__file__).parents[1] / "plugin_package" / "trundle_example_plugin" / "mini_cart.yaml").read_text()
    assert old in text
    (tmp_path / "cart.yaml").write_text(text.replace(old, new))
    done = trundle("run", room_map, "--robot", "cart.yaml")
    assert done.code == 2
    assert words in done.err
    assert not (tmp_path / "runs").exists()


def test_a_folder_that_holds_a_run_is_refused_before_anything_drives(
    trundle: Trundle, room_map: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert trundle("run", room_map, *SHORT, *QUICK, "-o", "a").code == 0
    before = {path.name: path.read_bytes() for path in Path("a").iterdir()}
    drive = ("drive", "nova_carter", "--command", "0.4,0,1", "--backend", "kinematic")
    with monkeypatch.context() as patch:
        patch.setattr("trundle.sim.simulator.SIMULATORS.make", lambda *_, **__: pytest.fail("it drives"))
        for verb in (("run", room_map, *SHORT, *QUICK), ("demo", *QUICK), drive):
            done = trundle(*verb, "-o", "a")
            assert done.code == 2
            assert "a already holds a run" in done.err
            assert "--overwrite" in done.err
            assert done.err.count("\n") == 1
            assert {path.name: path.read_bytes() for path in Path("a").iterdir()} == before
    done = trundle("run", room_map, *ENDS, "--robot", "turtlebot3_burger", *QUICK, "--json", "-o", "a", "--overwrite")
    assert done.code == 0, done.err
    assert {path.name for path in Path("a").iterdir()} == set(before)
    assert json.loads(Path("a/episode.json").read_text())["distance_m"] == done.json["distance_m"] > 4.0
    assert trundle(*drive, "-o", "a", "--overwrite").code == 0
    assert [path.name for path in Path("a").iterdir()] == ["drive.csv"]


def test_two_runs_into_one_folder(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    from trundle.record.folder_claim import FolderClaim

    with FolderClaim(tmp_path / "a", "run"):
        done = trundle("run", room_map, *SHORT, *QUICK, "-o", "a")
        assert done.code == 2
        assert f"another run (process {os.getpid()})" in done.err
        assert "-o" in done.err
    assert trundle("run", room_map, *SHORT, *QUICK, "-o", "a").code == 0


def test_an_output_folder_that_is_a_file(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    done = trundle("run", room_map, *ENDS, *QUICK, "--out", "file")
    assert done.code == 2
    assert "cannot write to the folder file" in done.err
    assert done.err.count("\n") == 1
    assert "-o" in done.err
    assert (tmp_path / "file").read_text() == "mine"


def test_an_output_folder_that_is_read_only(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o555)
    # Root may write to every folder but those of the kernel.
    folder = Path("/proc/trundle") if os.geteuid() == 0 else locked / "here"
    done = trundle("run", room_map, *ENDS, *QUICK, "--out", folder)
    assert done.code == 2
    assert f"cannot write to the folder {folder}: " in done.err
    assert "-o" in done.err
    assert done.err.count("\n") == 1
    assert done.out == ""
    assert list(locked.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_run_that_is_stopped(room_map: Path, tmp_path: Path, number: signal.Signals) -> None:
    """Ctrl-C gives an aborted run with its files; a kill leaves no half file."""
    there_and_back = ("--start=0.5,0.5", "--goal=5.5,1.5", "--goal=0.5,0.5")
    command = stopped(number, "run", str(room_map), *there_and_back, "--json", "--no-video", "--out=out")
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    if number == signal.SIGKILL:
        assert names == {".lock"}
        return
    assert done.returncode == 1, done.stderr
    assert json.loads(done.stdout)["outcome"] == "aborted"
    assert "Traceback" not in done.stderr
    assert names == {"episode.json", "trajectory.npz", "paths.npz", "scenario.yaml", "report.html", "overlay.png"}
