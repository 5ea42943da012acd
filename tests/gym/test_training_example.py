"""The examples that train policies: a few steps each, and the policy that one exports drives."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Navigator, create_agent
from trundle.observation import Estimate, Observation
from trundle.robots import Robot

EXAMPLES = Path(__file__).parents[2] / "examples" / "learning"


def run(folder, name, *options):
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), *options], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_rsl_rls_runner_learns_writes_its_log_and_a_checkpoint(tmp_path):
    pytest.importorskip("rsl_rl", reason="needs RSL-RL")
    options = ["--envs", "8", "--iterations", "3", "--steps", "8", "--worlds", "1", "--log", "run"]
    printed = run(tmp_path, "train_rsl_rl.py", *options)
    assert "Mean value loss" in printed
    assert "learned for 3 iterations on cpu" in printed
    assert (tmp_path / "run" / "model_2.pt").stat().st_size > 0


@pytest.mark.slow
def test_stable_baselines_learns_and_saves_its_policy(tmp_path):
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3")
    printed = run(tmp_path, "train_sb3.py", "--envs", "4", "--steps", "256", "--worlds", "1")
    assert "total_timesteps" in printed
    assert (tmp_path / "ppo_office.zip").stat().st_size > 0


@pytest.mark.slow
def test_a_short_training_on_paths_exports_a_policy_that_follows_the_planners(tmp_path):
    for library in ("torch", "onnx", "onnxruntime"):
        pytest.importorskip(library, reason=f"needs {library}, which the example trains or exports with")
    short = ["--updates", "1", "--envs", "8", "--steps", "4", "--parts", "2", "--width", "16", "--worlds", "1"]
    printed = run(tmp_path, "train_policy.py", "--path", "--device", "cpu", "--judge", "2", *short)
    assert "office: " in printed
    assert "warehouse: " in printed
    robot = Robot.load("nova_carter")
    navigator = Navigator(OccupancyGrid(np.zeros((200, 200), np.int8), 0.05), robot)
    agent = create_agent(str(tmp_path / "policy.onnx"), robot, navigator=navigator)
    assert agent.file.observations == ("ranges", "goal", "velocity", "path")
    assert agent.file.path_points == 8


@pytest.mark.slow
def test_a_short_training_exports_a_policy_that_can_be_driven(tmp_path):
    for library in ("torch", "onnx", "onnxruntime"):
        pytest.importorskip(library, reason=f"needs {library}, which the example trains or exports with")
    options = ["--updates", "1", "--envs", "8", "--steps", "4", "--worlds", "1", "--judge", "0"]
    printed = run(tmp_path, "train_policy.py", *options)
    assert "environment" in printed
    assert "learner" in printed
    agent = create_agent(str(tmp_path / "policy.onnx"), Robot.load("nova_carter"))
    agent.set_goal(Goal(3.0, 0.0))
    assert agent.update(Observation(0.0, Twist2D(), Pose2D(0.0, 0.0)), Estimate(0.0, Pose2D(0.0, 0.0))) == Twist2D()
    assert agent.file.states == {"memory": "memory_next"}
    assert agent.file.period == 0.2
