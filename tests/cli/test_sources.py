from pathlib import Path

import pytest

from support.command_line import Trundle
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError
from trundle.files.kinds import EVALUATION

SCENARIO = "world: warehouse\ngoal: [1, 2]\n"
ROBOT = "name: mine\ndrive: {}\nlimits: {}\n"


@pytest.fixture
def things(trundle: Trundle, room_map: Path, tmp_path: Path) -> Trundle:
    """Files of every kind in the current folder."""
    (tmp_path / "map.yaml").write_text(room_map.read_text().replace("room", "maps/room"))
    (tmp_path / "picture.png").write_bytes(b"")
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "robot.yaml").write_text(ROBOT)
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "episode.json").write_text("{}")
    (tmp_path / "drive").mkdir()
    (tmp_path / "drive" / "drive.csv").write_text("")
    (tmp_path / "nightly").mkdir()
    (tmp_path / "nightly" / "evaluation.json").write_text("{}")
    return trundle


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            "run picture.png",
            "picture.png: this is a picture, not a scenario, a map or a world; give the map's YAML file",
        ),
        (
            "run run",
            "run: this is the folder of a run, not a scenario, a map or a world; to repeat it give run/scenario",
        ),
        ("run drive", "drive: this is the folder of a drive, not a scenario, a map or a world; to repeat its commands"),
        (
            "run robot.yaml",
            "robot.yaml: this is a robot, not a scenario, a map or a world; give it with --robot robot.y",
        ),
        (
            "run nova_carter",
            "nova_carter: this is a robot, not a scenario, a map or a world; give it with --robot nova",
        ),
        ("run least_cost", "least_cost: this is a planner, not a scenario, a map or a world"),
        ("run warehouse --robot map.yaml", "map.yaml: this is a map, not a robot"),
        ("run map.yaml --keepout scenario.yaml", "scenario.yaml: this is a scenario, not a map"),
        (
            "plan warehouse",
            "warehouse: this is a world, not a map; make its map with trundle map build warehouse -o map",
        ),
        ("plan scenario.yaml", "scenario.yaml: this is a scenario, not a map; give its map, or drive it"),
        ("plan map.yaml --robot warehouse", "warehouse: this is a world, not a robot"),
        ("map build picture.png", "picture.png: this is a picture, not a world or a map"),
        (
            "map build nova_carter",
            "nova_carter: this is a robot, not a world or a map; give it with --robot nova_carter",
        ),
        ("map check run", "run: this is the folder of a run, not a map; give the YAML file of a map"),
        ("map convert maps -o other.yaml", "maps: this is a folder, not a map; give the YAML file of a map in it"),
        (
            "view warehouse",
            "warehouse: this is a world, not a robot; give a robot first, and this with --world warehouse",
        ),
        ("drive map.yaml --command 1,0,1", "map.yaml: this is a map, not a robot"),
        (
            "drive nova_carter --world scenario.yaml --command 1,0,1",
            "scenario.yaml: this is a scenario, not a world or a",
        ),
        ("drive nova_carter --like map.yaml", "map.yaml: this is a map, not the folder of a run"),
        ("joints scenario.yaml", "scenario.yaml: this is a scenario, not a robot"),
        ("doctor robot office", "office: this is a world, not a robot"),
        ("compare mujoco map.yaml", "mujoco: this is a simulator, not the folder of a run"),
        ("compare drive map.yaml", "map.yaml: this is a map, not the folder of a run"),
        (
            "compare run nightly",
            "nightly: this is the folder of an evaluation, not the folder of a run, the folder of a drive, a table or "
            "a file of arrays; compare evaluations with trundle evaluate compare",
        ),
        (
            "run nightly",
            "nightly: this is the folder of an evaluation, not a scenario, a map or a world; to run one ",
        ),
        ("export picture.png --to usd", "picture.png: this is a picture, not a world, a robot, a scenario or a map"),
    ],
)
def test_what_is_given_in_place_of_another_kind_is_called_what_it_is(
    things: Trundle, arguments: str, message: str
) -> None:
    done = things(*arguments.split())
    assert done.code == 2
    assert done.out == ""
    assert done.err.startswith(f"trundle: {message}")


def test_a_name_is_taken_for_what_is_wanted_also_beside_a_folder_of_that_name(things: Trundle, tmp_path: Path) -> None:
    (tmp_path / "warehouse").mkdir()
    assert things("map", "build", "warehouse", "--resolution", "0.2", "-o", "new.yaml").code == 0


@pytest.mark.parametrize(
    ("folder", "advice"),
    [
        ("run", "; compare runs with trundle compare"),
        ("drive", "; compare drives with trundle compare"),
        ("maps", "; give the folder that trundle evaluate wrote"),
    ],
)
def test_in_place_of_an_evaluation_the_verb_for_the_folder_is_named(things: Trundle, folder: str, advice: str) -> None:
    with pytest.raises(InputError, match=advice):
        check_given(folder, EVALUATION)
    check_given("nightly", EVALUATION)


def test_names_that_nothing_has_are_left_to_the_verb(things: Trundle) -> None:
    assert "unknown world 'warehose'. Did you mean 'warehouse'?" in things("run", "warehose").err


def test_a_folder_with_the_name_of_a_simulator_is_that_folder(things: Trundle) -> None:
    assert things("drive", "nova_carter", "--command", "0.2,0,0.2", "--backend", "kinematic", "-o", "mujoco").code == 0
    assert things("drive", "nova_carter", "--like", "mujoco", "--backend", "kinematic", "-o", "kinematic").code == 0
