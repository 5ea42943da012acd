"""Parameter files for the tests."""

from pathlib import Path

import pytest

from support.command_line import room


@pytest.fixture
def write(tmp_path):
    """Write a parameter file."""

    def write(text: str, name: str = "nav2_params.yaml") -> Path:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="module")
def map_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "room.yaml"
    room().save(path)
    return path
