"""docs/tutorial.md: its commands run, print what it shows, and the Korean pages have the same."""

import re
import shlex
from pathlib import Path

import pytest

from trundle.cli.entry import run_command

DOCS = Path(__file__).parents[2] / "docs"


def blocks(page: str, language: str) -> list[str]:
    """The code of a page in one language."""
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(), flags=re.DOTALL)


def without_comments(code: list[str]) -> list[str]:
    return [re.sub(r" *#.*", "", block) for block in code]


def test_the_commands_run_and_print_what_the_page_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    for command in "".join(blocks("tutorial.md", "sh")).splitlines():
        words = shlex.split(command)
        more = ["--no-video"] if words[1] == "run" else []
        assert run_command([*words[1:], *more]) == 0, command
    printed = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for line in "".join(blocks("tutorial.md", "text")).splitlines():
        assert " ".join(line.split()) in printed, line
    assert (tmp_path / "run" / "overlay.png").is_file()
    assert (tmp_path / "driven" / "drive.csv").is_file()


@pytest.mark.parametrize("page", ["tutorial.md", "blog.md"])
def test_the_korean_page_has_the_same_code_pictures_and_figures(page: str) -> None:
    korean = f"ko/{page}"
    for language in ("sh", "text"):
        assert without_comments(blocks(korean, language)) == without_comments(blocks(page, language))
    english, translated = ((DOCS / name).read_text() for name in (page, korean))
    for pattern in (r"^    .*$", r"images/\w+\.png", r"^#+ "):
        assert re.findall(pattern, translated, re.MULTILINE) == re.findall(pattern, english, re.MULTILINE)
    units = r"\d+(?:\.\d+)? (?:m/s|rad/s|mm|m|s|%)(?![\w/])|\d+(?:\.\d+)?°"
    figures = [set(re.findall(units, " ".join(text.split()), re.ASCII)) for text in (english, translated)]
    assert figures[0] == figures[1]
