from __future__ import annotations

import math
import os
import struct
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support import png_samples
from trundle.errors import MapError, MapWarning
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

KEYS = {
    "image": "map.pgm",
    "resolution": "0.05",
    "origin": "[-1.5, 2.25, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
# Top row: free, unknown; bottom row: occupied, free.
PGM = b"P5 2 2 255\n\xfe\xcd\x00\xff"
CELLS = [[100, 0], [0, -1]]


def write_map(folder: Path, text: str | None = None, **changes: str | None) -> Path:
    """A map in `folder`; a key set to None is left out."""
    if text is None:
        fields = {**KEYS, **changes}
        text = "".join(f"{key}: {value}\n" for key, value in fields.items() if value is not None)
    (folder / "map.pgm").write_bytes(PGM)
    (folder / "map.yaml").write_text(text)
    return folder / "map.yaml"


def test_a_map_is_read_with_row_0_at_the_bottom(tmp_path):
    grid = OccupancyGrid.load(write_map(tmp_path))
    assert grid.data.tolist() == CELLS
    assert grid.data.dtype == np.int8
    assert not grid.data.flags.writeable
    assert grid.resolution == 0.05
    assert grid.origin == Pose2D(-1.5, 2.25, 0.0)


def test_the_yaw_is_honoured(tmp_path):
    grid = OccupancyGrid.load(str(write_map(tmp_path, origin="[1, 2, 1.5707963267948966]")))
    x, y = grid.cell_to_world(0, 1)
    assert (float(x), float(y)) == pytest.approx((1 - 0.025, 2 + 0.075))
    assert tuple(map(int, grid.world_to_cell(x, y))) == (0, 1)


def test_a_yaw_in_degrees_is_read_and_warned_of(tmp_path):
    with pytest.warns(MapWarning, match=r"map.yaml:3:16: origin's yaw is 90deg, which ROS does not read; write 1.5708"):
        assert OccupancyGrid.load(write_map(tmp_path, origin="[1, 2, 90deg]")).origin.yaw == math.pi / 2.0
    with pytest.warns(MapWarning, match=r"map.yaml:3:18: origin's yaw is 90 rad, more than one turn: .* 1.5708"):
        OccupancyGrid.load(write_map(tmp_path, origin="[1.0, 2, 90]"))


@pytest.mark.parametrize(
    ("changes", "resolution"),
    [
        ({"resolution": "5e-2"}, 0.05),
        ({"resolution": "'0.05'"}, 0.05),
        ({"resolution": '"5E-2"'}, 0.05),
        ({"resolution": "+.05"}, 0.05),
        ({"resolution": "1."}, 1.0),
        ({"resolution": "!!str 0.05"}, 0.05),
        ({"resolution": "0.0125"}, 0.0125),
    ],
)
def test_numbers_in_every_accepted_form(tmp_path, changes, resolution):
    assert OccupancyGrid.load(write_map(tmp_path, **changes)).resolution == resolution


@pytest.mark.parametrize("value", ["1", "2", "-1", "0x1", "true", "True", "TRUE", "yes", "on", "y", "Y", "'1'"])
def test_negate_true(tmp_path, value):
    grid = OccupancyGrid.load(write_map(tmp_path, negate=value))
    assert grid.data.tolist() == [[0, 100], [100, 100]]


@pytest.mark.parametrize("value", ["0", "00", "0x0", "false", "No", "OFF", "n", "'0'"])
def test_negate_false(tmp_path, value):
    assert OccupancyGrid.load(write_map(tmp_path, negate=value)).data.tolist() == CELLS


@pytest.mark.parametrize("value", ["trinary", "TRINARY", "'Trinary'"])
def test_modes_in_any_case(tmp_path, value):
    assert OccupancyGrid.load(write_map(tmp_path, mode=value)).data.tolist() == CELLS


def test_mode_raw_ignores_thresholds_and_negate(tmp_path):
    assert OccupancyGrid.load(write_map(tmp_path, mode="Raw", negate="1")).data.tolist() == [[0, -1], [-1, -1]]


def test_unknown_keys_are_ignored_and_the_first_of_a_repeated_key_counts(tmp_path):
    extra = "resolution: 7\nResolution: x\ncost: {a: 1, a: 2}\n? [1, 2]\n: 3\nimage: other.png\n"
    path = write_map(tmp_path, "".join(f"{key}: {value}\n" for key, value in KEYS.items()) + extra)
    assert OccupancyGrid.load(path).resolution == 0.05


def test_compat_humble_lets_occupied_win_and_compares_strictly(tmp_path):
    path = write_map(tmp_path, occupied_thresh="1.0")
    assert OccupancyGrid.load(path).data.tolist() == CELLS
    assert OccupancyGrid.load(path, compat="humble").data.tolist() == [[-1, 0], [0, -1]]


def line_of(key: str) -> int:
    return list(KEYS).index(key) + 1


@pytest.mark.parametrize(
    ("key", "value", "column", "message"),
    [
        ("resolution", "0", 13, "resolution is 0"),
        ("resolution", "-0.05", 13, "resolution is -0.05"),
        ("resolution", "1e-9", 13, "resolution is 1e-09"),
        ("resolution", "1e9", 13, "resolution is 1e[+]09"),
        ("resolution", "1e999", 13, "too large"),
        ("resolution", ".nan", 13, "finite number"),
        ("resolution", "nan", 13, "finite number"),
        ("resolution", "inf", 13, "finite number"),
        ("resolution", "0x10", 13, "'0x10'; it must be a finite number"),
        ("resolution", "0,05", 13, "finite number"),
        ("resolution", "1_0", 13, "finite number"),
        ("resolution", "٣", 13, "finite number"),
        ("resolution", "", 12, "blank"),
        ("resolution", "[0.05]", 13, "a list"),
        ("resolution", "{a: 1}", 13, "a mapping"),
        ("resolution", "5 cm", 13, "'5 cm'"),
        ("origin", "[0, 0]", 9, "2 values"),
        ("origin", "[0, 0, 0, 0]", 9, "4 values"),
        ("origin", "0", 9, "one value"),
        ("origin", "{x: 0}", 9, "a mapping"),
        ("origin", "[0, .nan, 0]", 13, "origin's y"),
        ("origin", "[0, 0, [0]]", 16, "origin's yaw"),
        ("origin", "[abc, 0, 0]", 10, "origin's x is 'abc'"),
        ("negate", "maybe", 9, "'maybe'; it must be 0 or 1"),
        ("negate", "tRuE", 9, "it must be 0 or 1"),
        ("negate", "0.5", 9, "it must be 0 or 1"),
        ("negate", "", 8, "blank"),
        ("negate", "99999999999999999999", 9, "it must be 0 or 1"),
        ("occupied_thresh", "1.01", 18, "occupied_thresh is 1.01"),
        ("occupied_thresh", "65", 18, "occupied_thresh is 65; it must be between 0 and 1"),
        ("occupied_thresh", ".nan", 18, "finite"),
        ("free_thresh", "-0.1", 14, "free_thresh is -0.1"),
        ("free_thresh", "0.7", 14, "above occupied_thresh 0.65"),
        ("image", "", 7, "image is blank"),
        ("image", "~", 8, "image is blank"),
        ("image", '""', 8, "image is blank"),
        ("image", "[a.png]", 8, "must be text"),
        ("image", "none.png", 8, "image file .* does not exist"),
        ("image", ".", 8, "image file .* does not exist"),
        ("image", '"a\\0b.png"', 8, "not a valid file name"),
        ("image", "x" * 5000, 8, "not a valid file name|image file .* does not exist"),
        ("image", "../map.pgm", 8, "outside the map's folder"),
        ("image", "/etc/hostname", 8, "outside the map's folder"),
    ],
)
def test_a_value_that_cannot_be_is_refused_with_its_place(tmp_path, key, value, column, message):
    path = write_map(tmp_path, **{key: value})
    with pytest.raises(MapError, match=message) as caught:
        OccupancyGrid.load(path)
    assert str(caught.value).startswith(f"{path}:{line_of(key)}:{column}: ")


@pytest.mark.parametrize("value", ["ternary", "1", "[raw]", ""])
def test_a_mode_that_is_none_is_refused(tmp_path, value):
    with pytest.raises(MapError, match=r"map\.yaml:7:[67]: mode "):
        OccupancyGrid.load(write_map(tmp_path, mode=value))


@pytest.mark.parametrize("key", list(KEYS))
def test_a_missing_key_is_named(tmp_path, key):
    with pytest.raises(MapError, match=rf"map\.yaml:1:1: the key '{key}' is missing;"):
        OccupancyGrid.load(write_map(tmp_path, **{key: None}))


def test_a_key_in_another_case_is_missing_and_pointed_out(tmp_path):
    with pytest.raises(MapError, match="'Resolution' is written differently"):
        OccupancyGrid.load(write_map(tmp_path, resolution=None, Resolution="0.05"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("# nothing\n", "the file is empty"),
        ("just text", "not a map's YAML file"),
        ("- a\n- b\n", "not a map's YAML file"),
        ("image: [unclosed", "not valid YAML"),
        ("a: b: c", "map.yaml:1:5: not valid YAML"),
        ("image: \x07", "not valid YAML"),
        ("a: 1\n---\nb: 2\n", "not valid YAML"),
        ("image: &a map.pgm\nother: *a\n", "anchors and aliases"),
        ("image: *nowhere\n", "anchors and aliases"),
        ("x: " + "[" * 3000, "nested more than"),
        ("# " + "x" * 100_000, "larger than 100000 bytes"),
    ],
)
def test_a_file_that_is_no_map_is_refused(tmp_path, text, message):
    with pytest.raises(MapError, match=message):
        OccupancyGrid.load(write_map(tmp_path, text))


def test_an_alias_bomb_is_refused_at_once(tmp_path):
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
        f"{new}: &{new} [{','.join(['*' + old] * 9)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
    )
    with pytest.raises(MapError, match="anchors and aliases"):
        OccupancyGrid.load(write_map(tmp_path, bomb))


