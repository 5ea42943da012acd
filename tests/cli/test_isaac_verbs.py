"""The steps with `--backend isaac`, on the stand-in: view, joints, drive, run, and the map of an environment."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from support.command_line import room
from trundle.mission import Scenario

TESTS = Path(__file__).parents[1]
HALL = ("--backend", "isaac", "--environment", "warehouse", "--headless")


@pytest.fixture
def hall_map(trundle, assets, tmp_path):
    """The map of the environment, made of its USD where its file is at hand."""
    done = trundle("map", "build", "warehouse", "--assets-root", assets, "-o", tmp_path / "hall" / "map.yaml", "--json")
    assert done.code == 0, done.err
    return Path(done.json["map"])


def test_the_map_of_an_environment_is_its_worlds(trundle, assets, hall_map):
    file = assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd"
    assert trundle("map", "build", file, "-o", "map.yaml").code == 0
    assert Path("map.png").read_bytes() == hall_map.with_suffix(".png").read_bytes()


def test_view_writes_a_picture_by_isaac_sims_renderer(trundle, fake):
    done = trundle("view", "nova_carter", *HALL, "--start", "-2.5,0", "--size", "64x48", "-o", "scene.png", "--json")
    assert done.code == 0, done.err
    assert done.json["renderer"] == "Isaac Sim"
    with Image.open("scene.png") as picture:
        assert picture.size == (64, 48)
    assert fake.app_closes == 1


def test_view_shows_isaac_sims_window_until_it_is_closed(trundle, fake):
    def close_window(drawing):
        fake.window_open = drawing < 40

    fake.on_draw = close_window
    done = trundle("view", "nova_carter", "--backend", "isaac", "--environment", "warehouse", "--start", "-2.5,0")
    assert done.code == 0, done.err
    assert fake.draws == 40
    assert fake.app_closes == 1


def test_joints_lists_what_isaac_sim_moves(trundle, fake):
    done = trundle("joints", "nova_carter", "--backend", "isaac", "--headless", "--json")
    assert done.code == 0, done.err
    assert [joint["name"] for joint in done.json if joint["drives"]] == ["joint_wheel_left", "joint_wheel_right"]
    assert len(done.json) > 2
    assert "joint_wheel_left" in trundle("joints", "nova_carter").out


def test_drive_ends_where_the_commands_lead(trundle, fake):
    done = trundle(
        "drive", "nova_carter", *HALL, "--start", "-3,1.8", "--command", "0.4,0,2", "--json", "--physics-dt", "0.01"
    )
    assert done.code == 0, done.err
    assert done.json[0]["x"] == pytest.approx(-3.0 + 0.4 * (2.0 - 0.08), abs=0.02)
    assert fake.dt == 0.01
    assert (Path(done.json[0]["run_dir"]) / "drive.csv").is_file()
    assert fake.app_closes == 1


def test_plan_takes_the_backend_and_starts_nothing(trundle, fake, hall_map):
    done = trundle("plan", hall_map, "--backend", "isaac", "--start", "-2.5,-1", "--goal", "2,1.5", "--json")
    assert done.code == 0, done.err
    assert done.json["length_m"] > 4.5
    assert fake.app_starts == 0
    assert "unknown backend 'isac'" in trundle("plan", hall_map, "--backend", "isac").err


def test_run_drives_on_the_environments_map_and_leaves_a_scenario_that_repeats_it(
    trundle,
    make_fake,
    hall_map,
    tmp_path,
):
    first = make_fake(6)
    done = trundle(
        "run", hall_map, *HALL, "--start", "-2.5,-1,0", "--goal", "2,1.5", "--out", "run", "--no-video", "--json"
    )
    assert done.code == 0, done.err
    assert done.json["outcome"] == "arrived"
    names = {path.name for path in Path("run").iterdir()}
    assert {"episode.json", "trajectory.npz", "scenario.yaml", "overlay.png"} <= names
    backend = Scenario.load("run/scenario.yaml").backend
    assert backend.name == "isaac"
    assert backend.options == {"environment": "warehouse", "headless": True}
    assert first.app_closes == 1
    first.uninstall()
    second = make_fake(5)
    again = trundle("run", "run/scenario.yaml", "--out", "again", "--no-video", "--json")
    assert again.code == 0, again.err
    assert again.json["distance_m"] == pytest.approx(done.json["distance_m"], abs=1e-3)
    assert second.stage_path == first.stage_path


@pytest.mark.slow
def test_the_same_scenario_runs_in_the_kinematic_simulator_and_in_isaac_sim(trundle, fake, room_map, tmp_path):
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(f"map: {room_map}\nstart: [0, 0, 0]\ngoal: [5, 2, 0]\n")
    ends = []
    for backend in (("--backend", "kinematic"), ("--backend", "isaac", "--headless")):
        done = trundle("run", scenario, *backend, "--no-video", "--json")
        assert done.code == 0, done.err
        ends.append(done.json["distance_m"])
    assert ends[0] == pytest.approx(ends[1], abs=0.02)


@pytest.mark.slow
def test_the_command_that_the_guides_start_with_drives(trundle, fake):
    done = trundle("run", "warehouse", "--seed", "7", "--headless", "--backend", "isaac", "--no-video", "--json")
    assert done.code == 0, done.err
    assert done.json["outcome"] == "arrived"


@pytest.mark.slow
def test_a_world_of_usd_is_opened_as_it_is(trundle, fake, assets):
    file = assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd"
    done = trundle(
        "run", file, "--backend", "isaac", "--headless", "--start", "-2.5,-1", "--goal", "2,1.5", "--no-video", "--json"
    )
    assert done.code == 0, done.err
    assert fake.stage_path == str(file)


@pytest.mark.slow
def test_an_environment_is_a_world_where_its_file_is_at_hand(trundle, fake, assets, tmp_path):
    scenes = tmp_path / "assets" / "Isaac" / "Environments" / "Simple_Warehouse"
    shutil.copytree(assets, tmp_path / "assets")
    shutil.copy(scenes / "warehouse.usd", scenes / "full_warehouse.usd")
    ends = ("--backend", "isaac", "--headless", "--start", "-2.5,-1", "--goal", "2,1.5", "--no-video", "--json")
    done = trundle("run", "full_warehouse", *ends, "--assets-root", tmp_path / "assets")
    assert done.code == 0, done.err
    assert fake.stage_path == str(scenes / "full_warehouse.usd")
    done = trundle("run", "full_warehouse", *ends)
    assert done.code == 2
    assert "trundle run map.yaml --backend isaac --environment full_warehouse" in done.err


def test_ctrl_c_leaves_the_runs_folder_and_closes_isaac_sim(trundle, fake, hall_map):
    def interrupt(step):
        if step == 800:
            signal.raise_signal(signal.SIGINT)

    fake.on_step = interrupt
    done = trundle("run", hall_map, *HALL, "--start", "-2.5,-1", "--goal", "2,1.5", "--out", "run", "--no-video")
    assert done.code == 1
    assert json.loads(Path("run/episode.json").read_text())["outcome"] == "aborted"
    assert "Ctrl-C" in done.out
    assert fake.app_closes == 1


def test_a_closed_window_leaves_the_runs_folder(trundle, fake, hall_map):
    def close_window(drawing):
        fake.window_open = drawing < 60

    fake.on_draw = close_window
    done = trundle(
        "run", hall_map, *HALL[:-1], "--start", "-2.5,-1", "--goal", "2,1.5", "--out", "run", "--no-video", "--json"
    )
    assert done.code == 1
    assert done.json["outcome"] == "aborted"
    assert "Isaac Sim was closed" in done.json["message"]
    assert fake.app_closes == 1


def test_a_drive_that_is_stopped_by_ctrl_c_keeps_its_record(trundle, fake):
    def interrupt(step):
        if step == 400:
            signal.raise_signal(signal.SIGINT)

    fake.on_step = interrupt
    done = trundle("drive", "nova_carter", *HALL, "--start", "-3,1.8", "--command", "0.2,0,10", "--out", "drive")
    assert done.code == 130
    assert len(Path("drive/drive.csv").read_text().splitlines()) > 10
    assert fake.app_closes == 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--headless",), "--headless is for --backend isaac, but the backend is mujoco"),
        (("--physics-dt", "0.01", "--backend", "kinematic"), "--physics-dt is for --backend isaac or physx"),
        (("--backend", "isaac", "--environment", "warehuose"), "Did you mean 'warehouse'"),
        (("--backend", "isaac", "--view"), "Isaac Sim has its own"),
        (("--backend", "isaac", "--assets-root", "nowhere"), "there is no such folder"),
    ],
)
def test_bad_input_is_reported_before_isaac_sim_starts(trundle, fake, room_map, arguments, says):
    done = trundle("run", room_map, "--start", "0,0", "--goal", "3,1", "--no-video", *arguments)
    assert done.code == 2
    assert says in done.err
    assert fake.app_starts == 0
    assert not Path("runs").exists() or not list(Path("runs").iterdir())


def test_a_world_and_an_environment_that_look_different_are_refused(trundle, fake):
    done = trundle("run", "warehouse", *HALL)
    assert done.code == 2
    assert "conflict. Give the environment's map" in done.err
    done = trundle("drive", "nova_carter", "--world", "office", *HALL, "--command", "0.1,0,1")
    assert done.code == 2
    assert "conflict. Give the environment's map" in done.err


def test_without_isaac_sim_the_message_says_how_to_start(trundle, room_map, monkeypatch):
    monkeypatch.delenv("ISAAC_PATH", raising=False)
    done = trundle("run", room_map, "--backend", "isaac", "--start", "0,0", "--goal", "3,1")
    assert done.code == 2
    assert "python.sh -m trundle" in done.err


@pytest.mark.slow
@pytest.mark.parametrize("generation", [5, 6])
@pytest.mark.parametrize("kind", ["map", "usd"])
def test_a_run_needs_neither_mujoco_nor_viser_nor_usd_core(assets, tmp_path, generation, kind):
    if kind == "map":
        room().save(tmp_path / "room.yaml")
        source = (tmp_path / "room.yaml", "--start", "0,0,0", "--goal", "5,2")
    else:
        file = assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd"
        source = (file, "--start", "-2.5,-1", "--goal", "2,1.5")
    # Without PyAV the video is a GIF, which takes its time: once is enough.
    with_video = (kind, generation) == ("map", 5)
    video = () if with_video else ("--no-video",)
    options = ("--backend", "isaac", "--headless", "--out", "run", "--json", *video)
    done = subprocess.run(
        [sys.executable, "-m", "support.fake_isaac", str(generation), assets, "-", "run", *source, *options],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(TESTS)},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["outcome"] == "arrived"
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"episode.json", "trajectory.npz", "scenario.yaml", "overlay.png"} <= names
    assert ("video.gif" in names) is with_video
