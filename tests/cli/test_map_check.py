import os
from pathlib import Path

import numpy as np
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


@pytest.mark.slow
def test_an_error_is_exit_code_1_and_is_put_right(trundle: Trundle, flipped: Path, tmp_path: Path) -> None:
    done = trundle("map", "check", flipped, *WORLD, "--fix", "right.yaml", "-o", "report.png", "--json")
    assert done.code == 1, done.err
    report = done.json
    assert [set(finding) for finding in report["findings"]] == [
        {"kind", "severity", "message", "where", "fix", "area_m2"}
    ] * 2
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
    assert "fixed: not written: there is no certain fix" in done.out
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
        (("none.yaml",), "no such file"),
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


@pytest.mark.parametrize("kind", ["missing", "a folder", "a pipe", "an image"])
def test_a_file_without_text_to_check_is_bad_input(trundle: Trundle, tmp_path: Path, kind: str) -> None:
    file = tmp_path / "map.yaml"
    match kind:
        case "a folder":
            file.mkdir()
        case "a pipe":
            os.mkfifo(file)
        case "an image":
            file.write_bytes(b"\x89PNG\r\n\x1a\n\x00\xff")
        case _:
            pass
    done = trundle("map", "check", file)
    assert (done.code, done.out) == (2, "")
    assert len(done.err.splitlines()) == 1
    assert "map.yaml" in done.err
    assert "of a map" in done.err


@pytest.fixture
def rough(tmp_path: Path) -> Path:
    """A map as a bad scan leaves it: dozens of specks, holes, small islands and gaps."""
    grid = map_of(warehouse())
    data = grid.data.copy()
    row, col = grid.world_to_cell(-10.0, 2.0)
    data[row : row + 60 : 6, col : col + 30 : 5] = 100
    data[row + 3 : row + 60 : 6, col : col + 30 : 5] = -1
    for first in range(20, 380, 24):  # islands of 5 cells within the outer wall and racks
        solid = np.argwhere((data[:-4, :-7] == 100) & (data[4:, 7:] == 100))
        at_row, at_col = solid[first * len(solid) // 400]
        if (data[at_row : at_row + 5, at_col : at_col + 8] == 100).all():
            data[at_row + 2, at_col + 1 : at_col + 6] = 0
    redrawn(grid, data).save(tmp_path / "rough.yaml")
    return tmp_path / "rough.yaml"


def test_many_findings_take_at_most_fifteen_lines_and_all_lists_them(trundle: Trundle, rough: Path) -> None:
    findings = trundle("map", "check", rough, "--json").json["findings"]
    assert len(findings) > 100
    done = trundle("map", "check", rough, "-o", "report.png", "--fix", "right.yaml")
    lines = done.out.splitlines()
    assert len(lines) <= 15
    assert f"{sum(finding['severity'] == 'warning' for finding in findings)} warnings" in lines[0]
    specks = [line for line in lines if "occupied speck" in line]
    assert len(specks) == 1
    assert "60 in all, also at (" in specks[0]
    everything = trundle("map", "check", rough, "--all").out
    assert everything.count("\n    fix: ") == len(findings)
    assert all(f"({finding['where'][0]:.2f}, {finding['where'][1]:.2f})" in everything for finding in findings)


def test_what_no_robot_would_notice_is_last_on_one_line(trundle: Trundle, rough: Path) -> None:
    islands = [one for one in trundle("map", "check", rough, "--json").json["findings"] if one["kind"] == "island"]
    assert islands
    assert all(island["area_m2"] < 0.024 for island in islands)
    lines = trundle("map", "check", rough, *WORLD).out.splitlines()
    assert not any(": island" in line for line in lines)
    assert lines[-1].startswith(f"too small for the robot to notice: {len(islands)} free areas")
    assert lines[-1].endswith("--all lists them")


def test_fifteen_lines_are_enough_for_every_kind(trundle: Trundle, rough: Path) -> None:
    text = rough.read_text().replace("negate: 0", "negate: 0\nnegate: 0\nfre_thresh: 1\nother: 2\nmore: 3\nand: 4\n")
    rough.write_text(text)
    arguments = ("--robot", "nova_carter", "--start", "40,0", "--goal", "50,0", "--goal", "60,0", "--goal", "70,0")
    done = trundle("map", "check", rough, *arguments, "-o", "report.png")
    lines = done.out.splitlines()
    assert done.code == 1
    assert len(lines) <= 15
    assert lines[1].startswith("error: disconnected")


@pytest.mark.slow
def test_a_map_that_agrees_nowhere_is_no_success(trundle: Trundle, tmp_path: Path) -> None:
    map_of(warehouse()).save(tmp_path / "map.yaml")
    done = trundle("map", "check", "map.yaml", "--world", "maze", "--seed", 5)
    assert done.code == 1
    assert "nothing found" not in done.out
    assert "error: mismatch: the map agrees with the world nowhere" in done.out
