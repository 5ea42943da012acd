from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support.command_line import Trundle
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

VALUES = np.random.default_rng(0).choice(np.array([-1, 0, 0, 0, 100], dtype=np.int8), (20, 30))
YAML = """image: {image}
resolution: 0.05
origin: [-1.0, -2.0, 0.0]
negate: {negate}
occupied_thresh: {occupied}
free_thresh: {free}
"""


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """The YAML of a map of noise, in a separate folder."""
    folder = tmp_path / "maps"
    folder.mkdir()
    OccupancyGrid(VALUES, 0.05, Pose2D(-1.0, -2.0)).save(folder / "noise.yaml")
    return folder / "noise.yaml"


def written(tmp_path: Path) -> list[str]:
    return sorted(path.name for path in tmp_path.iterdir() if path.name != "maps")


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@pytest.mark.parametrize("image", ["png", "pgm"])
def test_formats_and_modes_without_loss(trundle: Trundle, source: Path, tmp_path: Path, mode: str, image: str) -> None:
    done = trundle("map", "convert", source, "-o", "new.yaml", "--mode", mode, "--image", image, "--json")
    if (mode, image) == ("scale", "pgm"):
        assert done.code == 2
        assert "which PGM lacks" in done.err
        assert written(tmp_path) == []
        return
    assert done.code == 0, done.err
    again = OccupancyGrid.load(tmp_path / "new.yaml")
    assert np.array_equal(again.data, VALUES)
    assert (again.resolution, again.origin) == (0.05, Pose2D(-1.0, -2.0))
    assert written(tmp_path) == [f"new.{image}", "new.yaml"]
    report = done.json
    assert (report["format"], report["mode"], report["lossless"], report["losses"]) == ("ros", mode, True, [])
    assert report["free_cells"] == report["sources"][0]["free_cells"] == (VALUES == 0).sum()


def test_greys_are_kept_without_a_mode_and_their_loss_is_said(trundle: Trundle, tmp_path: Path) -> None:
    grid = OccupancyGrid(np.array([[-1, 0, 10, 40, 80, 100]]), 0.1)
    grid.save(tmp_path / "grey.yaml", mode="raw")
    kept = trundle("map", "convert", "grey.yaml", "-o", "kept.yaml")
    assert kept.code == 0, kept.err
    assert "nothing is lost" in kept.out
    assert np.array_equal(OccupancyGrid.load(tmp_path / "kept.yaml").data, grid.data)
    lost = trundle("map", "convert", "grey.yaml", "-o", "lost.yaml", "--mode", "trinary")
    assert "lost: values: mode trinary does not keep 3 cells between free and occupied" in lost.out
    assert OccupancyGrid.load(tmp_path / "lost.yaml").data.tolist() == [[-1, 0, 0, -1, 100, 100]]


def test_there_and_back_through_movingai(trundle: Trundle, source: Path, tmp_path: Path) -> None:
    done = trundle("map", "convert", source, "-o", "noise.map", "--json")
    assert done.code == 0, done.err
    assert [loss["kind"] for loss in done.json["losses"]] == ["unknown", "resolution", "origin"]
    assert done.json["losses"][0]["cells"] == (VALUES == -1).sum()
    options = ("--source-resolution", "0.05", "--source-origin", "-1,-2")
    done = trundle("map", "convert", "noise.map", "-o", "back.yaml", *options)
    assert done.code == 0, done.err
    again = OccupancyGrid.load(tmp_path / "back.yaml")
    assert np.array_equal(again.data, np.where(VALUES == 0, 0, 100))
    assert (again.resolution, again.origin) == (0.05, Pose2D(-1.0, -2.0))


@pytest.mark.parametrize(
    ("negate", "occupied", "free", "compat"),
    [
        (0, 0.65, 0.196, None),
        (1, 0.65, 0.196, None),
        (0, 0.5, 0.5, None),
        (1, 0.9, 0.1, None),
        (0, 0.65, 0.25, "humble"),
    ],
)
@pytest.mark.filterwarnings("ignore::trundle.errors.MapWarning")
def test_what_is_read_is_kept(trundle: Trundle, tmp_path: Path, negate, occupied, free, compat) -> None:
    Image.fromarray(np.arange(256, dtype=np.uint8).reshape(16, 16)).save(tmp_path / "odd.png")
    text = YAML.format(image="odd.png", negate=negate, occupied=occupied, free=free)
    (tmp_path / "odd.yaml").write_text(text)
    done = trundle("map", "convert", "odd.yaml", "-o", "new.yaml", *(("--compat", compat) if compat else ()))
    assert done.code == 0, done.err
    expected = OccupancyGrid.load(tmp_path / "odd.yaml", compat=compat)
    for reader in (None, "humble"):
        assert np.array_equal(OccupancyGrid.load(tmp_path / "new.yaml", compat=reader).data, expected.data)


