"""Links between the pages of the project."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [page.relative_to(ROOT) for page in sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])]


@pytest.mark.parametrize("name", PAGES, ids=str)
def test_every_link_to_a_file_leads_somewhere(name):
    page = ROOT / name
    links = re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text())
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_every_file_that_the_architecture_names_is_there():
    table = (ROOT / "docs/architecture.md").read_text().partition("## Which file decides what")[2].partition("\n## ")[0]
    names = re.findall(r"`([\w/*]+\.\w+)`", table)
    assert len(names) >= 15
    assert [name for name in names if not list((ROOT / "src/trundle").glob(name))] == []
