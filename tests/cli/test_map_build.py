from pathlib import Path

import numpy as np
import pytest

from support.command_line import Trundle
from trundle.errors import MapWarning, WorldWarning
from trundle.maps import HeightField, OccupancyGrid


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


def test_a_maps_height_and_unknown_cells_are_as_its_options_say(trundle: Trundle, tmp_path: Path) -> None:
    cells = np.zeros((20, 30), dtype=np.int8)
    cells[5, 5:10], cells[12:15, 20:25] = 100, -1
    OccupancyGrid(cells, 0.05).save(tmp_path / "given.yaml")
    found = {}
    for name, options in {
        "walls": (),
        "free": ("--set", "unknown=free"),
        "low": ("--set", "height=0.05", "--z-min", "0.02"),
    }.items():
        done = trundle("map", "build", "given.yaml", *options, "--bounds", "0,0,1.5,1", "--json")
        assert done.code == 0, done.err
        found[name] = done.json["occupied_cells"]
    assert found == {"walls": 5 + 15, "free": 5, "low": 5 + 15}
    with pytest.warns(MapWarning, match="the solids span heights 0 to 0.05 m"):
        trundle("map", "build", "given.yaml", "--set", "height=0.05")
    for option, words in (("hight=1", "did you mean 'height'?"), ("unknown=wall", "'solid' or 'free'")):
        done = trundle("map", "build", "given.yaml", "--set", option)
        assert done.code == 2
        assert words in done.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("warehose",), "Did you mean 'warehouse'?"),
        (("none.yaml",), "none.yaml: no such file"),
        (("warehouse", "--robot", "nova_cartr"), "Did you mean 'nova_carter'?"),
        (("warehouse", "--set", "isle_width=2"), "did you mean 'aisle_width'?"),
        (("warehouse", "--set", "aisle_width"), "give KEY=VALUE"),
        (("warehouse", "--resolution", "0"), "resolution"),
        (("warehouse", "--resolution", "nan"), "resolution"),
        (("warehouse", "--z-min", "2", "--z-max", "1"), "2"),
        (("warehouse", "-o", "map.png"), ".yaml or .yml, or a folder"),
        (("warehouse", "--z-min", "nan"), "z_range"),
        (("warehouse", "--floor-z", "nan"), "floor_z"),
        (("warehouse", "--floor", "none.npz"), "cannot read none.npz"),
        (("warehouse", "--max-slope", "steep"), "--max-slope 'steep' is not an angle; write radians"),
        (("warehouse", "--max-slope", "0.2"), "give floor, a HeightField"),
        (("warehouse", "--bounds", "0,0,1"), "--bounds '0,0,1': give X0,Y0,X1,Y1"),
        (("warehouse", "--bounds", "0,0,nan,1"), "--bounds"),
        (("warehouse", "--bounds", "1,1,0,0"), "bounds must be"),
        (("warehouse", "--margin", "-1"), "margin"),
        (("warehouse", "--free", "1"), "--free '1': give X,Y, or largest"),
        (("warehouse", "--free", "largest", "--free", "1,1"), "cannot be combined"),
        (("warehouse", "--free", "900,0"), "the seed (900, 0) lies outside the map"),
        (("warehouse", "--coverage", "half"), "--coverage"),
        (("warehouse", "--style", "ros"), "--style"),
        (("warehouse", "--style", "isaac", "--coverage", "centre"), "leave coverage"),
        (("warehouse", "--max-cells", "100"), "more than 100 cells"),
        (("warehouse", "--resolution", "0.0001"), "more than 400000000 cells"),
    ],
)
def test_bad_input_leaves_nothing(trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("map", "build", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []


SDF = """<sdf version="1.9"><world name="yard">
  <model name="post"><static>true</static><pose>{x} 0 {z} 0 0 0</pose><link name="l"><collision name="c"><geometry>
    <box><size>1 1 1</size></box></geometry></collision></link></model>
  <model name="wall"><static>true</static><pose>0 2 0.5 0 0 0</pose><link name="l"><collision name="c"><geometry>
    <box><size>4 0.1 1</size></box></geometry></collision></link></model>
</world></sdf>"""


def write_yard(folder: Path, *, x: float = 0.0, z: float = 0.5) -> None:
    (folder / "yard.sdf").write_text(SDF.format(x=x, z=z))


def build(trundle: Trundle, folder: Path, *options: object) -> OccupancyGrid:
    done = trundle("map", "build", "yard.sdf", *options, "-o", "map.yaml")
    assert done.code == 0, done.err
    return OccupancyGrid.load(folder / "map.yaml")


def test_the_bounds_the_margin_and_the_origin(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path)
    assert build(trundle, tmp_path, "--bounds", "-3,-4,3,4").shape == (160, 120)
    grid = build(trundle, tmp_path, "--bounds", "-3,-4,3,4", "--margin", "1", "--resolution", "0.1")
    assert (grid.shape, grid.origin.as_tuple()) == ((100, 80), (-4.0, -5.0, 0.0))
    half = build(trundle, tmp_path, "--bounds", "-3,-4,3,4", "--half-cell-origin")
    assert half.origin.as_tuple() == pytest.approx((-2.975, -3.975, 0.0))
    assert build(trundle, tmp_path, "--resolution", "0.001", "--max-cells", "30000000").shape == (2550, 4000)


@pytest.mark.slow
def test_the_free_points_the_coverage_and_the_style(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path, x=0.01)
    bounds = ("--bounds", "-2,-2,2,3")
    south = build(trundle, tmp_path, *bounds, "--free", "-1.5,-1.5")
    north = build(trundle, tmp_path, *bounds, "--free", "-1.5,2.5")
    both = build(trundle, tmp_path, *bounds, "--free", "-1.5,2.5", "--free", "-1.5,-1.5")
    largest = build(trundle, tmp_path, *bounds, "--free", "largest")
    assert (south.data[20, 5], south.data[95, 5]) == (0, -1)
    assert (north.data[20, 5], north.data[95, 5]) == (-1, 0)
    assert (both.data[20, 5], both.data[95, 5]) == (0, 0)
    assert np.array_equal(largest.data, south.data)
    post = (slice(20, 60), slice(20, 60))
    assert (south.data[post] == 100).sum() == 21 * 20
    assert (build(trundle, tmp_path, *bounds, "--coverage", "centre").data[post] == 100).sum() == 20 * 20
    assert (build(trundle, tmp_path, *bounds, "--style", "isaac").data[post] == 100).sum() == 21 * 22
    inside = trundle("map", "build", "yard.sdf", "--free", "0,0", "-o", "other.yaml")
    assert inside.code == 2
    assert "the seed (0, 0) lies in a cell of 0.05 m that contains part of an obstacle" in inside.err
    assert "contains part of an obstacle between heights 0.1 and 0.62 m" in inside.err
    assert not (tmp_path / "other.yaml").exists()


def test_a_floor_at_another_height(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path, z=-2.0)
    grid = build(trundle, tmp_path, "--floor-z", "-2.5", "--bounds", "-2,-2,2,3")
    assert (grid.data == 100).sum() == 20 * 20


def test_a_floor_with_a_ramp(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path, z=0.5)
    field = HeightField.from_function(lambda x, y: np.clip(0.2 * (x + 1), 0, 0.3), ((-3, -3), (3, 3)))
    field.save(tmp_path / "floor.npz")
    ends = ("--bounds", "-2,-2,2,3", "--floor", "floor.npz")
    done = trundle("map", "build", "yard.sdf", *ends, "--max-slope", "11.5deg", "-o", "map.yaml")
    assert done.code == 0, done.err
    assert "0.1 to 0.62 m above the floor of floor.npz" in done.out
    gentle = OccupancyGrid.load(tmp_path / "map.yaml")
    assert (gentle.data[:75] == 100).sum() == 20 * 20
    steep = build(trundle, tmp_path, *ends, "--free", "-1.5,-1.5")  # 0.2 is more than ten degrees
    assert (steep.data[:, 20:50] == 100).all()
    assert (steep.data[:30, 50:] == -1).all()
    with pytest.warns(MapWarning, match="the floor's height is unknown in 3200 of 11200 cells"):
        trundle("map", "build", "yard.sdf", "--floor", "floor.npz", "--bounds", "-2,-2,2,5", "--max-slope", "0.2")
    elsewhere = trundle("map", "build", "yard.sdf", "--floor", "floor.npz", "--bounds", "12,-2,14,5", "-o", "no.yaml")
    assert (elsewhere.code, (tmp_path / "no.yaml").exists()) == (2, False)
    assert "unknown in every cell" in elsewhere.err


def test_a_world_of_kilometres_by_mistake_names_the_solid(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path, x=500_000.0)
    with pytest.warns(WorldWarning, match="'post' reaches farthest"):
        done = trundle("map", "build", "yard.sdf")
    assert done.code == 2
    assert "more than 400000000 cells" in done.err
    assert "'post' reaches farthest, x 499999.5 to 500000.5" in done.err
    assert not (tmp_path / "map.yaml").exists()


def test_nothing_in_the_band_is_said(trundle: Trundle, tmp_path: Path) -> None:
    write_yard(tmp_path)
    with pytest.warns(MapWarning, match=r"the map has no obstacle.*\(the solids span heights 0 to 1 m\)"):
        done = trundle("map", "build", "yard.sdf", "--z-min", "3", "--z-max", "4", "--json")
    assert done.json["occupied_cells"] == 0


def test_generator_options_are_not_for_maps(trundle: Trundle, room_map: Path) -> None:
    done = trundle("map", "build", room_map, "--set", "aisle_width=2")
    assert done.code == 2
    assert "not an option of a .yaml file" in done.err


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
    done = trundle("map", "build", "scene.usda", "--exclude", "/Robot", "--exclude", "/Rack", "--margin", "1", "--json")
    assert done.code == 0, done.err
    assert done.json["occupied_cells"] == 20 * 20
    assert done.err == ""


def test_what_a_usd_scene_lacks_is_said(trundle: Trundle, tmp_path: Path) -> None:
    (tmp_path / "scene.usda").write_text(USD)
    done = trundle("map", "build", "scene.usda", "--set", "missing=error")
    assert done.code == 2
    assert "/Rack" in done.err
    assert "gone.usd" in done.err