def test_cells_crop_yaw_and_a_second_map_at_once(trundle: Trundle, source: Path, tmp_path: Path) -> None:
    wall = OccupancyGrid(np.full((4, 40), 100), 0.05, Pose2D(-0.5, -1.5, 0.3))
    wall.save(tmp_path / "wall.yaml")
    done = trundle(
        "map", "convert", source, "wall.yaml", "-o", "out", "--resolution", "0.1", "--crop=-1,-2,0.5,-1", "--json"
    )
    assert done.code == 0, done.err
    report = done.json
    assert report["map"] == "out/map.yaml"
    assert (report["rows"], report["cols"], report["origin"]) == (10, 15, [-1, -2, 0])
    assert {loss["kind"] for loss in report["losses"]} == {"resampled", "cropped", "disagreement"}
    grid = OccupancyGrid.load(tmp_path / report["map"])
    x, y = wall.cell_to_world(*np.indices(wall.shape))
    row, col = grid.world_to_cell(x, y)
    inside = grid.contains(row, col)
    assert inside.any()
    assert (grid.data[row[inside], col[inside]] == 100).all()
    done = trundle("map", "convert", "wall.yaml", "-o", "aligned.yaml", "--align")
    assert OccupancyGrid.load(tmp_path / "aligned.yaml").origin.yaw == 0.0
    assert "lost: resampled: the map goes from cells of 0.05 m, turned by 17.19°," in done.out


def test_the_winner_of_a_merge_is_chosen(trundle: Trundle, source: Path, tmp_path: Path) -> None:
    OccupancyGrid(np.zeros_like(VALUES), 0.05, Pose2D(-1.0, -2.0)).save(tmp_path / "empty.yaml")
    for prefer, expected in (("occupied", np.where(VALUES == 100, 100, 0)), ("free", 0), ("first", 0)):
        done = trundle("map", "convert", "empty.yaml", source, "-o", f"{prefer}.yaml", "--prefer", prefer)
        assert done.code == 0, done.err
        assert (OccupancyGrid.load(tmp_path / f"{prefer}.yaml").data == expected).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("none.yaml", "-o", "new.yaml"), "none.yaml: no such file"),
        (("maps/noise.png", "-o", "new.yaml"), "give the map's YAML file"),
        (("maps/noise.yaml",), "--out"),
        (("maps/noise.yaml", "none.map", "-o", "new.yaml"), "none.map: no such file"),
        (("maps/noise.yaml", "-o", "new.png"), ".yaml or .yml or .map, or a folder"),
        (("maps/noise.yaml", "-o", "maps/noise.yaml"), "is a file of the source map maps/noise.yaml"),
        (("maps/noise.yaml", "-o", "maps/noise.yml"), "maps/noise.png is a file of the source map maps/noise.yaml"),
        (("maps/noise.yaml", "-o", "new.yaml", "--resolution", "0"), "resolution must be a positive number"),
        (("maps/noise.yaml", "-o", "new.yaml", "--resolution", "nan"), "resolution must be a positive number"),
        (("maps/noise.yaml", "-o", "new.yaml", "--resolution", "1e-6"), "more than 400000000 cells"),
        (
            ("maps/noise.yaml", "-o", "new.yaml", "--max-cells", "599"),
            "30 x 20 pixels need max_cells=600, and the limit is 599",
        ),
        (("maps/noise.yaml", "-o", "new.yaml", "--crop", "1,2,3"), "--crop '1,2,3': give X0,Y0,X1,Y1"),
        (("maps/noise.yaml", "-o", "new.yaml", "--crop", "1,0,0,1"), "smaller first"),
        (("maps/noise.yaml", "-o", "new.yaml", "--crop", "8,8,9,9"), "no part of the map lies in"),
        (("maps/noise.yaml", "-o", "new.yaml", "--mode", "gray"), "mode"),
        (("maps/noise.yaml", "-o", "new.map", "--mode", "raw"), "--mode is for ROS maps"),
        (("maps/noise.yaml", "-o", "new.yaml", "--source-resolution", "1"), "are for MovingAI maps"),
        (("maps/noise.yaml", "-o", "new.yaml", "--source-origin", "1,1"), "are for MovingAI maps"),
        (("maps/noise.yaml", "-o", "new.yaml", "--prefer", "best"), "prefer"),
    ],
)
def test_bad_input_leaves_nothing(
    trundle: Trundle, source: Path, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    before = {path.name: path.read_bytes() for path in source.parent.iterdir()}
    done = trundle("map", "convert", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert written(tmp_path) == []
    assert {path.name: path.read_bytes() for path in source.parent.iterdir()} == before


def test_inverted_thresholds_are_refused_with_their_place(trundle: Trundle, source: Path, tmp_path: Path) -> None:
    source.write_text(YAML.format(image="noise.png", negate=0, occupied=0.196, free=0.65))
    done = trundle("map", "convert", source, "-o", "new.yaml")
    assert done.code == 2
    assert "noise.yaml:6:14: free_thresh 0.65 is above occupied_thresh" in done.err
    assert written(tmp_path) == []


def test_unknown_that_loads_as_free_is_warned_of(trundle: Trundle, source: Path) -> None:
    source.write_text(YAML.format(image="noise.png", negate=0, occupied=0.65, free=0.25))
    with pytest.warns(UserWarning, match="of them load as free"):
        assert trundle("map", "convert", source, "-o", "new.yaml").code == 0
