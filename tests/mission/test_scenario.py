"""Scenarios as values and files: what is read, refused and written."""

import math
from pathlib import Path

import pytest

from mission.conftest import write_scenario
from trundle.errors import AngleWarning, InputError, OutputError, ScenarioError
from trundle.mission import Scenario


def test_names_alone_stand_for_choices_without_options(tmp_path):
    path = write_scenario(tmp_path, "world: warehouse\nplanner: manhattan_astar\nbackend: kinematic\n")
    scenario = Scenario.load(path)
    assert scenario.world.name == "warehouse"
    assert scenario.planner.name == "manhattan_astar"
    assert scenario.backend.options == {}
    assert scenario.controller.name == "regulated_pure_pursuit"


def test_options_and_numbers_are_read(tmp_path):
    text = """
world: {name: warehouse, seed: 7, options: {aisle_width: 1.4, size: [20, 12.5]}}
robot: turtlebot3_burger
start: [0, 1.5]
goals: [[3, 4], [5, 6, 1.57]]
controller: {name: regulated_pure_pursuit, options: {lookahead: 6e-1}}
time_limit_s: 90
"""
    scenario = Scenario.load(write_scenario(tmp_path, text))
    assert scenario.world.seed == 7
    assert scenario.world.options == {"aisle_width": 1.4, "size": [20, 12.5]}
    assert scenario.goals == ((3.0, 4.0), (5.0, 6.0, 1.57))
    assert scenario.controller.options == {"lookahead": 0.6}


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("world: warehouse\nspeed: 3\n", ":2:1: speed: unknown key"),
        ("world: warehouse\nstart: [1]\n", ":2:8: start:"),
        ("world: warehouse\nstart: [1, 2, 3, 4]\n", ":2:8: start:"),
        ("world: warehouse\nstart: [1, .nan]\n", ":2:12: start.1:"),
        ("world: warehouse\ngoals: []\n", ":2:8: goals:"),
        ("world: warehouse\nseed: -1\n", ":2:7: seed:"),
        ("world: warehouse\nresolution: 0\n", ":2:13: resolution:"),
        ("world: {name: warehouse, sede: 1}\n", ":1:26: world.sede: unknown key. Did you mean 'seed'"),
        ("world: {seed: 1}\n", ":1:8: world.name:"),
        ("planner: 3\nworld: warehouse\n", ":1:10: planner:"),
        ("robot: nova_carter\n", "either world or map"),
        ("world: warehouse\nmap: m.yaml\n", "either world or map"),
        ("world: warehouse\ngoal: [1, 2]\ngoals: [[1, 2]]\n", "either goal or goals"),
        ("world: warehouse\ncompat: humble\n", "needs map"),
    ],
)
def test_every_mistake_is_reported_with_its_place(tmp_path, text, where):
    path = write_scenario(tmp_path, text)
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert where in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n", "a map"),
        ("name: mine\ndrive: {wheel_radius: 0.1}\nfootprint: []\n", "a robot"),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(tmp_path, text, kind):
    path = write_scenario(tmp_path, text)
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert str(caught.value) == f"{path}: this is {kind}, not a scenario"


def test_an_option_of_no_kind_that_is_known_is_one_mistake(tmp_path):
    path = write_scenario(tmp_path, "world: {name: warehouse, options: {size: {x: 1}}}\n")
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(path)
    assert str(caught.value) == f"{path}:1:42: world.options.size: must be a single value, or a list of them"


def test_a_yaw_may_be_in_degrees(tmp_path):
    path = write_scenario(tmp_path, "world: warehouse\nstart: [1, 2, 90deg]\ngoals: [[1, 2], [3, 4, -45deg]]\n")
    scenario = Scenario.load(path)
    assert scenario.start == pytest.approx((1.0, 2.0, math.pi / 2.0))
    assert scenario.goals[1] == pytest.approx((3.0, 4.0, -math.pi / 4.0))
    assert Scenario.make(world="warehouse", goal=(1, 2, "90 deg")).goal[2] == pytest.approx(math.pi / 2.0)


