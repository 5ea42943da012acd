"""docs/isaac_reference.md names what there is, and the Korean page has the commands of docs/isaac.md."""

import re
from pathlib import Path
from typing import get_args

from trundle.doctor import drive_check

DOCS = Path(__file__).parents[2] / "docs"
KOREAN, ENGLISH = ((DOCS / page).read_text() for page in ("ko/isaac.md", "isaac.md"))


def commands(text: str) -> set[str]:
    """Every command of a page, in its text, its tables and its blocks, without comments."""
    lines = re.findall(r"^(?:    (?:\$ )?)?((?:trundle|\./isaac\.sh) .*)$", text, flags=re.MULTILINE)
    spans = re.findall(r"`((?:trundle|\./isaac\.sh|pip|export) [^`…]*)`", text)
    return {" ".join(re.sub(r"  +#.*", "", command).split()) for command in [*lines, *spans]}


def test_every_finding_of_the_robot_check_has_its_row() -> None:
    page = (DOCS / "isaac_reference.md").read_text()
    assert [kind for kind in get_args(drive_check.Kind) if f"| `{kind}` |" not in page] == []


def test_the_korean_page_has_commands_of_the_english_one() -> None:
    korean, english = commands(KOREAN), " ".join(ENGLISH.split())
    assert len(korean) >= 15
    assert sorted(command for command in korean if command not in english) == []


def test_the_korean_page_has_the_five_steps_and_options_of_the_english_one() -> None:
    steps = [re.findall(r"`(0\d_\w+\.py)`", text) for text in (KOREAN, ENGLISH)]
    options = [set(re.findall(r"^\| `(--[\w-]+)`", text, flags=re.MULTILINE)) for text in (KOREAN, ENGLISH)]
    assert steps[0] == steps[1]
    assert len(steps[0]) == 5
    assert options[0] == options[1]


def test_the_figures_of_the_korean_page_are_in_the_english_one() -> None:
    figures = [set(re.findall(r"(?<![\w.#/])\d+\.\d+|(?<![\w.])#\d+", text)) for text in (KOREAN, ENGLISH)]
    assert figures[0] - figures[1] == set()
    assert len(figures[0]) > 10
