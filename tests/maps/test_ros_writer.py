from __future__ import annotations

import math
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from trundle.errors import MapError, OutputError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.ros_writer import find_map_of, is_as_written

finite = st.floats(-1e6, 1e6, allow_nan=False)
resolutions = st.floats(1e-3, 1e3)


def saved_and_loaded(grid: OccupancyGrid, mode: str, image_format: str) -> OccupancyGrid:
    with tempfile.TemporaryDirectory() as folder:
        grid.save(Path(folder) / "map.yaml", mode=mode, image_format=image_format)
        return OccupancyGrid.load(Path(folder) / "map.yaml")


@settings(max_examples=60, deadline=None)
@given(
    data=hnp.arrays(np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.integers(-1, 100)),
    resolution=resolutions,
    origin=st.tuples(finite, finite, st.floats(-math.pi, math.pi)),
    image_format=st.sampled_from(["png", "pgm"]),
)
def test_raw_keeps_every_value_and_every_digit(data, resolution, origin, image_format):
    grid = OccupancyGrid(data, resolution, Pose2D(*origin))
    again = saved_and_loaded(grid, "raw", image_format)
    assert np.array_equal(again.data, grid.data)
    assert (again.resolution, again.origin) == (grid.resolution, grid.origin)


@settings(max_examples=60, deadline=None)
@given(
    data=hnp.arrays(
        np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.sampled_from([-1, 0, 100])
    ),
    image_format=st.sampled_from(["png", "pgm"]),
    mode=st.sampled_from(["trinary", "scale", "raw"]),
)
def test_free_occupied_and_unknown_survive_in_every_mode(data, image_format, mode):
    if mode == "scale":
        image_format = "png"
    assert np.array_equal(saved_and_loaded(OccupancyGrid(data, 0.05), mode, image_format).data, data)


RAMP = OccupancyGrid(np.arange(-1, 101, dtype=np.int8)[None, :], 0.05)


def test_trinary_rounds_by_its_thresholds_as_nav2_does():
    values = RAMP.data
    expected = np.where(values >= 65, 100, np.where((values >= 0) & (values <= 20), 0, -1))
    assert np.array_equal(saved_and_loaded(RAMP, "trinary", "png").data, expected)


def test_scale_keeps_the_order_of_shades():
    again = saved_and_loaded(RAMP, "scale", "png").data[0].astype(int)
    assert again[0] == -1
    assert (np.diff(again[1:]) >= 0).all()
    assert len(np.unique(again[1:])) > 40


@pytest.mark.parametrize("edit", ["image", "yaml", "after", "no hash", "no image"])
def test_a_map_that_was_edited_is_told_from_one_that_was_not(tmp_path, edit):
    grid, file = OccupancyGrid(np.zeros((4, 5), dtype=np.int8), 0.05), tmp_path / "map.yaml"
    grid.save(file)
    assert is_as_written(file)
    text = file.read_text()
    if edit == "image":
        Image.new("L", (5, 4), 0).save(tmp_path / "map.png")
    elif edit == "no image":
        (tmp_path / "map.png").unlink()
    else:
        edits = {"yaml": text.replace("0.65", "0.6"), "after": f"{text}# mine\n", "no hash": text.partition("#")[0]}
        file.write_text(edits[edit])
    assert not is_as_written(file)


def test_what_is_written(tmp_path):
    grid = OccupancyGrid(np.array([[0, 100, -1], [-1, 0, 0]]), 0.0125, Pose2D(-1.23456789, 1e-7, 0.1))
    grid.save(tmp_path / "map.yaml")
    *lines, told = (tmp_path / "map.yaml").read_text().splitlines(keepends=True)
    assert re.fullmatch("# sha256 of these lines and the image, as trundle wrote them: [0-9a-f]{64}\n", told)
    assert "".join(lines) == (
        "image: map.png\nmode: trinary\nresolution: 0.0125\norigin: [-1.23456789, 1e-07, 0.1]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with Image.open(tmp_path / "map.png") as image:
        assert image.mode == "L"
        assert np.asarray(image).tolist() == [[205, 254, 254], [254, 0, 205]]
    grid.save(tmp_path / "raw.yml", mode="raw", image_format="pgm")
    assert (tmp_path / "raw.pgm").read_bytes() == b"P5\n3 2\n255\n\xff\x00\x00\x00\x64\xff"
    grid.save(tmp_path / "scale.yaml", mode="scale")
    with Image.open(tmp_path / "scale.png") as image:
        assert image.mode == "RGBA"
        assert np.asarray(image)[1].tolist() == [[255, 255, 255, 255], [0, 0, 0, 255], [128, 128, 128, 0]]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "map.png",
        "map.yaml",
        "raw.pgm",
        "raw.yml",
        "scale.png",
        "scale.yaml",
    ]


@pytest.mark.parametrize("name", ["a b.yaml", "0815.yaml", "#1.yaml", "a: b.yaml", "'x'.yaml", 'q"q.yaml', "ä.yaml"])
def test_any_file_name_is_quoted_so_that_it_reads_back(tmp_path, name):
    grid = OccupancyGrid(np.array([[0, 100]]), 0.05)
    grid.save(tmp_path / name)
    assert np.array_equal(OccupancyGrid.load(tmp_path / name).data, grid.data)
    assert yaml.safe_load((tmp_path / name).read_text())["image"] == Path(name).with_suffix(".png").name


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("map.png", {}, "end the name in .yaml"),
        ("map", {}, "end the name in .yaml"),
        ("map.yaml", {"mode": "Trinary"}, "mode is 'Trinary'"),
        ("map.yaml", {"image_format": "bmp"}, "image_format is 'bmp'"),
        ("map.yaml", {"mode": "scale", "image_format": "pgm"}, "save as png"),
    ],
)
def test_what_cannot_be_saved_leaves_nothing(tmp_path, name, options, message):
    with pytest.raises(MapError, match=message):
        RAMP.save(tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_an_output_error(tmp_path):
    with pytest.raises(OutputError, match="cannot write"):
        RAMP.save(tmp_path / "nowhere" / "map.yaml")


@pytest.mark.parametrize(
    "line", ["image: map.png", 'image: "map.png"', "image: './map.png'  # drawn", "image:   map.png "]
)
def test_the_map_of_an_image_is_found_by_its_yaml(tmp_path, line):
    (tmp_path / "map.png").touch()
    (tmp_path / "notes.yaml").write_text("image: my_map.png\n# map.png\n")
    assert find_map_of(tmp_path / "map.png") is None
    (tmp_path / "site.yaml").write_text(f"{line}\nresolution: 0.05\n")
    assert find_map_of(tmp_path / "map.png") == tmp_path / "site.yaml"
