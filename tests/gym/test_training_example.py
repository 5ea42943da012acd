"""The example that trains a policy: a few steps, and the policy that it exports drives."""

import subprocess
import sys
from pathlib import Path

import pytest

from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.navigation import create_agent
from trundle.observation import Estimate, Observation
from trundle.robots import Robot

EXAMPLE = Path(__file__).parents[2] / "examples" / "learning" / "train_policy.py"


@pytest.mark.slow
def test_a_short_training_exports_a_policy_that_can_be_driven(tmp_path):
    for library in ("torch", "onnx", "onnxruntime"):
        pytest.importorskip(library, reason=f"needs {library}, which the example trains or exports with")
    options = ["--updates", "1", "--envs", "8", "--steps", "4", "--worlds", "1", "--judge", "0"]
    done = subprocess.run(
        [sys.executable, str(EXAMPLE), *options], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "environment" in done.stdout
    assert "learner" in done.stdout
    agent = create_agent(str(tmp_path / "policy.onnx"), Robot.load("nova_carter"))
    agent.set_goal(Goal(3.0, 0.0))
    assert agent.update(Observation(0.0, Twist2D(), Pose2D(0.0, 0.0)), Estimate(0.0, Pose2D(0.0, 0.0))) == Twist2D()
    assert agent.file.states == {"memory": "memory_next"}
    assert agent.file.period == 0.2
