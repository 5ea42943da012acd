"""Scripts in the style of Isaac Sim 5.1's documentation run unmodified: the five steps from loading to a goal."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image

import trundle
from trundle.geometry import integrate_twist
from trundle.worlds import World

pytestmark = pytest.mark.isaac
SCRIPTS = Path(__file__).parent / "scripts"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the map of the warehouse, and a task in it."""
    place = tmp_path_factory.mktemp("warehouse")
    grid = trundle.OccupancyGrid.from_world(World.generate("warehouse"), resolution=0.05, z_range=(0.1, 0.62))
    grid.save(place / "map.yaml")
    task = {"start": [12.9, 0.0, math.pi], "goal": [1.1, -5.0]}
    (place / "task.yaml").write_text(yaml.safe_dump(task), encoding="utf-8")
    return place


@pytest.fixture
def run(isaac: Callable[..., Any], folder: Path) -> Callable[..., str]:
    def run_script(name: str, *arguments: object) -> str:
        done = isaac(SCRIPTS / f"{name}.py", *arguments, cwd=folder)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run_script


def test_load_and_view_ends_with_the_simulated_time(run: Callable[..., str]) -> None:
    said = run("load_and_view", "--seconds", 2)
    frames, seconds, prims = map(float, re.findall(r"[\d.]+(?=,| s|$)", said.splitlines()[0]))
    assert 100 <= frames <= 120
    assert seconds == pytest.approx(2.0, abs=0.2)
    assert prims > 20
    assert "loaded: True, True" in said


def test_a_task_is_logged_saved_and_cleared(isaac: Callable[..., Any], tmp_path: Path) -> None:
    done = isaac(SCRIPTS / "task.py", tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", ""), done.stdout + done.stderr


def test_list_joints_finds_those_of_nova_carter(run: Callable[..., str]) -> None:
    rows = {line.split()[0]: line.split()[1:] for line in run("list_joints").splitlines()}
    assert {
        "joint_wheel_left",
        "joint_wheel_right",
        "joint_swing_left",
        "joint_caster_right",
        "joint_caster_base",
    } <= rows.keys()
    kind, axis, damping = rows["joint_wheel_left"]
    assert (kind, axis) == ("PhysicsRevoluteJoint", "Y")
    assert float(damping) > 0.0


def test_drive_ends_where_the_kinematic_model_says(run: Callable[..., str]) -> None:
    rows = [list(map(float, line.split()[1:])) for line in run("drive").splitlines() if line.startswith("pose")]
    assert len(rows) == 3
    for v, w, x, y, yaw in rows:
        # 300 steps of 1/60 s; a robot that stands reaches its speed as if it had waited for 0.1 s.
        end = integrate_twist(0.0, 0.0, 0.0, v, w, 5.0 - 0.1)
        assert math.dist((x, y), end[:2]) < 0.02, (v, w, x, y)
        assert abs(math.remainder(yaw - end[2], math.tau)) < 0.05, (v, w, yaw)


def test_load_map_reads_the_cells_and_draws_them(run: Callable[..., str], folder: Path) -> None:
    image = np.array(Image.open(folder / "map.png").convert("L"))
    said = run("load_map")
    assert f"map {image.shape[1]} x {image.shape[0]}, occupied {(image < 50).sum()}" in said
    assert (folder / "overview.png").stat().st_size > 1000


def test_navigate_reaches_the_goal(run: Callable[..., str]) -> None:
    said = run("navigate").splitlines()[-1]
    reached, x, y, seconds = re.fullmatch(r"reached: (\w+), at (\S+), (\S+), after (\S+) s", said).groups()
    assert reached == "True"
    assert math.dist((float(x), float(y)), (1.1, -5.0)) < 0.2
    assert float(seconds) < 60.0


@pytest.mark.parametrize("name", ["old_names", "timeline", "experimental", "changes"])
def test_other_styles_of_scripts_do_what_they_check_themselves(run: Callable[..., str], name: str) -> None:
    assert run(name).splitlines()[-1] == "done"
