"""What trundle's own commands do on NVIDIA's classes: the checklist, an example, and the script that it exports."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from trundle.mission import Scenario

pytestmark = pytest.mark.isaac
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("generation", [5, 6])
def test_the_checklist_passes_but_for_what_is_not_there(isaac: Callable[..., Any], generation: int) -> None:
    done = isaac(
        "--api", generation, "--seconds", 1000, "-m", "trundle", "doctor", "--backend", "isaac", "--headless", "--json"
    )
    checks = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    assert [name for name, check in checks.items() if check["status"] == "pass"] == [
        "python", "kernels", "isaac sim", "start", "drive", "interface", "step", "mission", "contact", "close",
    ]  # fmt: skip
    assert "conflicts with Isaac Sim's own USD" in checks["usd"]["detail"]
    assert "rendered nothing" in checks["picture"]["detail"]


def test_an_example_lists_the_joints(isaac: Callable[..., Any], tmp_path: Path) -> None:
    done = isaac(ROOT / "examples" / "isaac" / "02_list_joints.py", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "joint_wheel_left <- drives" in done.stdout


@pytest.mark.parametrize("generation", [5, 6])
def test_the_exported_script_follows_its_plan(isaac: Callable[..., Any], tmp_path: Path, generation: int) -> None:
    from trundle.export import Scene, export_scene

    setting = Scenario.make(world="office", seed=2).prepare()
    paths, pose = [], setting.start
    for goal in setting.goals:
        setting.navigator.set_goal(goal)
        paths.append(setting.navigator.plan(pose))
        pose = paths[-1].goal
    scene = Scene("mission", setting.world, setting.robot, setting.start, tuple(paths), None)
    script = export_scene(scene, tmp_path / "drive.py")
    done = isaac("--api", generation, script, "--headless", "--seconds", 300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "arrived" in done.stdout
