"""The page on worlds: its options are those that there are, and its commands run."""

import importlib.util
import inspect
import re
import shlex
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from trundle.cli.entry import run_command
from trundle.cli.shared.options import parse_settings
from trundle.errors import RobotWarning
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World, world_names
from trundle.worlds.from_map import load_map
from trundle.worlds.gazebo.load import load_sdf
from trundle.worlds.meshes import load_mesh
from trundle.worlds.mjcf import load_mjcf
from trundle.worlds.usd import load_usd
from trundle.worlds.world import WORLDS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "worlds.md").read_text()
SCRIPT = ROOT / "docs" / "pictures" / "usd_hall.py"


def section(title: str) -> str:
    return PAGE.partition(f"\n## {title}")[2].partition("\n## ")[0]


def blocks(title: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", section(title), flags=re.DOTALL)


@pytest.mark.parametrize(
    ("row", "load"),
    [
        ("USD", load_usd),
        ("SDF", load_sdf),
        ("MJCF", load_mjcf),
        ("URDF", load_mjcf),
        ("meshes", load_mesh),
        ("a map", load_map),
    ],
)
def test_the_table_has_the_options_of_every_loader(row, load):
    (line,) = [line for line in PAGE.splitlines() if line.startswith(f"| {row}") and "World.load" in line]
    options = {name for name, given in inspect.signature(load).parameters.items() if given.kind is given.KEYWORD_ONLY}
    assert set(re.findall(r"`(\w+)`", line.rpartition("|")[0].rpartition("|")[2])) == options - {"exclude"}


def test_the_table_has_every_generator():
    (line,) = [line for line in PAGE.splitlines() if line.startswith("| a generator")]
    assert set(re.findall(r"`(\w+)`", line)) == set(world_names())


def run(command: str) -> None:
    words = shlex.split(command)
    if words[0] == "python":
        subprocess.run([sys.executable, str(ROOT / words[1]), *words[2:]], check=True)
        return
    assert words[0] == "trundle"
    more = ["--no-video", "-o", "ran", "--backend", "kinematic"] if words[1] == "run" else []
    assert run_command([*words[1:], *more]) == 0, command


def test_a_scene_in_centimetres_becomes_a_map_that_a_robot_drives(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (block,) = blocks("From an Isaac Sim scene", "sh")
    for command in block.splitlines():
        run(command)
    assert "nothing found" in capsys.readouterr().out
    grid = OccupancyGrid.load("map.yaml")

    def at(x: float, y: float) -> int:
        row, col = grid.world_to_cell(x, y)
        return int(grid.data[row, col])

    # Where the robot was, in the U of the bench, below a rack; then a wall, the bench, and two cartons, one mirrored.
    assert [at(*point) for point in ((3.2, 1.0), (-0.3, -3.0), (-5.6, 2.6))] == [0, 0, 0]
    assert [at(*point) for point in ((8.1, 0), (-0.3, -4.2), (-6.3, 2.6), (-4.9, -0.6))] == [100] * 4
    world = World.load("hall.usda", exclude=["*Robot", "ceiling"])
    np.testing.assert_allclose(world.bounds[1], (8.2, 5.2, 2.0), atol=1e-6)


def test_the_picture_of_the_hall_is_made_and_small(tmp_path):
    found = importlib.util.spec_from_file_location("usd_hall", SCRIPT)
    script = importlib.util.module_from_spec(found)
    found.loader.exec_module(script)
    script.draw(tmp_path / "hall.png")
    kept = ROOT / "docs" / "images" / "usd_hall.png"
    assert kept.stat().st_size < 200_000
    # The map's half, which no renderer has a hand in.
    pictures = [Image.open(path).convert("L") for path in (tmp_path / "hall.png", kept)]
    made, old = (np.asarray(picture, dtype=int)[40:, 700:] for picture in pictures)
    assert np.abs(made - old).mean() < 2.0


def test_the_robot_of_the_page_works_in_every_verb(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("cart.urdf").write_text(blocks("Your own robot", "xml")[0])
    Path("cart.yaml").write_text(blocks("Your own robot", "yaml")[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing of it has to be assumed
        robot = Robot.load("cart.yaml")
    assert (robot.drive.wheel_radius, robot.drive.track_width) == pytest.approx((0.1, 0.4))
    assert [(caster.x, caster.y) for caster in robot.casters] == [pytest.approx((-0.28, 0.0))]
    verbs = blocks("Your own robot", "sh")[0].splitlines()
    for command in verbs:
        run(command)
    assert {"joints", "view", "drive", "map", "plan", "run", "export"} == {command.split()[1] for command in verbs}
    with pytest.warns(RobotWarning):
        called = Robot.from_model("cart.urdf", left_joint="motor_a", right_joint="motor_b")
    assert called.footprint == robot.footprint
    capsys.readouterr()
    assert run_command(["view", "cart.urdf", "-o", "v.png"]) == 2
    assert "Its revolute joints are: motor_a, motor_b" in capsys.readouterr().err


@pytest.mark.parametrize("name", world_names())
def test_every_generator_is_listed_with_its_options_as_they_are_by_default(name: str) -> None:
    row = next(line for line in section("Generated").splitlines() if line.startswith(f"| `{name}` |"))
    options = dict(re.findall(r"`(\w+)=([^`]*)`", row))
    signature = inspect.signature(WORLDS.load(name)).parameters
    assert set(options) == set(signature) - {"seed"}
    # As the command line reads them, they make the world that is made without them.
    settings = parse_settings([f"{key}={value}" for key, value in options.items()])
    assert World.generate(name, seed=3, **settings) == World.generate(name, seed=3)
