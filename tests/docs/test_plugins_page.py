"""docs/plugins.md: its files, its Python and its commands run one after the other."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from trundle.cli.entry import run_command

PAGE = (Path(__file__).parents[2] / "docs" / "plugins.md").read_text()
STEP = re.compile(r"(?:`(my_\w+\.py)`:\n\n)?```(python|sh)\n(.*?)```", re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """An empty folder to work in, whose modules can be imported."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith("my_")]:
        del sys.modules[name]


def test_all_of_the_page_runs_in_order(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = STEP.findall(PAGE)
    files = [name for name, _, _ in steps if name]
    assert files == ["my_planner.py", "my_controller.py", "my_agent.py", "my_localizer.py"]
    names: dict[str, object] = {"__name__": "__main__"}
    for name, language, code in steps:
        if name:
            (folder / name).write_text(code)
        elif language == "python":
            exec(code, names)
        else:
            for command in code.splitlines():
                words = shlex.split(command)[1:]
                more = ["--no-video", "--no-report"] if words[0] == "run" else []
                assert run_command([*words, *more]) == 0, command
    out = capsys.readouterr().out
    assert "both pass" in out
    assert out.count("arrived") >= 6
    assert (folder / "evaluation" / "report.html").is_file()
