import sys
from pathlib import Path

import pytest

from support.command_line import Done, Trundle, room
from support.fake_isaac.fixtures import assets, fake, make_fake
from trundle.cli.entry import run_command

__all__ = ["assets", "fake", "make_fake", "room_map", "trundle"]


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


@pytest.fixture
def room_map(tmp_path: Path) -> Path:
    """The YAML of an 8 x 5 m room."""
    folder = tmp_path / "maps"
    folder.mkdir()
    room().save(folder / "room.yaml")
    return folder / "room.yaml"
