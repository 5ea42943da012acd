import ast
import importlib
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
    "06_evaluate_planners": {"evaluation"},
    "07_unknown_warehouse": {"unknown.png"},
    "08_people": {"people.png"},
    "09_tour": {"tour.png"},
    "10_own_loop_in_the_browser": set(),
    "11_localization": set(),
    "12_explore": {"explored.yaml", "explored.png", "explored_overlay.png"},
    "13_learning": set(),
}
SAYS = {
    "01_load_and_view": "nova_carter: 57.5 kg",
    "02_list_joints": "joint_wheel_left",
    "03_drive_by_hand": "after 5 s of v=0.4, w=0: x 1.9",
    "04_make_map": "cells of 0.05 m",
    "05_drive_to_goal": "arrived",
    "06_evaluate_planners": "16 of 16 episodes, 16 arrived",
    "07_unknown_warehouse": "arrived",
    "08_people": "arrived",
    "09_tour": "spin (task of goal 4) succeeded",
    "10_own_loop_in_the_browser": "stopped at Pose2D(",
    "11_localization": "s: localized, 0.0",
    "12_explore": "m² of free floor",
    "13_learning": "generation 1: reward",
}
OPTIONS = {
    "10_own_loop_in_the_browser": ["--seconds", "1", "--no-open"],
    "11_localization": ["--fast"],
    "12_explore": ["--fast"],
    "13_learning": ["--generations", "1"],
}
"""Those of an example that waits for a person, or takes long."""
NEEDS = {"13_learning": "gymnasium"}
"""The library of an extra that an example needs."""
LONG = {"07_unknown_warehouse", "08_people", "11_localization", "12_explore"}
"""Those that take six seconds or more: each day another part of them runs."""
CASES = [pytest.param(path, marks=[pytest.mark.slow] if path.stem in LONG else []) for path in EXAMPLES]


def test_there_is_an_example_for_each_step_and_for_each_larger_part() -> None:
    assert [path.stem for path in EXAMPLES] == sorted(WRITES)


@pytest.mark.parametrize("example", CASES, ids=lambda path: path.stem)
def test_an_example_runs_in_an_empty_folder(example: Path, tmp_path: Path) -> None:
    if example.stem in NEEDS:
        pytest.importorskip(NEEDS[example.stem])
    done = subprocess.run(
        [sys.executable, "-W", "error", str(example), *OPTIONS.get(example.stem, [])],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert SAYS[example.stem] in done.stdout
    assert {path.name for path in tmp_path.iterdir()} == WRITES[example.stem]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short(example: Path) -> None:
    assert len(example.read_text().splitlines()) < 40


@pytest.mark.parametrize(
    "example", [*EXAMPLES, *(EXAMPLES[0].parent / "isaac").glob("*.py")], ids=lambda path: path.stem
)
def test_an_example_uses_only_public_names(example: Path) -> None:
    """What it imports is in a package's `__all__`, and no attribute begins with an underscore."""
    tree = ast.parse(example.read_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module]
    for node in imports:
        if str(node.module).startswith("trundle"):
            assert {name.name for name in node.names} <= set(importlib.import_module(str(node.module)).__all__)
    assert not [node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and node.attr.startswith("_")]


@pytest.mark.parametrize("name", ["trundle", "trundle.record", "trundle.viewer", "trundle.sim.mujoco"])
def test_names_that_are_imported_on_first_use_are_there(name: str) -> None:
    module = importlib.import_module(name)
    assert all(getattr(module, public) is not None for public in module.__all__)
    with pytest.raises(AttributeError, match="no attribute 'none'"):
        module.none  # noqa: B018
