import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from trundle.cli.entry import run_command
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid


@dataclass(frozen=True)
class Done:
    """A finished command: its exit code and what it printed."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        """The one JSON value on stdout."""
        return json.loads(self.out)


Trundle = Callable[..., Done]


@pytest.fixture
def trundle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Trundle:
    """Run `trundle …` in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Done:
        capsys.readouterr()
        code = run_command([str(argument) for argument in arguments])
        sys.stdout.flush()
        out, err = capsys.readouterr()
        return Done(code, out, err)

    return run


def room(width_m: float = 8.0, depth_m: float = 5.0, door_m: float | None = None) -> OccupancyGrid:
    """A walled room with its lower-left corner at (-1, -1); with a door, a wall across it that has a gap so wide."""
    rows, cols = round(depth_m / 0.05), round(width_m / 0.05)
    data = np.zeros((rows, cols), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    if door_m is not None:
        half = round(door_m / 0.1)
        data[: rows // 2 - half, cols // 2] = data[rows // 2 + half :, cols // 2] = 100
    return OccupancyGrid(data, 0.05, Pose2D(-1.0, -1.0))


@pytest.fixture
def room_map(tmp_path: Path) -> Path:
    """The YAML of an 8 x 5 m room."""
    folder = tmp_path / "maps"
    folder.mkdir()
    room().save(folder / "room.yaml")
    return folder / "room.yaml"