def test_missing_unreadable_and_foreign_files(tmp_path):
    with pytest.raises(MapError, match=r"cannot read .*nowhere.yaml: no such file"):
        OccupancyGrid.load(tmp_path / "nowhere.yaml")
    with pytest.raises(MapError, match=r"cannot read .*: Is a directory"):
        OccupancyGrid.load(tmp_path)
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(MapError, match="not a text file in UTF-8"):
        OccupancyGrid.load(tmp_path / "binary.yaml")
    with pytest.raises(MapError, match="is an image; give the map's YAML file"):
        OccupancyGrid.load(write_map(tmp_path).with_suffix(".pgm"))
    with pytest.raises(MapError, match="compat is 'foxy'; it must be \"humble\""):
        OccupancyGrid.load(write_map(tmp_path), compat="foxy")


def test_a_byte_order_mark_is_skipped(tmp_path):
    path = write_map(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert OccupancyGrid.load(path).data.tolist() == CELLS


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "image file is empty"),
        (b"GIF89a", "not a PNG, PNM"),
        (b"\x89PNG\r\n\x1a\n", "truncated"),
        (PGM[:-1], "truncated"),
        (b"P2 20000 20001 255\n", "pixels need max_cells="),
        (b"P5 2147483647 2147483647 255\n", "pixels need max_cells="),
        (b"P6 20000 20000 65535\n", "pixels need max_cells="),
        (b"P5 " + b"#" * 70_000, "truncated"),
        (b"P2 1 1 255\n1 " + b" " * 2**17, "far longer"),
    ],
)
def test_an_image_that_cannot_be_read_is_refused(tmp_path, content, message):
    path = write_map(tmp_path)
    (tmp_path / "map.pgm").write_bytes(content)
    with pytest.raises(MapError, match=r"map\.pgm: .*" + message):
        OccupancyGrid.load(path)


