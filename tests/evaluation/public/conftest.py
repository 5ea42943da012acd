import pytest

from support.public_worlds import write_barn, write_dynabarn


@pytest.fixture
def barn(tmp_path):
    folder = tmp_path / "BARN"
    for number in (0, 7):
        write_barn(folder, number)
    return folder


@pytest.fixture
def dynabarn(tmp_path):
    write_dynabarn(tmp_path / "worlds.json")
    return tmp_path / "worlds.json"
