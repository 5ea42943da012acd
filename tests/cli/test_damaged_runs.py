"""`trundle replay --json` of a run's folder in which one file is damaged: it replays, or names the file."""

import json
import shutil

import pytest

from trundle.cli.entry import run_command
from trundle.cli.shared.termination import BAD_INPUT, DONE

FILES = (pytest.param("episode.json", marks=pytest.mark.slow), "scenario.yaml", "trajectory.npz", "paths.npz")
VALUES = (None, "x", -1, [], {}, float("inf"), 10**400)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("runs") / "run"
    assert run_command(["run", "office", "--seed", "1", "--no-video", "--quiet", "--out", str(place)]) == DONE
    return place


def damages(content, is_record):
    yield from (content[: len(content) // 2], b"", b"\xff\xfe\x00" + content, b"[1, 2]", b"null")
    if is_record:
        values = json.loads(content)
        for name in values:
            yield json.dumps({key: value for key, value in values.items() if key != name}).encode()
            yield from (json.dumps({**values, name: value}).encode() for value in VALUES)


@pytest.mark.parametrize("name", FILES)
def test_a_damaged_file_is_named(name, folder, tmp_path, capsys):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    content = (folder / name).read_bytes()
    capsys.readouterr()
    for damage in damages(content, name == "episode.json"):
        (copy / name).write_bytes(damage)
        code = run_command(["replay", str(copy), "--json"])
        captured = capsys.readouterr()
        assert code in (DONE, BAD_INPUT)
        if code == BAD_INPUT:
            assert name in captured.err or str(copy) in captured.err
            assert len(captured.err.splitlines()) <= 8
