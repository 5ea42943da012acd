"""The five steps of examples/isaac, on the stand-in."""

import runpy
import sys
from pathlib import Path

import pytest

import trundle
from support.fake_isaac.fixtures import assets, fake, make_fake

__all__ = ["assets", "fake", "make_fake"]

EXAMPLES = Path(__file__).parents[1] / "examples" / "isaac"


@pytest.fixture
def run_example(tmp_path, monkeypatch, capsys):
    def run(name, *arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
        runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        return capsys.readouterr().out

    return run


@pytest.fixture
def hall_map(assets, tmp_path):
    world = trundle.World.load(assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=(0.1, 0.62)).save(tmp_path / "map.yaml")
    return tmp_path / "map.yaml"


def test_each_step_has_an_example_as_short_as_those_without_isaac_sim():
    found = sorted(EXAMPLES.glob("*.py"))
    assert [path.stem[:2] for path in found] == ["01", "02", "03", "04", "05"]
    assert all(len(path.read_text().splitlines()) < 40 for path in found)


def test_load_and_view(run_example, fake):
    fake.on_draw = lambda drawing: setattr(fake, "window_open", drawing < 40)
    assert "nova_carter stands at" in run_example("01_load_and_view", "warehouse")


def test_list_joints(run_example, fake):
    assert "joint_wheel_left <- drives" in run_example("02_list_joints")


def test_drive_by_hand(run_example, fake):
    assert "after 2 s of v=0.4, w=0: x -1.7" in run_example("03_drive_by_hand", "warehouse")


def test_plan_on_a_map(run_example, hall_map, tmp_path):
    assert "wrote overlay.png" in run_example("04_plan_on_a_map", hall_map)
    assert (tmp_path / "overlay.png").is_file()


def test_drive_to_goal(run_example, fake, hall_map, tmp_path):
    with pytest.raises(SystemExit) as end:
        run_example("05_drive_to_goal", hall_map, "warehouse")
    assert end.value.code == 0
    assert list((tmp_path / "runs").glob("*/episode.json"))
