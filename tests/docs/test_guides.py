"""The guides are short, start with something to run, and what they start with runs."""

import re
import shlex
from pathlib import Path

import pytest

from trundle.cli.entry import run_command

DOCS = Path(__file__).parents[2] / "docs"
GUIDES = (
    "tutorial",
    "maps",
    "worlds",
    "sensing",
    "control",
    "evaluation",
    "ros2",
    "isaac",
    "browser",
    "simulation",
    "planning",
    "localization",
    "mapping_from_recordings",
)
# Pages with the fields, options and proofs behind a guide.
REFERENCES = ("evaluation", "isaac", "planning", "ros2", "worlds")
# What they begin with needs no other program and no network, and no other test runs it.
RUN_HERE = ("maps", "worlds", "sensing", "control", "simulation", "planning", "localization")


@pytest.mark.parametrize("guide", GUIDES)
def test_a_guide_has_at_most_3000_words(guide: str) -> None:
    assert len((DOCS / f"{guide}.md").read_text().split()) <= 3000


@pytest.mark.parametrize("guide", GUIDES)
def test_a_guide_starts_with_something_to_run(guide: str) -> None:
    lines = (DOCS / f"{guide}.md").read_text().splitlines()
    first = next(number for number, line in enumerate(lines) if re.match(r"(    )?(trundle|pip install) ", line))
    assert len(" ".join(lines[:first]).split()) <= 80


@pytest.mark.parametrize("guide", RUN_HERE)
def test_what_a_guide_starts_with_runs(guide: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (block, *_) = re.findall(r"```sh\n(.*?)```", (DOCS / f"{guide}.md").read_text(), flags=re.DOTALL)
    commands = [shlex.split(line, comments=True)[1:] for line in block.splitlines()]
    assert commands
    for words in commands:
        assert run_command([*words, *(["--no-video"] if words[0] == "run" else [])]) == 0, words


@pytest.mark.parametrize("guide", REFERENCES)
def test_a_guide_and_its_reference_link_to_each_other(guide: str) -> None:
    assert f"]({guide}_reference.md" in (DOCS / f"{guide}.md").read_text()
    assert f"]({guide}.md" in (DOCS / f"{guide}_reference.md").read_text()


def slugs(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub and the site make them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    titles = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")) + sorted(DOCS.glob("ko/*.md")), ids=lambda page: page.stem)
def test_a_link_to_a_heading_leads_to_one(page: Path) -> None:
    broken = []
    for path, anchor in re.findall(r"\]\((?!https?:)([^)#\s]*)#([^)\s]+)\)", page.read_text()):
        target = page.parent / path if path else page
        if target.suffix == ".md" and target.exists() and target.parent.name != "reference":
            broken += [f"{path}#{anchor}"] if anchor not in slugs(target) else []
    assert broken == []
