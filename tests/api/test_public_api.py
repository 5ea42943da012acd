"""Public names and signatures change on purpose only."""

import difflib
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
REGENERATE = "python scripts/public_api.py --write"


def test_public_names_and_signatures_are_those_that_were_agreed_on() -> None:
    script = runpy.run_path(str(ROOT / "scripts" / "public_api.py"))
    kept = script["LIST"].read_text().splitlines()
    now = list(script["lines"]())
    changed = list(difflib.unified_diff(kept, now, "tests/api/public_api.txt", "trundle", lineterm="", n=0))
    if changed:
        pytest.fail(
            "the public interface changed:\n"
            + "\n".join(changed)
            + f"\nIf that is on purpose, run `{REGENERATE}` and tell users in CHANGELOG.md.",
            pytrace=False,
        )
