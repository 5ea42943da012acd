"""Runs through several poses, and with tasks at waypoints."""

import math

import numpy as np
import pytest

import trundle
from trundle.errors import InputError
from trundle.evaluation import Suite
from trundle.evaluation.episode.task import EpisodeTask
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, run
from trundle.navigation import CommandScript, NavigationStatus, Navigator, Waypoint
from trundle.navigation.behaviors import BackUp, DriveOnHeading, Spin, Wait
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
GRID = OccupancyGrid(np.zeros((160, 240), np.int8), 0.05)
START, GOALS = (1.5, 4.0, 0.0), [(4.0, 4.6), (6.5, 3.8), (9.0, 4.6), (10.8, 4.0)]


def drive(goals, *, backend="kinematic", navigator=None, **options):
    navigator = Navigator(GRID, CARTER) if navigator is None else navigator
    with simulate(World.from_map(GRID), CARTER, backend=backend) as sim:
        return run(sim, navigator, START, goals, **options)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_run_through_poses_counts_them_and_does_not_stop(backend):
    episode = drive(GOALS, backend=backend, through=True)
    assert episode.outcome is Outcome.ARRIVED
    assert episode.goals_reached == 4
    rows = episode.trajectory
    assert list(dict.fromkeys(rows.goal.tolist())) == [0, 1, 2, 3]
    for x, y in GOALS[:-1]:
        assert rows.v[np.hypot(rows.x - x, rows.y - y).argmin()] > 0.4
    assert episode.metrics.time_s < drive(GOALS, backend="kinematic").metrics.time_s - 2.0


def test_tasks_of_waypoints_run_and_are_recorded():
    goals = [Waypoint(4.0, 4.0, 0.0, tasks=[Spin(1.57), Wait(1.0)]), Waypoint(7.0, 4.0, 0.0, tasks=[BackUp(0.5)])]
    episode = drive(goals)
    assert episode.outcome is Outcome.ARRIVED
    assert episode.goals == ((4.0, 4.0, 0.0), (7.0, 4.0, 0.0))
    assert [(ran.behavior, ran.reason) for ran in episode.behaviors] == [
        ("spin", "task of goal 1"),
        ("wait", "task of goal 1"),
        ("back_up", "task of goal 2"),
    ]
    assert episode.metrics.recoveries == 0
    assert episode.trajectory.goal.max() == 1
    assert episode.goals_reached == 2
    assert math.isclose(episode.trajectory.x[-1], 6.6, abs_tol=0.35)


def test_a_task_that_fails_is_the_reason_of_the_end():
    data = np.zeros((160, 240), np.int8)
    data[60:100, 120:130] = 100
    grid = OccupancyGrid(data, 0.05)
    with simulate(World.from_map(grid), CARTER, backend="kinematic") as sim:
        goals = [Waypoint(4.0, 4.0, 0.0, tasks=[DriveOnHeading(3.0)]), (10.0, 4.0)]
        episode = run(sim, Navigator(grid, CARTER), START, goals)
    assert episode.outcome is Outcome.STUCK
    assert "drive_on_heading (task of goal 1) failed" in episode.message
    assert episode.goals_reached == 1


def test_a_pose_that_cannot_be_driven_through_is_named():
    data = np.zeros((160, 240), np.int8)
    data[:, 120:122] = 100
    grid = OccupancyGrid(data, 0.05)
    with simulate(World.from_map(grid), CARTER, backend="kinematic") as sim:
        episode = run(sim, Navigator(grid, CARTER), START, [(4.0, 4.0), (9.0, 4.0), (3.0, 2.0)], through=True)
    assert episode.outcome is Outcome.NO_PATH
    assert episode.message.startswith("goal 2: ")


def test_a_behavior_runs_between_two_steps_of_a_session():
    navigator = Navigator(GRID, CARTER)
    with simulate(World.from_map(GRID), CARTER, backend="kinematic") as sim:
        with trundle.Session(sim, navigator, START, GOALS[-1]) as session:
            while (step := session.step()) is not None:
                if step.index == 40:
                    navigator.run(Spin(1.0))
        episode = session.finish()
    assert episode.outcome is Outcome.ARRIVED
    assert [(ran.behavior, ran.reason, ran.result) for ran in episode.behaviors] == [("spin", "asked for", "succeeded")]


