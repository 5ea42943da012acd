"""The script for Isaac Sim is run in stand-ins of both generations, and arrives."""

import ast
import math
import re
import runpy
import subprocess
import sys

import numpy as np
import pytest

from support.fake_isaac.fixtures import assets, fake, make_fake
from trundle.costmap import LETHAL
from trundle.errors import InputError, UnknownNameError
from trundle.export import Scene, export_scene
from trundle.export.isaac_script import plan_stretches, speed_zones
from trundle.geometry import Pose2D, wrap_angle
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.mission import Scenario
from trundle.navigation import Navigator
from trundle.path import Path as Plan
from trundle.robots import Robot
from trundle.usd import TIMESTEP
from trundle.worlds import World

__all__ = ["assets", "fake", "make_fake"]

START, AHEAD = (1.0, 0.0, 0.0), (2.5, 0.0)


def plan(robot, world, start, *goals, speed_mask=None):
    """A scene with its plans."""
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    return plan_on(Navigator(grid, robot, speed_mask=speed_mask), world, Pose2D.of(start), goals)


def plan_on(navigator, world, start, goals):
    paths, pose = [], start
    for goal in goals:
        navigator.set_goal(goal)
        paths.append(navigator.plan(pose))
        pose = paths[-1].goal
    return Scene("mission", world, navigator.robot, start, tuple(paths), navigator.speed_mask)


def run_script(path, fake, monkeypatch, *arguments):
    """Run a script as Isaac Sim's Python would; the poses of every physics step."""
    poses = []
    fake.on_step = lambda _: poses.append((*fake.body.position[:2], fake.body.yaw))
    monkeypatch.setattr(sys, "argv", [str(path), *arguments])
    runpy.run_path(str(path), run_name="__main__")
    return np.array(poses)


@pytest.mark.slow
def test_it_drives_the_plan_to_the_goal_without_touching_anything(fake, monkeypatch, tmp_path, capsys):
    setting = Scenario.make(world="office", seed=2).prepare()
    robot, costmap, goal = setting.robot, setting.navigator.costmap, setting.goals[-1]
    path = export_scene(plan_on(setting.navigator, setting.world, setting.start, setting.goals), tmp_path / "drive.py")
    poses = run_script(path, fake, monkeypatch, "--headless")
    x, y, yaw = poses[-1]
    assert math.dist((x, y), goal[:2]) < 0.06
    assert abs(wrap_angle(yaw - goal[2])) < 0.03
    assert "arrived at" in capsys.readouterr().out
    assert fake.stage_path.endswith("drive_world.usd")
    for pose in poses[::20]:
        corners = Pose2D(*pose).transform_points(robot.outline)
        rows, cols = costmap.world_to_cell(corners[:, 0], corners[:, 1])
        assert (costmap.data[rows, cols] < LETHAL).all(), pose
    assert fake.app_closes == 1


