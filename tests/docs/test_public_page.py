"""docs/public_benchmarks.md: its file loads, its Python runs, and its commands are understood."""

import re
import shlex
from pathlib import Path

import pytest

from support.public_worlds import write_barn
from trundle.cli.entry import run_command
from trundle.worlds import World

PAGE = (Path(__file__).parents[2] / "docs" / "public_benchmarks.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_the_file_of_worlds_loads(tmp_path):
    (text,) = blocks("json")
    (tmp_path / "worlds.json").write_text(text)
    assert len(World.load(tmp_path / "worlds.json").movers) == 1


def test_the_python_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number in (0, 15):
        write_barn(tmp_path / "BARN", number)
    names = {}
    (code,) = blocks("python")
    exec(code, names)
    assert len(names["suite"]) == 4


@pytest.mark.parametrize("line", [line for block in blocks("sh") for line in block.splitlines()])
def test_the_options_of_the_commands_are_there(line, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run_command(shlex.split(line)[1:]) == 2
    assert re.search(r"no such folder|cannot read worlds\.json", capsys.readouterr().err)
