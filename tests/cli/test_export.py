from pathlib import Path

import numpy as np
import pytest

from support.command_line import Trundle
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World


@pytest.mark.parametrize("suffix", [".xml", ".usda", ".sdf", ".glb"])
def test_a_world_is_written_and_loads_back(trundle: Trundle, tmp_path: Path, suffix: str) -> None:
    done = trundle("export", "maze", "--seed", 3, "--set", "rows=3", "-o", f"maze{suffix}", "--json")
    assert done.code == 0, done.err
    world = World.generate("maze", seed=3, rows=3)
    assert done.json["solids"] == len(world.solids)
    assert done.json["bytes"] == (tmp_path / f"maze{suffix}").stat().st_size
    assert {solid.name for solid in World.load(tmp_path / f"maze{suffix}").solids} == {s.name for s in world.solids}


def test_the_format_names_the_file(trundle: Trundle, tmp_path: Path) -> None:
    assert trundle("export", "nova_carter", "--to", "urdf").code == 0
    assert trundle("export", "corridors", "--to", "map", "--resolution", "0.1", "--robot", "jackal").code == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert {"nova_carter.urdf", "corridors.yaml", "corridors.png"} <= names
    assert OccupancyGrid.load(tmp_path / "corridors.yaml").resolution == 0.1


def test_a_map_becomes_a_world_file(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    done = trundle("export", room_map, "--to", "sdf", "-o", "out/room.sdf")
    assert done.code == 0, done.err
    assert len(World.load(tmp_path / "out" / "room.sdf").solids) == len(World.from_map(room_map).solids)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::trundle.errors.RobotWarning")
def test_models_are_robots_or_worlds_as_the_format_asks(trundle: Trundle, tmp_path: Path) -> None:
    assert trundle("export", "jackal", "--to", "urdf").code == 0
    done = trundle("export", "jackal.urdf", "--to", "mjcf", "--json")
    assert (done.code, done.json["robot"]) == (0, "jackal"), done.err
    assert trundle("export", "jackal.xml", "-o", "again.urdf").code == 0
    assert trundle("export", "maze", "-o", "maze.xml").code == 0
    done = trundle("export", "maze.xml", "-o", "maze.sdf", "--json")
    assert (done.code, done.json["world"]) == (0, "maze"), done.err


SCENARIO = "world: {name: maze, seed: 1, options: {rows: 3}}\nrobot: jackal\nbackend: isaac\n"


def test_a_scenario_is_written_with_its_robot_at_the_start(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "trip.yaml").write_text(SCENARIO)
    done = trundle("export", "trip.yaml", "--to", "usd", "--profile", "isaac", "-o", "out/trip.usda", "--json")
    assert done.code == 0, done.err
    assert (done.json["scenario"], done.json["robot"], done.json["world"]) == ("jackal-maze", "jackal", "maze")
    assert 'def Xform "jackal"' in (tmp_path / "out" / "trip.usda").read_text()
    assert trundle("export", "trip.yaml", "--to", "mjcf").code == 0
    assert (tmp_path / "trip.xml").is_file()


def test_a_scenario_becomes_a_script_for_isaac_sim(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "trip.yaml").write_text(SCENARIO)
    done = trundle("export", "trip.yaml", "--to", "isaac-script", "--environment", "hospital", "--json")
    assert done.code == 0, done.err
    assert {path.name for path in tmp_path.iterdir()} == {"trip.yaml", "trip.py", "trip_robot.usd"}
    compile((tmp_path / "trip.py").read_text(), "trip.py", "exec")


def test_a_script_has_the_limits_of_the_scenarios_speed_mask(trundle: Trundle, tmp_path: Path) -> None:
    mask = OccupancyGrid(np.full((80, 80), 30, dtype=np.int8), 1.0, Pose2D(-40.0, -40.0))
    mask.save(tmp_path / "slow.yaml", mode="raw")
    (tmp_path / "trip.yaml").write_text(SCENARIO + "speed_mask: slow.yaml\n")
    done = trundle("export", "trip.yaml", "--to", "isaac-script", "--environment", "hospital")
    assert done.code == 0, done.err
    limit = 0.3 * Robot.load("jackal").limits.linear_speed
    assert f", {limit:g})" in (tmp_path / "trip.py").read_text().partition("LIMITS = {")[2]


def test_a_script_takes_the_world_that_is_a_usd_file_as_it_is(trundle: Trundle, tmp_path: Path) -> None:
    assert trundle("export", "maze", "--set", "rows=3", "-o", "hall.usda").code == 0
    (tmp_path / "trip.yaml").write_text("world: hall.usda\nrobot: nova_carter\n")
    assert trundle("export", "trip.yaml", "-o", "trip.py").code == 0
    assert 'ENVIRONMENT = "hall.usda"' in (tmp_path / "trip.py").read_text()
    assert {path.name for path in tmp_path.iterdir()} == {"hall.usda", "trip.yaml", "trip.py"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("trip.yaml", "--to", "sdf"),
            "the format sdf cannot hold a scenario; a scenario can be written as isaac-script, mjcf, usd",
        ),
        (("trip.yaml", "--to", "usd", "--set", "rows=3"), "this is a scenario"),
        (("trip.yaml", "--to", "usd", "--profile", "isac"), "Did you mean 'isaac'"),
        (("trip.yaml", "--to", "isaac-script", "--environment", "hospitl"), "Did you mean 'hospital'"),
        (("trip.yaml", "--to", "isaac-script", "--profile", "isaac"), "--profile is for a world --to usd"),
        (("trip.yaml", "--to", "usd", "--environment", "office"), "--environment is for a scenario --to isaac-script"),
        (("maze", "--to", "isaac-script"), "cannot hold a world"),
    ],
)
def test_bad_input_about_scenarios_leaves_nothing(
    trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    (tmp_path / "trip.yaml").write_text(SCENARIO)
    done = trundle("export", *arguments)
    assert done.code == 2
    assert words in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["trip.yaml"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("maze",), "give --to FORMAT"),
        (("maze", "--to", "sdff"), "Did you mean 'sdf'?"),
        (("maz", "--to", "sdf"), "Did you mean 'maze'?"),
        (("maze", "--to", "sdf", "-o", "maze.xml"), ".sdf or .world"),
        (("maze", "-o", "maze.doc"), "must end in one of"),
        (("maze", "--to", "urdf"), "cannot hold a world"),
        (("nova_carter", "--to", "sdf"), "cannot hold a robot"),
        (("nova_carter", "--to", "mjcf", "--set", "a=1"), "are for worlds"),
        (("nova_carter", "--to", "mjcf", "--robot", "jackal"), "this is a robot"),
        (("maze", "--to", "sdf", "--resolution", "0.1"), "--to map"),
        (("maze", "--to", "sdf", "--robot", "jackal"), "--to mjcf"),
        (("maze", "--to", "mjcf", "--set", "rows=0"), "rows"),
    ],
)
def test_bad_input_leaves_nothing(trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("export", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []
