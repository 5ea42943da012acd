from __future__ import annotations

import numpy as np
import pytest

from trundle.errors import InputError, WorldError, WorldWarning
from trundle.files.uris import split_folders
from trundle.maps import OccupancyGrid
from trundle.worlds import World
from trundle.worlds.load import LOADERS


@pytest.mark.parametrize("suffix", [".txt", ""])
def test_an_unknown_suffix_is_refused_with_the_known_ones(tmp_path, suffix):
    with pytest.raises(WorldError, match=r"the suffix of a world file must be one of .*\.yaml"):
        World.load(tmp_path / f"hall{suffix}")


@pytest.mark.parametrize("suffix", LOADERS)
def test_a_missing_file_is_named(tmp_path, suffix):
    with pytest.raises(WorldError, match=r"hall.*: no such file"):
        World.load(tmp_path / f"hall{suffix}")


def test_a_folder_is_no_world(tmp_path):
    (tmp_path / "hall.yaml").mkdir()
    with pytest.raises(WorldError, match="Is a directory; give the file of a world"):
        World.load(tmp_path / "hall.yaml")


def test_an_unknown_option_is_refused_with_the_known_ones(tmp_path):
    OccupancyGrid(np.zeros((2, 2), dtype=np.int8), 1.0).save(tmp_path / "m.yaml")
    with pytest.raises(InputError, match=r"'tall' is not an option of a \.yaml file; .*: height, unknown, compat"):
        World.load(tmp_path / "m.yaml", tall=2.0)
    with pytest.raises(InputError, match=r"'path' is not an option"):
        World.load(tmp_path / "m.yaml", path="other")
    with pytest.raises(InputError, match=r"did you mean 'height'\?"):
        World.load(tmp_path / "m.yaml", hieght=2.0)


def test_an_empty_world_is_said(tmp_path):
    OccupancyGrid(np.zeros((2, 2), dtype=np.int8), 1.0).save(tmp_path / "m.yaml")
    with pytest.warns(WorldWarning, match="contains no solids"):
        assert World.load(tmp_path / "m.yaml").solids == ()


def test_a_world_of_kilometres_is_said_with_what_reaches_farthest(tmp_path):
    data = np.zeros((2, 4), dtype=np.int8)
    data[0, 0] = data[1, 3] = 100
    OccupancyGrid(data, 1000.0).save(tmp_path / "m.yaml")
    with pytest.warns(WorldWarning, match=r"4000 x 2000 x 1 m; 'map\[.*\]' reaches farthest"):
        World.load(tmp_path / "m.yaml")


def test_folders_are_split_as_the_system_does(monkeypatch):
    monkeypatch.setattr("os.pathsep", ":")
    assert [str(folder) for folder in split_folders("a:b/c")] == ["a", "b/c"]
    assert [str(folder) for folder in split_folders(["a:b"])] == ["a:b"]
