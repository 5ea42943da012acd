"""CHANGELOG.md keeps its form."""

import re
from pathlib import Path

CHANGELOG = (Path(__file__).parents[2] / "CHANGELOG.md").read_text()


def test_every_version_has_its_changes_under_the_four_headings() -> None:
    for version in CHANGELOG.split("\n## ")[1:]:
        before, *parts = version.split("\n### ")
        headings = [part.partition("\n")[0] for part in parts]
        assert headings == [name for name in ("Added", "Changed", "Fixed", "Removed") if name in headings]
        assert "\n- " not in before
        assert all("\n- " in part for part in parts)


def test_no_change_is_listed_twice() -> None:
    changes = re.findall(r"^- (.*)$", CHANGELOG, re.MULTILINE)
    removed = [change.partition(":")[0] for change in changes if ":" in change and change.startswith(("`", "Planner"))]
    for names in (changes, removed):
        assert [name for name in names if names.count(name) > 1] == []
