"""The page on maps: its options are those of `trundle map build`, its Python runs, and its picture is what it says."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from trundle.cli.entry import run_command
from trundle.maps import HeightField, OccupancyGrid

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "maps.md").read_text()
SECTION = PAGE.partition("\n## Made from a world")[2].partition("\n## ")[0]


def test_the_options_are_those_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["map", "build", "--help"]) == 0
    there = set(re.findall(r"--[a-z][a-z-]*", capsys.readouterr().out))
    table = "\n".join(line for line in SECTION.splitlines() if line.startswith("| `--"))
    assert set(re.findall(r"--[a-z][a-z-]*", table)) == there - {"--out", "--json", "--quiet"}


def test_the_python_of_the_page_runs_and_its_field_can_be_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", SECTION, flags=re.DOTALL)
    found: dict[str, object] = {}
    exec(code, found)
    assert isinstance(found["grid"], OccupancyGrid)
    assert HeightField.load("floor.npz").heights.max() == pytest.approx(0.6)
    assert run_command(["map", "build", "warehouse", "--floor", "floor.npz", "--max-slope", "0.17"]) == 0
    assert np.array_equal(OccupancyGrid.load("map.yaml").data, found["grid"].data)


def test_the_picture_of_the_ramps_is_what_its_script_makes() -> None:
    spec = importlib.util.spec_from_file_location("ramps", ROOT / "docs" / "pictures" / "ramps.py")
    assert spec is not None
    assert spec.loader is not None
    ramps = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(ramps)
    world = ramps.make_dock()
    floor = HeightField.from_function(ramps.floor_height, ((-6.2, -4.7), (6.2, 4.7)), resolution=0.05)
    shown = Image.open(ROOT / "docs" / "images" / "ramps.png").convert("L")
    for index, options in enumerate(({}, {"floor": floor, "max_slope": 0.17})):
        made = np.asarray(ramps.draw_map(world, **options).convert("L"), dtype=float)
        left = ramps.SIZE[0] + index * ramps.WIDE + (ramps.WIDE - ramps.MAP) // 2
        top = 36 + (ramps.SIZE[1] - made.shape[0]) // 2
        seen = np.asarray(shown, dtype=float)[top : top + made.shape[0], left : left + ramps.MAP]
        assert np.abs(seen - made).mean() < 3.0
