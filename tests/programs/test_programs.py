"""Seven programs of about ten lines, as users write them, run and are clean under pyright's strict mode."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from test_typing import NO_NODE

PROGRAMS = Path(__file__).parent
ENDS = {
    "plan": "m\n",
    "own_loop": "arrived Pose2D(",
    "own_controller": "arrived\n",
    "lidar": "beams hit something\n",
    "evaluation": "arrived",
    "own_planner": "arrived\n",
    "own_page": "The page: http://127.0.0.1:",
}


@pytest.mark.parametrize("name", ENDS)
def test_a_program_runs(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, PROGRAMS / f"{name}.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert ENDS[name] in done.stdout


@NO_NODE
def test_the_programs_are_typed_strictly_and_a_wrong_type_is_found(tmp_path: Path) -> None:
    for name in ENDS:
        shutil.copy(PROGRAMS / f"{name}.py", tmp_path)
    plan = (PROGRAMS / "plan.py").read_text()
    (tmp_path / "wrong.py").write_text(plan.replace("trundle.Goal.of(goal))", "(1.0, 2.0))"))
    (tmp_path / "misspelt.py").write_text(
        "import trundle\n\n"
        'trundle.Suite.make(worlds="warehouse", goal_tolerance=[0.1, 0.3], latency={"command_s": 0.1})\n'
        'trundle.Suite(worlds="warehouse", goal_tolerence=0.1)\n'
        'trundle.Suite.make(worlds="warehouse", seeds="0:3", inflation_radius="wide")\n'
    )
    (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict"}')
    done = subprocess.run(
        [sys.executable, "-m", "pyright", "--pythonpath", sys.executable],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    errors = [line for line in done.stdout.splitlines() if " error: " in line]
    assert sorted(line.partition(".py:")[0].rpartition("/")[2] for line in errors) == ["misspelt"] * 2 + ["wrong"], (
        errors
    )
    assert any('"goal_tolerence"' in line for line in errors)
    assert any('"inflation_radius"' in line for line in errors)
