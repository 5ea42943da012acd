from __future__ import annotations

import numpy as np
import pytest

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.movingai import MovingAIQuery, load_map, load_scenarios

MAP = "type octile\nheight 2\nwidth 4\nmap\n.GS@\nOTW.\n"


def write(tmp_path, text: str, name: str = "a.map"):
    path = tmp_path / name
    path.write_bytes(text.encode())
    return path


@pytest.mark.parametrize("text", [MAP, MAP.replace("\n", "\r\n"), MAP.rstrip("\n"), MAP + "\n\n"])
def test_a_map_is_read_with_its_last_row_at_the_bottom(tmp_path, text):
    grid = load_map(write(tmp_path, text))
    assert grid.data.tolist() == [[100, 100, 100, 0], [0, 0, 0, 100]]
    assert (grid.resolution, grid.origin) == (1.0, Pose2D(0.0, 0.0, 0.0))


def test_the_grid_class_knows_them_by_suffix_and_the_resolution_may_be_given(tmp_path):
    path = write(tmp_path, MAP)
    assert OccupancyGrid.load(path).shape == (2, 4)
    assert load_map(path, resolution=0.25).resolution == 0.25


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("", ":1:1", "not a MovingAI map"),
        ("hello\nworld\n", ":1:1", "not a MovingAI map"),
        ("type octile\nwidth 4\nmap\n....\n", ":3:1", "no height"),
        ("type octile\nmap\n....\n", ":2:1", "no height and no width"),
        (MAP.replace("height 2", "height 0"), ":2:8", "must be an integer"),
        (MAP.replace("height 2", "height -2"), ":2:8", "must be an integer"),
        (MAP.replace("height 2", "height 2.5"), ":2:8", "must be an integer"),
        (MAP.replace("width 4", "width 9999999999"), ":3:7", "must be an integer"),
        (MAP.replace("height 2", "height 3"), ":6:1", "after 2 of 3 rows"),
        (MAP.replace("width 4", "width 5"), ":5:5", "the row has 4 cells"),
        (MAP.replace("width 4", "width 3"), ":5:4", "the row has 4 cells"),
        (MAP.replace("OTW.", "OTx."), ":6:3", "unknown terrain 'x'"),
        (MAP.replace("height 2", "height 99999").replace("width 4", "width 99999"), "", "cells need max_cells="),
    ],
)
def test_a_damaged_map_is_refused_with_its_place(tmp_path, text, place, message):
    path = write(tmp_path, text)
    with pytest.raises(MapError, match=message) as caught:
        load_map(path)
    assert str(caught.value).startswith(f"{path}{place}: ")


def test_a_map_is_written_with_its_top_row_first_and_what_is_not_free_blocked(tmp_path):
    data = np.array([[-1, 0, 20], [21, 64, 100]])
    OccupancyGrid(data, 0.5, Pose2D(1.0, 2.0)).save(tmp_path / "a.map")
    assert (tmp_path / "a.map").read_text() == "type octile\nheight 2\nwidth 3\nmap\n@@@\n@..\n"
    assert load_map(tmp_path / "a.map").data.tolist() == [[100, 0, 0], [100, 100, 100]]


def test_a_map_has_no_mode(tmp_path):
    with pytest.raises(MapError, match="has no mode raw"):
        OccupancyGrid(np.zeros((1, 1), dtype=np.int8), 1.0).save(tmp_path / "a.map", mode="raw")
    assert list(tmp_path.iterdir()) == []


def test_scenarios_are_read_in_our_rows(tmp_path):
    text = "version 1\n0\tmaps/a.map\t4\t2\t0\t0\t3\t1\t3.41421356\n12\tb c.map\t4\t2\t1\t1\t2\t0\t1\n\n"
    queries = load_scenarios(write(tmp_path, text, "a.scen"))
    assert queries == [
        MovingAIQuery(0, "maps/a.map", 4, 2, (1, 0), (0, 3), 3.41421356),
        MovingAIQuery(12, "b c.map", 4, 2, (0, 1), (1, 2), 1.0),
    ]


def test_scenarios_without_a_version_and_with_spaces_are_read(tmp_path):
    assert load_scenarios(write(tmp_path, "0 a.map 4 2 0 0 3 1 3.5\n"))[0].goal == (0, 3)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("0\ta.map\t4\t2\t0\t0\t3\t1", "this line has 8"),
        ("x\ta.map\t4\t2\t0\t0\t3\t1\t3.4", "not a number"),
        ("0\ta.map\t4\t2\t0\t0\t3\t1\tnan", "optimal length"),
        ("0\ta.map\t4\t2\t0\t0\t3\t1\t-1", "optimal length"),
        ("0\ta.map\t4\t2\t4\t0\t3\t1\t1", "start \\(4, 0\\) is outside"),
        ("0\ta.map\t4\t2\t0\t0\t3\t2\t1", "goal \\(3, 2\\) is outside"),
        ("0\ta.map\t4\t2\t0\t-1\t3\t1\t1", "start \\(0, -1\\) is outside"),
    ],
)
def test_a_damaged_query_is_refused_with_its_line(tmp_path, line, message):
    with pytest.raises(MapError, match=rf"a\.scen:2:1: .*{message}"):
        load_scenarios(write(tmp_path, "version 1\n" + line + "\n", "a.scen"))


def test_missing_empty_and_binary_files(tmp_path):
    with pytest.raises(MapError, match=r"cannot read .*: no such file"):
        load_map(tmp_path / "none.map")
    with pytest.raises(MapError, match="no queries"):
        load_scenarios(write(tmp_path, "version 1\n", "a.scen"))
    (tmp_path / "b.scen").write_bytes(b"version 1\n\xff\n")
    with pytest.raises(MapError, match=r"b.scen:2:1: not UTF-8 text"):
        load_scenarios(tmp_path / "b.scen")
