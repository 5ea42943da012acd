"""Runs of robots with lidars: as they come, step by step, and as a scenario describes them."""

import math

import numpy as np
import pytest

import trundle
from mission.conftest import write_scenario
from support.observers import Recorder
from trundle.errors import ScenarioError, UnknownNameError
from trundle.files.choice import Choice
from trundle.geometry import Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.localization.odometry import OdometryLocalizer
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Scenario, Session, run
from trundle.mission.setup import session_options
from trundle.navigation import CommandScript
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

# Without further setup ------------------------------------------------------------------------------------------------


def run_with(lidar):
    cells = np.zeros((120, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    grid = OccupancyGrid(cells, 0.05)
    empty = World.from_map(grid)
    box = Solid("surprise", Box((0.8, 0.8, 1.0)), Pose3D((5.0, 3.0, 0.5)))
    world = World("room", (*empty.solids, box), empty.seeds)
    navigator = trundle.Navigator(grid, "nova_carter")
    with trundle.simulate(world, "nova_carter", backend="kinematic", lidar=lidar) as sim:
        return trundle.run(sim, navigator, (1.5, 3.0, 0.0), (8.5, 3.0))


def test_a_run_with_lidars_avoids_what_is_not_on_the_map():
    episode = run_with(lidar=True)
    assert episode.arrived
    assert episode.metrics.contacts == ()
    assert episode.metrics.monitor_stops is not None


def test_a_run_without_lidars_drives_into_it():
    episode = run_with(lidar=False)
    assert episode.metrics.contacts == ("surprise",)
    assert episode.metrics.monitor_stops is None


# Steps ----------------------------------------------------------------------------------------------------------------


def test_a_second_goal_is_set_at_the_same_time_without_the_scans_again(carter, navigator, start):
    seen = []
    update = navigator.update

    def watch(observation, estimate):
        seen.append((observation.time, len(observation.scans)))
        return update(observation, estimate)

    navigator.update = watch
    with KinematicSimulator(World("empty", ()), carter, lidar=["front"]) as sim:
        run(sim, navigator, start, [(1.6, 1.5), (1.7, 1.5)], monitor=False)
    assert seen[0] == (0.0, 1)
    assert seen[1] == (0.0, 0)


def test_scans_are_in_the_step_that_brings_them(carter, start):
    with KinematicSimulator(World("empty", ()), carter, lidar=["front"]) as sim:
        session = Session(sim, CommandScript([(0.4, 0.0, 2.0)]), start, monitor=False)
        step = session.step()
    assert step.scans == step.state.scans
    assert isinstance(step.scans[0], Scan)


# Scenarios ------------------------------------------------------------------------------------------------------------


def test_a_scenario_has_errors_of_odometry_and_lidars(tmp_path):
    (tmp_path / "run.yaml").write_text(
        "world: maze\nbackend: kinematic\nodometry: {scale: 0.01, heading: 1deg}\nlidar: [front]\n"
    )
    scenario = Scenario.load(tmp_path / "run.yaml")
    assert scenario.odometry.heading == pytest.approx(math.radians(1.0))
    with scenario.build() as mission:
        mission.sim.reset(mission.start, seed=1)
        state = mission.sim.step(Twist2D(0.3, 0.0), 0.05)
    assert state.odometry_twist.v != state.twist.v
    assert [scan.lidar for scan in state.scans] == ["front"]
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml") == scenario
    scenario.save_commented(tmp_path / "commented.yaml")
    assert Scenario.load(tmp_path / "commented.yaml") == scenario


def test_lidars_are_given_once():
    with pytest.raises(ScenarioError, match="lidar is given twice"):
        Scenario.make(world="maze", lidar=True, backend={"name": "mujoco", "options": {"lidar": True}})


def test_an_unknown_lidar_of_a_scenario_is_reported():
    with pytest.raises(UnknownNameError, match="unknown lidar of nova_carter 'frnt'"):
        Scenario.make(world="maze", lidar="frnt", backend="kinematic").build()


SENSING = """
world: {name: cylinders, options: {length: 3, density: 0.02}}
backend: kinematic
start: [-1, 0, 0]
goal: [4, 0]
lidar: true
known_map: false
localizer: odometry
odometry: {scale: 0.001}
layers: {obstacle: null}
latency: {scan_age_s: 0.05}
collision_monitor: {min_points: 4}
"""


def test_a_scenario_says_how_the_robot_senses(tmp_path):
    scenario = Scenario.load(write_scenario(tmp_path, SENSING))
    assert scenario.localizer == Choice(name="odometry")
    assert scenario.layers.obstacle is None
    assert scenario.latency.scan_age_s == 0.05
    assert scenario.collision_monitor.min_points == 4
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml") == scenario
    scenario.save_commented(tmp_path / "commented.yaml")
    assert Scenario.load(tmp_path / "commented.yaml") == scenario


def test_a_robot_without_a_map_starts_with_unknown_space_and_the_same_mission():
    given = {"world": "maze", "backend": "kinematic", "seed": 4}
    known, blank = Scenario.make(**given).prepare(), Scenario.make(**given, lidar=True, known_map=False).prepare()
    assert blank.navigator.grid is None
    assert len(set(blank.navigator.costmap.data.ravel().tolist())) == 1
    assert (known.start, known.goals) == (blank.start, blank.goals)
    assert np.array_equal(blank.grid.data, known.grid.data)


def test_what_stands_between_simulator_and_navigator_is_made_of_the_scenario():
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid(np.zeros((10, 10), np.int8), 0.05)
    given = {"world": "maze", "localizer": "odometry", "latency": {"command_delay_s": 0.1}}
    made = session_options(Scenario.make(**given, collision_monitor={"min_points": 5}), grid, robot)
    assert isinstance(made["localizer"], OdometryLocalizer)
    assert made["latency"].command_delay_s == 0.1
    assert made["monitor"].settings.min_points == 5
    for wanted in (None, True, False):
        assert session_options(Scenario.make(world="maze", collision_monitor=wanted), grid, robot)["monitor"] is wanted


def test_an_unknown_localizer_is_reported():
    grid = OccupancyGrid(np.zeros((10, 10), np.int8), 0.05)
    with pytest.raises(UnknownNameError, match="unknown localizer 'odometri'"):
        session_options(Scenario.make(world="maze", localizer="odometri"), grid, Robot.load("nova_carter"))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"known_map": False}, "a robot that does not know the map needs lidars"),
        ({"localizer": "amcl"}, "localizer amcl finds the robot by the scans of its lidars: give lidar: true"),
        ({"localizer": {"name": "slam"}, "lidar": False}, "localizer slam finds the robot by the scans"),
        ({"known_map": False, "lidar": True, "keepout": "zones.yaml"}, "areas of a map"),
        ({"latency": {"scan_age_s": 3}}, "scan_age_s"),
        ({"layers": {"obstacl": None}}, "Did you mean 'obstacle'"),
    ],
)
def test_settings_of_sensing_that_cannot_be_used_are_refused(settings, words):
    with pytest.raises(ScenarioError, match=words):
        Scenario.make(world="maze", **settings)


def test_a_robot_drives_by_lidar_alone(tmp_path):
    scenario = Scenario.load(write_scenario(tmp_path, SENSING.replace("layers: {obstacle: null}\n", "")))
    recorder = Recorder()
    with scenario.build() as mission:
        episode = mission.run(observers=[recorder])
    assert episode.outcome is Outcome.ARRIVED
    assert any(step.scans for step in recorder.steps)
    assert recorder.steps[-1].estimate.pose != recorder.steps[-1].state.pose
    assert episode.metrics.contacts == ()
