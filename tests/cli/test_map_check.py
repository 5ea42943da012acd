from pathlib import Path

import pytest
from PIL import Image

from support.command_line import Trundle
from support.planted_maps import changed, map_of, redrawn, same, warehouse
from trundle.maps import OccupancyGrid

WORLD = ("--world", "warehouse", "--seed", 7)


@pytest.fixture
def flipped(tmp_path: Path) -> Path:
    grid = changed(map_of(warehouse()), (-10.5, 2.5, -9.5, 3.5, -1))
    redrawn(grid, grid.data[::-1]).save(tmp_path / "flipped.yaml")
    return tmp_path / "flipped.yaml"


def test_a_good_map_is_done(trundle: Trundle, tmp_path: Path) -> None:
    map_of(warehouse()).save(tmp_path / "map.yaml")
    done = trundle("map", "check", "map.yaml", *WORLD, "--robot", "nova_carter")
    assert done.code == 0, done.err
    assert done.out == "map.yaml: nothing found\n"


def test_an_error_is_exit_code_1_and_is_put_right(trundle: Trundle, flipped: Path, tmp_path: Path) -> None:
    done = trundle("map", "check", flipped, *WORLD, "--fix", "right.yaml", "-o", "report.png", "--json")
    assert done.code == 1, done.err
    report = done.json
    assert [set(finding) for finding in report["findings"]] == [{"kind", "severity", "message", "where", "fix"}] * 2
    assert [finding["kind"] for finding in report["findings"]] == ["flipped", "unknown_hole"]
    assert report["unverified"] == report["ambiguous"] == []
    assert report["can_fix"] == ["flipped", "unknown_hole"]
    assert same(OccupancyGrid.load(tmp_path / report["fixed"]), map_of(warehouse()))
    with Image.open(tmp_path / report["picture"]) as picture:
        assert picture.width > 900
    again = trundle("map", "check", "right.yaml", *WORLD)
    assert (again.code, again.out) == (0, "right.yaml: nothing found\n")


def test_the_report_is_text(trundle: Trundle, flipped: Path) -> None:
    done = trundle("map", "check", flipped, "--fix", "right.yaml")
    assert done.code == 0, done.err
    first, second, third, *_ = done.out.splitlines()
    assert first.endswith("flipped.yaml: 1 warning")
    assert second.startswith("warning: unknown_hole at (-10.02, -3.02)")
    assert third.startswith("    fix: drive past it")
    assert "unverified: half_cell, flipped, rotated, shifted" in done.out
    assert "fixed: not written: nothing can be put right for certain" in done.out
    assert not Path("right.yaml").exists()


def test_a_map_that_does_not_load_is_reported(trundle: Trundle, flipped: Path) -> None:
    flipped.write_text(flipped.read_text().replace("resolution: 0.05", "resolution: 0"))
    done = trundle("map", "check", flipped, *WORLD, "-o", "report.png", "--fix", "right.yaml", "--json")
    assert done.code == 1, done.err
    assert [finding["kind"] for finding in done.json["findings"]] == ["resolution"]
    assert done.json["fixed"] is None
    assert done.json["picture"] is None


def test_start_and_goal_are_checked(trundle: Trundle, flipped: Path) -> None:
    done = trundle("map", "check", flipped, "--start", "-10,0", "--goal", "0,0", "--goal", "40,0", "--json")
    assert done.code == 1
    assert [finding["where"] for finding in done.json["findings"] if finding["kind"] == "disconnected"] == [[40, 0]]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("none.yaml",), "no such map file"),
        (("flipped.yaml", "--world", "warehose"), "Did you mean 'warehouse'?"),
        (("flipped.yaml", "--robot", "nova"), "nova"),
        (("flipped.yaml", "--start", "1"), "--start"),
        (("flipped.yaml", "-o", "report.jpg"), ".png"),
        (("flipped.yaml", "--set", "aisle_width=2"), "give --world as well"),
    ],
)
def test_bad_input(trundle: Trundle, flipped: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("map", "check", *arguments)
    assert done.code == 2
    assert words in done.err
