"""A package that adds to trundle without a change in trundle: installed beside it, found by name, keeping the rules."""

import importlib
import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from trundle.cli.entry import run_command
from trundle.control import controller_names, create_controller
from trundle.navigation.behaviors import behavior_names, create_behavior
from trundle.planning import create_planner, planner_names
from trundle.robots import Robot, robot_names
from trundle.sim import simulate, simulator_names
from trundle.testing import check_behavior, check_controller, check_planner, check_simulator
from trundle.worlds import World

SOURCE = Path(__file__).parent / "plugin_package"


def install(target: Path) -> None:
    """Do what an installer does: copy the package, and write its metadata and entry points."""
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]
    shutil.copytree(SOURCE / "trundle_example_plugin", target / "trundle_example_plugin")
    info = target / f"trundle_example_plugin-{project['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    groups = [
        "\n".join([f"[{group}]", *(f"{name} = {value}" for name, value in points.items())])
        for group, points in project["entry-points"].items()
    ]
    (info / "entry_points.txt").write_text("\n\n".join(groups) + "\n")


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The folder that the package is installed in, on the path of this process."""
    target = tmp_path / "site"
    target.mkdir()
    install(target)
    monkeypatch.syspath_prepend(target)
    importlib.invalidate_caches()
    yield target
    for name in [name for name in sys.modules if name.startswith("trundle_example_plugin")]:
        del sys.modules[name]


@pytest.mark.usefixtures("installed")
def test_its_names_are_listed() -> None:
    assert "grid_walk" in planner_names()
    assert "turn_then_drive" in controller_names()
    assert "look_around" in behavior_names()
    assert "worn_tyres" in simulator_names()
    assert "mini_cart" in robot_names()


def test_without_it_they_are_not() -> None:
    assert "grid_walk" not in planner_names()
    assert "mini_cart" not in robot_names()


@pytest.mark.usefixtures("installed")
def test_its_planner_keeps_the_rules() -> None:
    check_planner(lambda: create_planner("grid_walk"))


@pytest.mark.usefixtures("installed")
def test_its_controller_keeps_the_rules() -> None:
    check_controller(lambda robot: create_controller("turn_then_drive", robot))


@pytest.mark.usefixtures("installed")
def test_its_behavior_keeps_the_rules() -> None:
    check_behavior(lambda: create_behavior("look_around", angle=0.5))


@pytest.mark.usefixtures("installed")
def test_its_simulator_keeps_the_rules() -> None:
    check_simulator(lambda world, robot: simulate(world, robot, backend="worn_tyres", wear=0.0))


@pytest.mark.usefixtures("installed")
def test_its_simulator_is_its_own() -> None:
    from trundle.geometry import Pose2D, Twist2D

    with simulate(World(name="floor", solids=()), Robot.load("mini_cart"), backend="worn_tyres", wear=0.1) as sim:
        sim.reset(Pose2D(1.0, 0.0))
        for _ in range(40):
            state = sim.step(Twist2D(0.5, 0.0), 0.05)
    assert state.odometry.x - 1.0 == pytest.approx(1.1 * (state.pose.x - 1.0))


def test_everything_of_it_runs_from_the_command_line(installed: Path, tmp_path: Path) -> None:
    command = [
        "run",
        "warehouse",
        "--seed=3",
        "--robot=mini_cart",
        "--planner=grid_walk",
        "--controller=turn_then_drive",
    ]
    done = subprocess.run(
        [sys.executable, "-m", "trundle", *command, "--backend=worn_tyres", "--no-video", "--json"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads(done.stdout)
    assert (result["outcome"], result["planner"], result["controller"], result["robot"]) == (
        "arrived",
        "grid_walk",
        "turn_then_drive",
        "mini_cart",
    )


@pytest.mark.usefixtures("installed")
def test_its_simulator_and_robot_are_checked_by_doctor(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["doctor", "--backend", "worn_tyres"]) == 0
    assert "pass     mission" in capsys.readouterr().out
    assert run_command(["doctor", "robot", "mini_cart", "--backend", "worn_tyres"]) == 0
    assert "drives as configured" in capsys.readouterr().out


def test_a_package_that_cannot_be_imported_is_a_message(installed: Path, tmp_path: Path) -> None:
    (installed / "trundle_example_plugin" / "planner.py").write_text("import not_there\n")
    done = subprocess.run(
        [sys.executable, "-m", "trundle", "run", "warehouse", "--planner=grid_walk"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "planner 'grid_walk' (trundle_example_plugin.planner:GridWalkPlanner) cannot be imported" in done.stderr
    assert "Traceback" not in done.stderr
