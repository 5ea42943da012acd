"""docs/isaac_reference.md names what there is."""

from pathlib import Path
from typing import get_args

from trundle.doctor import drive_check

PAGE = (Path(__file__).parents[2] / "docs" / "isaac_reference.md").read_text()


def test_every_finding_of_the_robot_check_has_its_row() -> None:
    assert [kind for kind in get_args(drive_check.Kind) if f"| `{kind}` |" not in PAGE] == []
