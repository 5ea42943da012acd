"""Missions with lidars in the kernel against the same ones step by step in Python."""

from importlib import resources

import numpy as np
import pytest

from support.batch_missions import assert_alike, in_kernel, in_python, scenario, wall
from trundle.control import CollisionMonitor
from trundle.costmap import Costmap
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome
from trundle.mission.batch.missions import BatchMission, HandedOver, MissionBatch
from trundle.mission.batch.needs import needs_python
from trundle.mission.batch.sensing import _Doubts
from trundle.mission.scenario import Scenario
from trundle.path import Path
from trundle.robots import Robot
from trundle.worlds import World

NO_LAYER = {"obstacle": None}


def assert_driven_alike(chosen: Scenario) -> None:
    found, driven = in_kernel(chosen), in_python(chosen)
    assert driven.outcome is Outcome.ARRIVED
    assert_alike(found, driven)
    assert found.metrics.monitor_stops == driven.metrics.monitor_stops
    assert found.metrics.replans == driven.metrics.replans == 0


@pytest.mark.parametrize(
    "settings",
    [
        {"layers": NO_LAYER, "collision_monitor": False},
        {"layers": NO_LAYER, "collision_monitor": True},
        {"collision_monitor": False},
        {},
        {"lidar": "front"},
        {"collision_monitor": {"stop_padding": 0.1, "time_before_collision": 2.0}},
        {"layers": {"obstacle": {"hits_to_mark": 1, "observation_persistence": 0.5}}},
    ],
    ids=("scans", "scans and monitor", "layers", "default", "one lidar", "settings of the monitor", "of the layer"),
)
@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_burger"])
def test_a_sensed_mission_is_the_one_of_python(robot, settings):
    assert_driven_alike(scenario(**{"seed": 2, "robot": robot, "lidar": True} | settings | _names(robot, settings)))


def _names(robot: str, settings: dict) -> dict:
    return {"lidar": next(iter(Robot.load(robot).lidars))} if "lidar" in settings else {}


def test_a_robot_that_has_no_lidars_has_no_monitor_either(tmp_path):
    text = (resources.files("trundle.robots") / "catalogue" / "nova_carter.yaml").read_text()
    (tmp_path / "blind.yaml").write_text(text[: text.index("lidars:")] + text[text.index("map_height_band") :])
    assert_driven_alike(scenario(seed=2, lidar=True, robot=str(tmp_path / "blind.yaml")))


def test_commands_that_the_monitor_slows_down_are_driven_alike():
    chosen = scenario(world={"name": "office", "seed": 0}, robot="jackal", lidar=True, seed=1)
    free = scenario(**{**chosen.plain(), "collision_monitor": False})
    assert_driven_alike(chosen)
    assert in_kernel(chosen).metrics.time_s > in_kernel(free).metrics.time_s


def test_a_robot_that_the_monitor_stops_for_ever_is_handed_over_and_ends_alike(on_a_map):
    chosen = on_a_map(True, lidar="back", collision_monitor={"sources": ["front"]})
    assert isinstance(in_kernel(chosen), HandedOver)
    assert in_python(chosen).outcome is not Outcome.ARRIVED


def test_a_robot_that_the_monitor_holds_for_a_second_drives_on_alike(on_a_map, monkeypatch):
    check = CollisionMonitor.check

    def hold(self, command, twist, scans, time, odometry):
        report = check(self, command, twist, scans, time, odometry)
        return report if not 2.0 <= time < 3.0 else type(report)(type(command)(), "stop")

    monkeypatch.setattr(CollisionMonitor, "check", hold)
    chosen = on_a_map(True, lidar=True)
    found, driven = in_kernel(chosen), in_python(chosen)
    assert_alike(found, driven)
    assert found.metrics.monitor_stops == driven.metrics.monitor_stops == 1


@pytest.fixture
def on_a_map(tmp_path):
    def make(doorway: bool, grid: OccupancyGrid | None = None, **settings) -> Scenario:
        (grid or wall(doorway)).save(tmp_path / "map.yaml")
        ends = {"start": (1.0, 2.0, 0.0), "goal": (5.0, 2.0)}
        return scenario(world=None, map=str(tmp_path / "map.yaml"), **ends | settings)

    return make


def with_unknown(first: int, end: int, behind_wall: bool) -> OccupancyGrid:
    cells = np.array(wall(True).data)
    cells[first:end, 20:40] = -1
    if behind_wall:
        cells[first - 1, 19:41] = cells[first:end, 19] = cells[first:end, 40] = 100
    return OccupancyGrid(cells, 0.05)