def test_a_yaw_beyond_a_whole_turn_is_warned_of_with_its_place(tmp_path):
    path = write_scenario(tmp_path, "world: warehouse\nstart: [1, 2, 90]\n")
    with pytest.warns(AngleWarning, match=r"scenario.yaml:2:8: start: 90 is more than one turn, .* write 90deg"):
        assert Scenario.load(path).start == (1.0, 2.0, math.remainder(90.0, math.tau))
    with pytest.warns(AngleWarning, match="^goal: 90 is more than one turn"):
        Scenario.make(world="warehouse", goal=(1, 2, 90))


def test_what_is_wrong_beside_such_a_yaw_is_an_error(tmp_path):
    path = write_scenario(tmp_path, "world: warehouse\nstart: [0.5, 1.1 1, 90]\n")
    with (
        pytest.warns(AngleWarning),
        pytest.raises(InputError, match=r"scenario\.yaml:2:14: start\.1: must be a number, got '1\.1 1'"),
    ):
        Scenario.load(path)


def test_a_missing_file_is_a_scenario_error(tmp_path):
    with pytest.raises(ScenarioError, match="cannot read"):
        Scenario.load(tmp_path / "none.yaml")


def test_mistakes_in_keywords_are_scenario_errors():
    with pytest.raises(ScenarioError, match="either world or map"):
        Scenario.make(robot="nova_carter")
    with pytest.raises(ScenarioError, match="speed: unknown key"):
        Scenario.make(world="warehouse", speed=3)


def test_paths_are_relative_to_the_file(tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    path = write_scenario(tmp_path / "sub", "map: maps/m.yaml\nrobot: ./mine.yaml\n")
    monkeypatch.chdir(tmp_path)
    scenario = Scenario.load("sub/scenario.yaml")
    assert Path(scenario.map) == Path("sub/maps/m.yaml")
    assert Path(scenario.robot) == Path("sub/mine.yaml")
    assert Scenario.load(path).map == str(path.parent / "maps" / "m.yaml")


def test_a_catalogue_robot_is_no_path(tmp_path):
    assert Scenario.load(write_scenario(tmp_path, "world: warehouse\nrobot: jackal\n")).robot == "jackal"


@pytest.mark.parametrize(
    "settings",
    [
        {"world": "warehouse"},
        {"world": {"name": "warehouse", "seed": 7, "options": {"aisle_width": 1.4}}, "seed": 3, "time_limit_s": 12.5},
        {"world": "warehouse", "start": (1.0, 2.0, 0.1), "goal": (0.1 + 0.2, 1e-7), "backend": "kinematic"},
        {"world": "warehouse", "goals": ((1.0, 2.0), (3.0, 4.0, -1.5)), "name": "two goals", "inflation_radius": 1.0},
    ],
)
def test_a_saved_scenario_comes_back_as_it_was(tmp_path, settings):
    scenario = Scenario.make(**settings)
    scenario.save(tmp_path / "s.yaml")
    assert Scenario.load(tmp_path / "s.yaml") == scenario


def test_saved_paths_still_lead_to_the_files(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "runs" / "one").mkdir(parents=True)
    (tmp_path / "maps" / "m.yaml").write_text("")
    monkeypatch.chdir(tmp_path)
    Scenario.make(map="maps/m.yaml", robot="mine.yaml").save("runs/one/scenario.yaml")
    text = (tmp_path / "runs" / "one" / "scenario.yaml").read_text()
    assert "../../maps/m.yaml" in text
    again = Scenario.load("runs/one/scenario.yaml")
    assert Path(again.map).samefile("maps/m.yaml")
    assert Path(again.robot).resolve() == (tmp_path / "mine.yaml").resolve()


def test_a_map_from_elsewhere_is_named_in_full(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    Scenario.make(map="../m.yaml").save("s.yaml")
    assert Scenario.load("s.yaml").map == str(tmp_path / "m.yaml")


def test_saving_where_there_is_no_folder_is_an_output_error(tmp_path):
    with pytest.raises(OutputError):
        Scenario.make(world="warehouse").save(tmp_path / "none" / "s.yaml")


def test_the_title_names_robot_and_place():
    assert Scenario.make(world="warehouse").title == "nova_carter-warehouse"
    assert Scenario.make(map="maps/office.yaml", robot="robots/mine.yaml").title == "mine-office"
    assert Scenario.make(world="warehouse", name="night shift").title == "night shift"
