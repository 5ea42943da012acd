import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))
WRITES = {
    "01_load_and_view": {"scene.png"},
    "02_list_joints": set(),
    "03_drive_by_hand": set(),
    "04_make_map": {"warehouse.yaml", "warehouse.png"},
    "05_drive_to_goal": {"overlay.png"},
}
SAYS = {
    "01_load_and_view": "nova_carter: 57.5 kg",
    "02_list_joints": "joint_wheel_left",
    "03_drive_by_hand": "after 5 s of v=0.4, w=0: x 1.9",
    "04_make_map": "cells of 0.05 m",
    "05_drive_to_goal": "arrived",
}


def test_there_is_an_example_for_each_step() -> None:
    assert [path.stem for path in EXAMPLES] == sorted(WRITES)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_in_an_empty_folder(example: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(example)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert SAYS[example.stem] in done.stdout
    assert {path.name for path in tmp_path.iterdir()} == WRITES[example.stem]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short(example: Path) -> None:
    assert len(example.read_text().splitlines()) < 40