def test_unknown_cells_that_lidars_see_near_the_path_are_left_to_python(on_a_map):
    chosen = on_a_map(True, with_unknown(55, 78, behind_wall=False), lidar=True)
    assert in_kernel(chosen) == HandedOver("unknown cells near the path")
    assert not isinstance(in_kernel(on_a_map(True, with_unknown(55, 78, behind_wall=False))), HandedOver)


def test_unknown_cells_behind_a_wall_make_no_difference(on_a_map):
    assert_driven_alike(on_a_map(True, with_unknown(55, 78, behind_wall=True), lidar=True))


def test_hits_on_what_the_map_lacks_are_not_expected():
    costmap = Costmap.from_grid(wall(True), Robot.load("nova_carter"))
    doubts = _Doubts.of(costmap, Robot.load("nova_carter"), None)
    edge = Solid("edge", Box((0.1, 4.0, 1.0)), Pose3D.planar(0.05, 2.0, 0.5))
    shelf = Solid("shelf", Box((0.4, 0.4, 0.1)), Pose3D.planar(1.5, 2.0, 0.4))
    assert doubts.expect_all(World("walls", (edge,)), [0.4])
    assert not doubts.expect_all(World("shelf", (edge, shelf)), [0.41])
    assert doubts.expect_all(World("shelf", (edge, shelf)), [0.6])


def test_a_path_that_is_blocked_on_the_map_is_left_to_python_with_layers(on_a_map):
    assert isinstance(in_kernel(on_a_map(False, planner=straight, lidar=True)), HandedOver)


def straight(costmap, start, goal):
    return Path(np.array([(1.0, 2.0, 0.0), (5.0, 2.0, 0.0)]))


def noisy(tmp_path, noise: float) -> str:
    catalogue = resources.files("trundle.robots") / "catalogue" / "nova_carter.yaml"
    path = tmp_path / "noisy.yaml"
    path.write_text(catalogue.read_text().replace("z: 0.418", f"z: 0.418, noise: {noise}"))
    return str(path)


def test_lidars_whose_noise_may_mark_cells_near_the_path_are_left_to_python(tmp_path):
    chosen = scenario(seed=2, lidar=True, robot=noisy(tmp_path, 0.3), collision_monitor=False)
    assert in_kernel(chosen) == HandedOver("noise of a lidar near the path")


def test_noise_that_marks_nothing_is_driven_alike(tmp_path):
    assert_driven_alike(scenario(seed=2, lidar=True, robot=noisy(tmp_path, 0.005)))


@pytest.mark.parametrize("lidar", [False, True])
def test_unmapped_boxes_matter_only_near_the_path(lidar):
    ends = []
    for seed in range(6):
        chosen = scenario(
            world={"name": "warehouse", "seed": 3},
            unmapped={"boxes": 2, "near_path": 0.0},
            lidar=lidar,
            collision_monitor=False,
            seed=seed,
        )
        found = in_kernel(chosen)
        ends.append(found)
        if not isinstance(found, HandedOver):
            assert_alike(found, in_python(chosen))
    assert HandedOver("an unmapped box near the path") in ends
    assert any(not isinstance(end, HandedOver) for end in ends)


def test_boxes_in_the_way_are_left_to_python():
    chosen = scenario(world={"name": "warehouse", "seed": 3}, unmapped={"boxes": 20, "near_path": 1.0}, lidar=True)
    assert isinstance(in_kernel(chosen), HandedOver)


def test_missions_with_and_without_a_monitor_are_driven_in_one_call():
    missions = [BatchMission(scenario(seed=1, lidar=True, collision_monitor=on).prepare()) for on in (True, False)]
    checked, free = MissionBatch().drive(missions)
    assert checked.metrics.monitor_stops == 0
    assert free.metrics.monitor_stops is None


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"known_map": False}, "known_map"),
        ({"unknown": "costly"}, "unknown is costly"),
        ({"layers": {"rolling_window": True}}, "rolling_window"),
        ({"layers": {"obstacle": {"clear_static": True}}}, "clear_static"),
        ({"lidar_errors": {"noise": 0.1}}, "lidar_errors"),
    ],
)
def test_what_lidars_need_of_python_is_named(settings, named):
    assert not needs_python(scenario(lidar=True))
    assert any(named in need for need in needs_python(scenario(lidar=True, **settings)))