def test_an_agent_of_one_goal_at_a_time_is_refused():
    class OneByOne(CommandScript):
        pass

    with pytest.raises(InputError, match="OneByOne takes one goal at a time"):
        drive(GOALS, navigator=OneByOne([(0.1, 0.0, 1.0)]), through=True)


def test_the_time_limit_leaves_room_for_the_tasks():
    navigator = Navigator(GRID, CARTER)
    with simulate(World.from_map(GRID), CARTER, backend="kinematic") as sim:
        short = trundle.Session(sim, navigator, START, [(4.0, 4.0)]).info.time_limit_s
        long = trundle.Session(sim, navigator, START, [Waypoint(4.0, 4.0, tasks=[Wait(100.0)])]).info.time_limit_s
    assert long == pytest.approx(short + Wait(100.0).time_allowance)
    assert navigator.status is NavigationStatus.DRIVING


WORLD = {"name": "warehouse", "options": {"size": [14, 11]}}


def scenario_through(**settings):
    mission = trundle.Scenario.make(world=WORLD, backend="kinematic").prepare()
    path = mission.navigator
    path.set_goal(mission.goals[0])
    poses = path.plan(mission.start).poses
    x, y, _ = poses[len(poses) // 2]
    return trundle.Scenario.make(
        world=WORLD,
        backend="kinematic",
        start=mission.start.as_tuple(),
        goals=[(x, y), {"pose": mission.goals[0], "turn": "45deg", "wait": 0.5, "tasks": ["wait=0.2"]}],
        **settings,
    )


def test_a_scenario_with_waypoints_comes_back_and_runs(tmp_path):
    scenario = scenario_through(through=True, recovery=["replan", {"back_up": 0.4}])
    scenario.save(tmp_path / "tour.yaml")
    text = (tmp_path / "tour.yaml").read_text()
    assert "back_up: {distance: 0.4}" in text
    assert "wait: {seconds: 0.2}" in text
    assert trundle.Scenario.load(tmp_path / "tour.yaml") == scenario
    scenario.save_commented(tmp_path / "commented.yaml")
    assert trundle.Scenario.load(tmp_path / "commented.yaml") == scenario
    with scenario.build() as mission:
        assert mission.scenario.goals == scenario.goals
        episode = mission.run()
    assert episode.outcome is Outcome.ARRIVED
    assert [ran.behavior for ran in episode.behaviors] == ["spin", "wait", "wait"]


@pytest.mark.parametrize(
    ("goals", "said"),
    [
        ([(1.0,)], "goals.0"),
        ([{"pose": (1.0, 2.0), "wat": 1.0}], "Did you mean 'wait'"),
        ([{"wait": 1.0}], "pose"),
        ([{"pose": (1.0, 2.0), "tasks": ["spn=1"]}], "Did you mean 'spin'"),
        ([{"pose": (1.0, 2.0), "wait": -1.0}], "wait"),
        ([], "goals"),
    ],
)
def test_bad_goals_of_a_scenario_are_named(goals, said):
    with pytest.raises(InputError, match=said):
        trundle.Scenario.make(world=WORLD, goals=goals)


def test_a_suite_lists_missions_through_poses():
    scenario = scenario_through()
    goals = scenario.model_dump()["goals"]
    missions = {"listed": [{"start": scenario.start, "goals": goals, "through": True}]}
    suite = Suite.make(worlds=[WORLD], backends="kinematic", missions=missions)
    row = EpisodeTask(suite)(0)
    assert (row.outcome, row.behaviors, row.recoveries) == ("arrived", "spin 1, wait 2", 0)
    assert EpisodeTask(suite).scenario_of(0).through
    assert "through" not in Suite.make(
        worlds=[WORLD], missions={"listed": [{"start": scenario.start, "goals": goals}]}
    ).missions.listed[0].model_dump(exclude_none=True)
