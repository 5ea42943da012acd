"""Commented files, JSON Schemas and the tables of fields in the docs."""

import importlib.util
import json
from pathlib import Path

import jsonschema
import pytest
import yaml

from trundle.errors import InputError
from trundle.files.field_docs import describe_fields, json_schema, models_in
from trundle.mission import Scenario
from trundle.robots import Robot, robot_names
from trundle.robots.file_format import describe_robot, plain_robot, robot_schema
from trundle.sim import simulate
from trundle.worlds import World

ROOT = Path(__file__).parents[2]
SCENARIOS = {
    "name": {"world": "warehouse"},
    "options": {"world": {"name": "office", "options": {"rooms": 4}}, "planner": "least_cost", "seed": 3},
    "ends": {"map": "room.yaml", "start": (1.0, 2.0, 0.5), "goals": ((3.0, 4.0), (5.0, 6.0, 1.0))},
    "settings": {"world": "maze", "inflation_radius": 0.7, "unknown": "costly", "goal_tolerance": 0.1},
    "smoother": {"world": "maze", "smoother": {"name": "constrained", "options": {"w_cost": 2.0}}},
}


@pytest.mark.parametrize("model", [*models_in(Scenario), *models_in(Robot)], ids=lambda model: model.__name__)
def test_every_field_is_described(model):
    assert set(describe_fields(model)) == set(model.model_fields)
    assert [name for name, text in describe_fields(model).items() if not text and name != "type"] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_commented_scenario_is_the_same_and_valid(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    scenario = Scenario.make(**SCENARIOS[name])
    scenario.save_commented("s.yaml")
    again = Scenario.load("s.yaml")
    assert again.model_dump() == scenario.model_dump()
    text = Path("s.yaml").read_text(encoding="utf-8")
    for field in Scenario.model_fields:
        assert f"\n{field}:" in text or f"\n# {field}:" in text
    jsonschema.validate(yaml.safe_load(text), json_schema(Scenario, "x"))


def test_commented_defaults_hold_when_the_comment_is_taken_away(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scenario = Scenario.make(world="warehouse")
    scenario.save_commented("s.yaml")
    lines = Path("s.yaml").read_text(encoding="utf-8").splitlines()
    fields = tuple(f"# {field}: " for field in Scenario.model_fields)
    Path("s.yaml").write_text("\n".join(line[2:] if line.startswith(fields) else line for line in lines))
    assert Scenario.load("s.yaml").model_dump() == scenario.model_dump()


@pytest.mark.parametrize("name", robot_names())
def test_a_robot_that_is_described_is_the_same_and_valid(tmp_path, name):
    robot = Robot.load(name)
    path = tmp_path / "r.yaml"
    path.write_text(describe_robot(robot), encoding="utf-8")
    assert Robot.load(path) == robot
    jsonschema.validate(yaml.safe_load(path.read_text(encoding="utf-8")), robot_schema())


def test_a_plain_robot_stands_and_drives():
    world = World.generate("maze", seed=1)
    with simulate(world, plain_robot("p"), backend="mujoco") as simulator:
        assert simulator.robot.name == "p"


@pytest.mark.slow
def test_schemas_refuse_what_the_models_refuse():
    schema = json_schema(Scenario, "x")
    for wrong in ({"world": "a", "sped": 1}, {"world": "a", "resolution": 0}, {"world": "a", "unknown": "wall"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(wrong, schema)
        with pytest.raises(InputError):
            Scenario.make(**wrong)
    jsonschema.validate({"model": "husky.urdf", "drive": {"left_joint": "a"}}, robot_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"name": "no model"}, robot_schema())


def test_tables_and_schemas_in_docs_are_up_to_date():
    spec = importlib.util.spec_from_file_location("field_tables", ROOT / "scripts" / "field_tables.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    for path, text in script.contents().items():
        assert path.read_text(encoding="utf-8") == text, f"run python scripts/field_tables.py: {path.name} is stale"
        if path.suffix == ".json":
            jsonschema.Draft202012Validator.check_schema(json.loads(text))
