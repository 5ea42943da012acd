"""A map is replaced as one: whatever stops a save, the old map or the new one is there."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from trundle.errors import OutputError
from trundle.files.writing import write_text
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

RAMP = OccupancyGrid(np.arange(-1, 101, dtype=np.int8)[None, :], 0.05)
ROOM = OccupancyGrid(np.array([[100, 0, 100]]), 0.05)
MOVED_ROOM = OccupancyGrid(np.array([[100, 0, 0]]), 0.05, Pose2D(2.0, 0.0))

SCRIPT = """
import sys
from pathlib import Path
import numpy as np
from support.killed import kill_at_every_step
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

folder = Path(sys.argv[1])
old = OccupancyGrid(np.array([[100, 0, 100]]), 0.05)
new = OccupancyGrid(np.array([[100, 0, 0]]), 0.05, Pose2D(2.0, 0.0))
OccupancyGrid.load  # imported here, not in the forks
old.save(folder / "warm.yaml"), OccupancyGrid.load(folder / "warm.yaml")
seen = []

def prepare():
    for path in folder.iterdir():
        path.unlink()
    for grid in %s:
        grid.save(folder / "map.yaml")

def check(step):
    if not %s and not (folder / "map.yaml").exists():
        seen.append("nothing")
        return
    grid = OccupancyGrid.load(folder / "map.yaml")
    (which,) = [name for name, one in (("old", old), ("new", new))
                if np.array_equal(grid.data, one.data) and grid.origin == one.origin]
    seen.append(which)

kill_at_every_step(prepare, lambda: new.save(folder / "map.yaml"), check)
print(*seen)
print(*sorted(path.name for path in folder.iterdir()))
"""


@pytest.mark.parametrize("before", ["[]", "[old]", "[new, old]"])
def test_a_kill_at_any_step_leaves_the_old_map_or_the_new_one(tmp_path: Path, before: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT % (before, before), str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
        check=True,
    )
    seen, names = (line.split() for line in done.stdout.splitlines())
    assert len(seen) > 8
    left = "nothing" if before == "[]" else "old"
    assert seen == [left] * seen.count(left) + ["new"] * seen.count("new")
    assert min(seen.count(left), seen.count("new")) >= 2, "it was killed on both sides of the commit"
    assert len(names) == 2, "the old image is gone, and so is every temporary file"


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_a_map_that_is_replaced_takes_its_old_image_along(tmp_path: Path) -> None:
    ROOM.save(tmp_path / "map.yaml")
    assert names(tmp_path) == {"map.yaml", "map.png"}
    MOVED_ROOM.save(tmp_path / "map.yaml")
    (image,) = names(tmp_path) - {"map.yaml"}
    assert image != "map.png"
    assert yaml.safe_load((tmp_path / "map.yaml").read_text())["image"] == image
    RAMP.save(tmp_path / "map.yaml")
    assert names(tmp_path) == {"map.yaml", "map.png"}
    ROOM.save(tmp_path / "map.yaml", image_format="pgm")
    assert names(tmp_path) == {"map.yaml", "map.pgm"}
    assert np.array_equal(OccupancyGrid.load(tmp_path / "map.yaml").data, ROOM.data)


def test_images_that_belong_to_others_stay(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"a picture of mine")
    ROOM.save(tmp_path / "map.yaml")
    assert (tmp_path / "map.png").read_bytes() == b"a picture of mine"
    (image,) = names(tmp_path) - {"map.yaml", "map.png"}
    # A second map shows the same cells elsewhere.
    write_text(tmp_path / "other.yaml", (tmp_path / "map.yaml").read_text().replace("origin: [0", "origin: [9"))
    MOVED_ROOM.save(tmp_path / "map.yaml")
    assert image in names(tmp_path)
    assert np.array_equal(OccupancyGrid.load(tmp_path / "other.yaml").data, ROOM.data)
    (tmp_path / "p.yaml").write_text("image: map.png\n")
    ROOM.save(tmp_path / "p.yaml")
    assert "map.png" in names(tmp_path)


def test_an_image_that_was_edited_is_not_taken_for_its_content(tmp_path: Path) -> None:
    ROOM.save(tmp_path / "map.yaml")
    MOVED_ROOM.save(tmp_path / "map.yaml")
    (image,) = names(tmp_path) - {"map.yaml"}
    RAMP.save(tmp_path / "other.yaml")
    (tmp_path / image).write_bytes((tmp_path / "other.png").read_bytes())
    (tmp_path / "map.png").write_bytes(b"")
    MOVED_ROOM.save(tmp_path / "map.yaml")
    assert np.array_equal(OccupancyGrid.load(tmp_path / "map.yaml").data, MOVED_ROOM.data)


@pytest.mark.parametrize("text", ["[" * 50_000, "image: [1]", "- 1", "\x00", "image: ../map.png"])
def test_a_damaged_map_can_be_replaced(tmp_path: Path, text: str) -> None:
    (tmp_path / "map.yaml").write_text(text)
    ROOM.save(tmp_path / "map.yaml")
    assert np.array_equal(OccupancyGrid.load(tmp_path / "map.yaml").data, ROOM.data)


@pytest.mark.parametrize("step", ["write_text", "write_new_bytes"])
def test_a_failure_leaves_the_old_map_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    RAMP.save(tmp_path / "map.yaml")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(*_: object, **__: object) -> None:
        raise OutputError("disk full")

    monkeypatch.setattr(f"trundle.maps.ros_writer.{step}", fail)
    with pytest.raises(OutputError):
        RAMP.save(tmp_path / "map.yaml", mode="raw")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_saved_map_is_on_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    monkeypatch.setattr(os, "fsync", synced.append)
    ROOM.save(tmp_path / "map.yaml")
    assert len(synced) == 4, "image, folder, YAML, folder"