@pytest.mark.slow
def test_it_drives_in_an_environment_of_isaac_sim(fake, monkeypatch, tmp_path, assets):
    world = World.load(assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    scene = plan(Robot.load("nova_carter"), world, (-2.5, -1.0, 0.0), (2.0, 1.5), (-2.5, 1.5, 3.14))
    path = export_scene(scene, tmp_path / "drive.py", environment="warehouse")
    assert [file.name for file in tmp_path.iterdir()] == ["drive.py"]
    poses = run_script(path, fake, monkeypatch, "--headless")
    assert np.hypot(*(poses[:, :2] - (2.0, 1.5)).T).min() < 0.06
    assert math.dist(poses[-1][:2], (-2.5, 1.5)) < 0.06
    assert abs(poses[-1][2]) == pytest.approx(3.14, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("unit", "multiplier", "limits"),
    [("percent", 1.0, (0.2, 0.4)), ("absolute", 0.01, (0.25, 0.5))],
)
def test_it_keeps_the_limits_of_a_speed_mask(unit, multiplier, limits, make_fake, monkeypatch, tmp_path, capsys):
    fake = make_fake(6)
    world = World.load(fake.assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    robot = Robot.load("nova_carter")
    top = robot.limits.linear_speed
    # Rotated against the map, with cells of another size; the slower part lies across a corner of the path.
    grid = OccupancyGrid([[25, 50], [0, 50]], 1.3, Pose2D(-0.3, -2.6, 0.4))
    mask = SpeedMask(grid, unit, multiplier=multiplier)
    scene = plan(robot, world, (-2.5, -1.0, 0.0), (2.0, -1.0), (-2.0, 1.5), speed_mask=mask)
    path = export_scene(scene, tmp_path / "drive.py", environment="warehouse")
    check_style(path)
    poses = run_script(path, fake, monkeypatch, "--headless")
    assert "arrived at" in capsys.readouterr().out
    assert math.dist(poses[-1][:2], (-2.0, 1.5)) < 0.06
    speeds = np.hypot(*np.diff(poses[:, :2], axis=0).T) / TIMESTEP
    allowed = mask.limit_at(poses[:-1, 0], poses[:-1, 1], top)
    assert (speeds <= allowed + 1e-6).all()
    for value in (25, 50):
        limit = mask.limits(top)[value]
        assert speeds[allowed == limit].max() > 0.95 * limit
    assert speeds.max() > 0.95 * top


def test_limits_are_those_beside_the_stretch_and_none_where_the_robot_is_slower_anyhow():
    grid = OccupancyGrid([[0, 100, 0, 40]], 1.0, Pose2D(0.0, 0.05))
    zones = list(speed_zones([(-0.5, 0.0), (4.5, 0.0)], SpeedMask(grid), 0.8))
    (begin, end, limit) = zones[0]
    assert len(zones) == 1
    assert limit == pytest.approx(0.32)
    assert 3.45 <= begin <= 3.5
    assert 4.5 <= end <= 4.55
    assert list(speed_zones([(-0.5, -0.06), (4.5, -0.06)], SpeedMask(grid), 0.8)) == []
    assert len(list(speed_zones([(3.0, 2.0), (3.5, 1.12)], SpeedMask(grid), 0.8))) == 1


def test_slow_zones_are_given_the_time_that_they_take(tmp_path):
    texts = []
    for mask in (None, SpeedMask(OccupancyGrid([[1]], 1.0, Pose2D(1.5, -0.5)))):
        scene = plan(Robot.load("nova_carter"), World.generate("corridors"), START, AHEAD, speed_mask=mask)
        path = export_scene(scene, tmp_path / "drive.py", environment="hospital")
        texts.append(path.read_text(encoding="utf-8"))
    assert "LIMITS = {}" in texts[0]
    free, slow = (int(re.search(r"TIME_LIMIT = (\d+)", text)[1]) for text in texts)
    # 1 m at a hundredth of the top speed.
    assert slow - free > 3 * 100


@pytest.mark.parametrize("generation", [5, 6])
def test_the_articulations_root_may_lie_anywhere_in_the_robot(generation, make_fake, monkeypatch, tmp_path):
    fake = make_fake(generation, root=Pose2D(-0.3, 0.1, 0.5))
    world = World.load(fake.assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    scene = plan(Robot.load("nova_carter"), world, (-2.5, -1.0, 0.0), (2.0, 1.5, -1.57))
    path = export_scene(scene, tmp_path / "drive.py", environment="warehouse")
    poses = run_script(path, fake, monkeypatch, "--headless")
    assert poses[-1] == pytest.approx((2.0, 1.5, -1.57), abs=0.06)


def test_a_robot_that_isaac_sim_has_not_is_written_beside_it(make_fake, monkeypatch, tmp_path):
    setting = Scenario.make(world="maze", seed=1, robot="jackal").prepare()
    scene = plan_on(setting.navigator, setting.world, setting.start, setting.goals)
    path = export_scene(scene, tmp_path / "drive.py")
    assert {file.name for file in tmp_path.iterdir()} == {"drive.py", "drive_robot.usd", "drive_world.usd"}
    poses = run_script(path, make_fake(6, robot="jackal"), monkeypatch, "--headless")
    assert math.dist(poses[-1][:2], setting.goals[-1][:2]) < 0.06


def test_with_a_window_it_stays_open_at_the_goal_until_it_is_closed(fake, monkeypatch, tmp_path):
    world = World.load(fake.assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    scene = plan(Robot.load("nova_carter"), world, (-2.5, -1.0, 0.0), (-2.0, -1.0))
    path = export_scene(scene, tmp_path / "drive.py", environment="warehouse")
    still, steps = 0, 0

    def watch(draw):
        nonlocal still, steps
        still = still + 1 if fake.steps and fake.steps == steps else 0
        steps = fake.steps
        fake.window_open = still < 20 and draw < 5000

    fake.on_draw = watch
    run_script(path, fake, monkeypatch)
    assert still == 20
    assert fake.body.position[0] == pytest.approx(-2.0, abs=0.06)
    assert fake.app_closes == 1


@pytest.mark.slow
def test_it_ends_when_the_window_is_closed_on_the_way(fake, monkeypatch, tmp_path, capsys):
    world = World.load(fake.assets / "Isaac/Environments/Simple_Warehouse/warehouse.usd")
    scene = plan(Robot.load("nova_carter"), world, (-2.5, -1.0, 0.0), (2.0, 1.5))
    path = export_scene(scene, tmp_path / "drive.py", environment="warehouse")

    def close(draw):
        fake.window_open = draw < 200

    fake.on_draw = close
    run_script(path, fake, monkeypatch)
    assert "before the end of the route" in capsys.readouterr().out
    assert fake.app_closes == 1


def test_it_needs_nothing_but_isaac_sim_and_numpy(tmp_path):
    scene = plan(Robot.load("nova_carter"), World.generate("corridors"), START, AHEAD)
    path = export_scene(scene, tmp_path / "drive.py", environment="hospital")
    tree = ast.parse(path.read_text(encoding="utf-8"))
    modules = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    modules |= {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    outside = {name.partition(".")[0] for name in modules} - set(sys.stdlib_module_names)
    assert outside == {"isaacsim", "numpy"}
    # Isaac Sim's modules are imported in functions, but for the one that starts it.
    first = {str(node.module) for node in tree.body if isinstance(node, ast.ImportFrom)}
    assert {name for name in first if name.startswith("isaacsim")} == {"isaacsim"}


def test_it_is_clean_and_formatted(tmp_path):
    scene = plan(Robot.load("nova_carter"), World.generate("corridors"), START, AHEAD)
    check_style(export_scene(scene, tmp_path / 'odd "name".py', environment="hospital"))


def check_style(path):
    ruff = [sys.executable, "-m", "ruff"]
    subprocess.run(
        [*ruff, "check", "-q", "--isolated", "--line-length=120", "--select=E,F,W,I,B,UP,N,C4,PIE,RET,SIM", path],
        check=True,
    )
    subprocess.run([*ruff, "format", "-q", "--isolated", "--line-length=120", "--check", path], check=True)


def test_the_stretches_of_a_plan_are_its_turns_and_what_lies_between():
    poses = [(0, 0, 0), (1, 0, 0), (1, 0, 1.5708), (1, 2, 1.5708), (1, 2, 3.0)]
    stretches = list(plan_stretches(Plan(np.array(poses, dtype=float))))
    assert [len(points) for _, _, points in stretches] == [2, 2, 0]
    assert [turn for turn, _, _ in stretches] == pytest.approx([0.0, math.pi / 2, 3.0 - math.pi / 2], abs=1e-4)
    assert [heading for _, heading, _ in stretches] == pytest.approx([0.0, math.pi / 2, 3.0], abs=1e-4)
    assert stretches[1][2] == [(1.0, 0.0), (1.0, 2.0)]


def test_a_path_is_written_as_the_list_that_it_is(tmp_path):
    poses = [(0, 0, 0), (1, 0, 0), (1, 0, 1.5708), (1, 2, 1.5708), (1, 2, 3.0)]
    plans = (Plan(np.array(poses, dtype=float)),)
    mask = SpeedMask(OccupancyGrid([[50]], 0.5, Pose2D(0.75, 1.01)))
    scene = Scene("s", World("w", ()), Robot.load("nova_carter"), Pose2D(0, 0), plans, mask)
    text = export_scene(scene, tmp_path / "s.py", environment="office").read_text(encoding="utf-8")
    assert (
        text[text.index("ROUTE = [") : text.index("# fmt: on")]
        == """\
ROUTE = [
    (0.0000, 0.0000, [
        (0.000, 0.000), (1.000, 0.000),
    ]),
    (1.5708, 1.5708, [
        (1.000, 0.000), (1.000, 2.000),
    ]),
    (1.4292, 3.0000, []),
]
# Speed limits, by the number of the stretch: between two distances along it, no faster than this [m, m, m/s].
LIMITS = {
    1: [
        (1.000, 1.525, 0.4),
    ],
}
"""
    )


def test_what_is_missing_is_said_and_nothing_is_written(tmp_path):
    world, robot = World.generate("corridors"), Robot.load("nova_carter")
    with pytest.raises(InputError, match="needs a planned path"):
        export_scene(Scene("s", world, robot, Pose2D(0.0, 0.0)), tmp_path / "s.py")
    scene = plan(robot, world, START, AHEAD)
    with pytest.raises(UnknownNameError, match="Did you mean 'warehouse'"):
        export_scene(scene, tmp_path / "s.py", environment="warehose")
    with pytest.raises(InputError, match="no such file"):
        export_scene(scene, tmp_path / "s.py", environment="gone.usd")
    with pytest.raises(InputError, match="no such file"):
        export_scene(scene, tmp_path / "s.py", environment="office", robot_usd="gone.usd")
    with pytest.raises(InputError, match="colour"):
        export_scene(scene, tmp_path / "s.py", environment="office", colour="red")
    assert list(tmp_path.iterdir()) == []


def test_a_usd_file_of_the_user_is_named_from_the_scripts_folder(tmp_path):
    world, robot = World.generate("corridors"), Robot.load("nova_carter")
    scene = plan(robot, world, START, AHEAD)
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "my hall.usd").write_text("")
    path = export_scene(scene, tmp_path / "s.py", environment=str(tmp_path / "scenes" / "my hall.usd"))
    assert 'ENVIRONMENT = "scenes/my hall.usd"' in path.read_text(encoding="utf-8")


def test_a_scenario_can_be_prepared_without_its_simulator():
    setting = Scenario.make(world="maze", backend="isaac", seed=1).prepare()
    assert setting.scenario.start == setting.start.as_tuple()
    assert not hasattr(setting, "sim")


def test_a_path_that_leads_backwards_is_refused():
    with pytest.raises(InputError, match="forward only"):
        list(plan_stretches(Plan(np.array([[1.0, 0, 0], [0, 0, 0]]), backward=np.array([True]))))
