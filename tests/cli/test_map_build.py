from pathlib import Path

import numpy as np
import pytest

from support.command_line import Trundle
from trundle.maps import OccupancyGrid


def test_the_map_of_the_warehouse(trundle: Trundle, tmp_path: Path) -> None:
    done = trundle("map", "build", "warehouse", "--seed", 7, "-o", "map.yaml", "--json")
    assert done.code == 0, done.err
    grid = OccupancyGrid.load(tmp_path / "map.yaml")
    assert grid.shape == (done.json["rows"], done.json["cols"])
    assert done.json["free_cells"] == (grid.data == 0).sum()
    assert done.json["occupied_cells"] == (grid.data == 100).sum()
    assert done.json["z_range_m"] == [0.10, 0.62]
    assert done.json["free_cells"] > done.json["occupied_cells"] > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.png", "map.yaml"]


def test_the_seed_and_the_options_reach_the_generator(trundle: Trundle) -> None:
    first = trundle("map", "build", "warehouse", "--out", "a", "--seed", 1, "--json").json
    same = trundle("map", "build", "warehouse", "--out", "b", "--seed", 1, "--json").json
    other = trundle("map", "build", "warehouse", "--out", "c", "--seed", 1, "--set", "aisle-width=2.2", "--json").json
    assert first | {"map": ""} == same | {"map": ""}
    assert first["free_cells"] != other["free_cells"]


def test_a_coarse_map_and_another_band(trundle: Trundle) -> None:
    done = trundle("map", "build", "warehouse", "--resolution", "0.2", "--z-min", "1.0", "--z-max", "1.5", "--json")
    assert done.code == 0, done.err
    assert (done.json["resolution_m"], done.json["z_range_m"]) == (0.2, [1.0, 1.5])


def test_a_map_of_a_map_is_that_map(trundle: Trundle, room_map: Path, tmp_path: Path) -> None:
    done = trundle("map", "build", room_map, "-o", "again.yaml")
    assert done.code == 0, done.err
    before, after = OccupancyGrid.load(room_map), OccupancyGrid.load(tmp_path / "again.yaml")
    x, y = before.cell_to_world(*(index[1:-1, 1:-1] for index in np.indices(before.shape)))
    row, col = after.world_to_cell(x, y)
    assert ((before.data[1:-1, 1:-1] == 0) == (after.data[row, col] == 0)).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("warehose",), "Did you mean 'warehouse'?"),
        (("none.yaml",), "cannot read none.yaml"),
        (("warehouse", "--robot", "nova_cartr"), "Did you mean 'nova_carter'?"),
        (("warehouse", "--set", "isle_width=2"), "isle_width"),
        (("warehouse", "--set", "aisle_width"), "give KEY=VALUE"),
        (("warehouse", "--resolution", "0"), "resolution"),
        (("warehouse", "--resolution", "nan"), "resolution"),
        (("warehouse", "--z-min", "2", "--z-max", "1"), "2"),
        (("warehouse", "-o", "map.png"), ".yaml or .yml, or a folder"),
    ],
)
def test_bad_input_leaves_nothing(trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("map", "build", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []


def test_generator_options_are_not_for_maps(trundle: Trundle, room_map: Path) -> None:
    done = trundle("map", "build", room_map, "--set", "aisle_width=2")
    assert done.code == 2
    assert "no option for a .yaml file" in done.err


USD = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def Cube "Pillar" { double size = 1; }
def Cube "Robot" { double size = 1
    double3 xformOp:translate = (5, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def "Rack" (references = @gone.usd@) {}
"""


def test_a_usd_scene_becomes_a_map_without_what_is_left_out(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "scene.usda").write_text(USD)
    done = trundle("map", "build", "scene.usda", "--exclude", "/Robot", "--exclude", "/Rack", "--json")
    assert done.code == 0, done.err
    assert done.json["occupied_cells"] == 20 * 20
    assert done.err == ""


def test_what_a_usd_scene_lacks_is_said(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "scene.usda").write_text(USD)
    done = trundle("map", "build", "scene.usda", "--set", "missing=error")
    assert done.code == 2
    assert "/Rack" in done.err
    assert "gone.usd" in done.err