def test_a_huge_png_is_refused_before_it_is_decoded(tmp_path):
    header = struct.pack(">IIBBBBB", 30000, 30000, 8, 0, 0, 0, 0)
    path = write_map(tmp_path)
    (tmp_path / "map.pgm").write_bytes(png_samples.SIGNATURE + png_samples.chunk(b"IHDR", header) + bytes(100))
    with pytest.raises(MapError, match="30000 x 30000 pixels need max_cells=900000000"):
        OccupancyGrid.load(path)


def test_the_format_follows_from_the_content(tmp_path):
    path = write_map(tmp_path)
    Image.fromarray(np.array([[254, 205], [0, 255]], dtype=np.uint8)).save(tmp_path / "map.pgm", format="PNG")
    assert OccupancyGrid.load(path).data.tolist() == CELLS


def test_the_image_stays_in_the_maps_folder_unless_allowed(tmp_path):
    folder, other = tmp_path / "maps", tmp_path / "other"
    folder.mkdir()
    other.mkdir()
    (other / "map.pgm").write_bytes(PGM)
    for image in ("../other/map.pgm", str(other / "map.pgm"), "sub/../../other/map.pgm"):
        path = write_map(folder, image=image)
        with pytest.raises(MapError, match="allow_outside=True"):
            OccupancyGrid.load(path)
        assert OccupancyGrid.load(path, allow_outside=True).data.tolist() == CELLS
    (folder / "link.pgm").symlink_to(other / "map.pgm")
    with pytest.raises(MapError, match="outside the map's folder"):
        OccupancyGrid.load(write_map(folder, image="link.pgm"))
    (folder / "loop.pgm").symlink_to("loop.pgm")
    with pytest.raises(MapError, match=r"not a valid file name|image file .* does not exist"):
        OccupancyGrid.load(write_map(folder, image="loop.pgm"))


