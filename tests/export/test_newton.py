"""The USD of a robot, driven by an engine that is not ours: Newton 1.8, in a separate virtual environment.

Newton pins other versions of MuJoCo and usd-core than trundle. Once:

    python -m venv .venv-newton && .venv-newton/bin/pip install -r tests/export/newton_requirements.txt

TRUNDLE_NEWTON_PYTHON names another Python. The first run compiles Newton's kernels, which takes minutes.
"""

import json
import math
import os
import subprocess
from pathlib import Path

import pytest

from trundle.export import Scene, export_scene
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.worlds import World

HERE = Path(__file__).parent
PYTHON = Path(os.environ.get("TRUNDLE_NEWTON_PYTHON", HERE.parents[1] / ".venv-newton" / "bin" / "python"))

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.is_file(), reason=f"no Newton: see {HERE.name}/{Path(__file__).name} for its set-up"),
]


@pytest.mark.parametrize("profile", [None, "isaac"])
@pytest.mark.parametrize("name", ["nova_carter", "turtlebot3_burger"])
def test_a_written_robot_drives_two_metres_and_turns_a_quarter_in_newton(name, profile, tmp_path):
    """Wheels have a friction of 1, casters 0.7 where they roll and 0 where they slide, the floor none."""
    robot = Robot.load(name)
    stage = export_scene(Scene("s", World("floor", ()), robot, Pose2D(0.0, 0.0)), tmp_path / "s.usda", profile=profile)
    drive = robot.drive
    numbers = (str(drive.wheel_radius), str(drive.track_width))
    command = [PYTHON, HERE / "newton_drive.py", stage, drive.left_joint, drive.right_joint, *numbers]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=900)
    result = json.loads(done.stdout.splitlines()[-1])
    assert result["mass"] == pytest.approx(robot.total_mass, rel=1e-5)
    for path, friction in result["mu"].items():
        caster = 0.7 if robot.casters[0].is_swivel else 0.0
        body = 0.3 if "chassis" in path else 0.0 if "Ground" in path else 1.0
        assert friction == pytest.approx(caster if "caster" in path else body), path
    ahead, aside, turned = result["straight"]
    assert ahead == pytest.approx(2.0, rel=0.02)
    assert abs(aside) < 0.02
    assert abs(turned) < math.radians(1.0)
    assert result["turn"][2] == pytest.approx(math.pi / 2.0, abs=math.radians(5.0))
    assert math.hypot(*result["turn"][:2]) < 0.02
