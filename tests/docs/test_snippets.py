"""The Python of the pages runs, block after block."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize(
    ("page", "printed"),
    [
        ("planning.md", "lies outside the map"),
        ("planning_reference.md", "found 511.58"),
        ("python.md", ", 1 path, "),
        ("recordings.md", ", arrived, "),
        ("browser.md", "The page: http://127.0.0.1:"),
    ],
)
def test_the_python_of_a_page_runs(page, printed, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), flags=re.DOTALL)
    assert blocks
    for block in blocks:
        exec(block, names)
    assert printed in capsys.readouterr().out