def test_images_inside_the_folder_may_be_deep_or_absolute(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "a.pgm").write_bytes(PGM)
    for image in ("deep/a.pgm", str(tmp_path / "deep" / "a.pgm"), "deep/../map.pgm"):
        assert OccupancyGrid.load(write_map(tmp_path, image=image)).data.tolist() == CELLS


def test_a_device_or_pipe_is_no_image(tmp_path):
    with pytest.raises(MapError, match=r"image file .* does not exist"):
        OccupancyGrid.load(write_map(tmp_path, image="/dev/zero"), allow_outside=True)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(MapError, match=r"image file .* does not exist"):
        OccupancyGrid.load(write_map(tmp_path, image="pipe"))


def test_unknown_that_loads_as_free_is_warned_of(tmp_path):
    path = write_map(tmp_path, free_thresh="0.25")
    message = r"map\.yaml:6:14: free_thresh 0.25 is above .* 1 of them load as free. Use 0.196"
    for compat in (None, "humble"):
        with pytest.warns(MapWarning, match=message) as caught:
            grid = OccupancyGrid.load(path, compat=compat)
        assert grid.data.tolist() == [[100, 0], [0, 0]]
        assert caught[0].filename == __file__


def test_no_warning_without_such_cells_or_where_they_mean_something_else(tmp_path):
    path = write_map(tmp_path, free_thresh="0.25")
    (tmp_path / "map.pgm").write_bytes(b"P5 2 1 255\n\xfe\xcc")
    OccupancyGrid.load(path)
    OccupancyGrid.load(write_map(tmp_path, free_thresh="0.25", negate="1"))
    OccupancyGrid.load(write_map(tmp_path, free_thresh="0.25", mode="raw"))


def test_pgm_maps_import_neither_an_image_library_nor_pydantic(tmp_path):
    path = write_map(tmp_path)
    Image.fromarray(np.array([[254, 205], [0, 255]], dtype=np.uint8)).save(tmp_path / "map.pgm", format="PPM")
    code = f"""
    import sys
    import trundle.maps
    assert not {{"PIL", "pydantic", "yaml"}} & set(sys.modules), "at import"
    grid = trundle.maps.OccupancyGrid.load({str(path)!r})
    grid.save({str(tmp_path / "copy.yaml")!r}, image_format="pgm")
    assert not {{"PIL", "pydantic"}} & set(sys.modules), "after loading"
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=True)


def test_a_file_of_another_kind_is_called_what_it_is(tmp_path):
    (tmp_path / "mission.yaml").write_text("world: warehouse\ngoal: [1, 2]\n")
    with pytest.raises(MapError) as caught:
        OccupancyGrid.load(tmp_path / "mission.yaml")
    assert str(caught.value) == f"{tmp_path / 'mission.yaml'}: this is a scenario, not a map"
