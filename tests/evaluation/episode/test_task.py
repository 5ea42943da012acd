import pickle
import subprocess
import sys
from dataclasses import replace

import pytest

from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.suite import Suite
from trundle.mission import Outcome

SMALL = {"name": "warehouse", "options": {"size": [14, 11]}, "seed": 3}
OTHER = {"name": "cylinders", "seed": 1}


def suite(**settings):
    return Suite.make(**{"worlds": [SMALL, OTHER], "backends": ["kinematic", "mujoco"], "seeds": 2} | settings)


@pytest.fixture(scope="module")
def rows():
    task = EpisodeTask(suite())
    return [task(index).unmeasured() for index in range(len(task.suite))]


@pytest.mark.slow
def test_a_row_is_the_same_whatever_ran_before(rows):
    task = EpisodeTask(suite())
    for index in (5, 0, 7, 7, 2, 6, 1, 4, 3, 0):
        assert task(index).unmeasured() == rows[index]


def test_a_row_tells_the_mission_the_outcome_and_where_the_robot_drove(rows):
    row = EpisodeTask(suite())(0)
    assert row.unmeasured() == rows[0]
    assert row.outcome == "arrived"
    assert (row.trail[0], row.trail[1]) == (round(row.start_x, 2), round(row.start_y, 2))
    assert row.trail[-2:] == (round(row.end_x, 2), round(row.end_y, 2))
    assert 0.0 < row.shortest_path_m <= row.distance_m + 0.5
    assert row.cpu_s > 0.0
    assert row.wall_s > 0.0
    assert row.planning_ms > 0.0


def test_missions_pair_planners_backends_and_settings(rows):
    by_backend = [{row["mission"] for row in rows if row["backend"] == name} for name in ("kinematic", "mujoco")]
    assert by_backend[0] == by_backend[1]
    assert len(by_backend[0]) == 4
    crossed = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1, inflation_radius=[0.3, 0.8]))
    assert crossed(0).mission == crossed(1).mission
    assert crossed(0).id != crossed(1).id
    assert crossed(0).settings == "inflation_radius=0.3"


@pytest.mark.parametrize("index", [0, 5])
def test_the_exact_scenario_gives_the_same_run(rows, index):
    scenario = EpisodeTask(suite()).scenario_of(index)
    with scenario.build() as mission:
        episode = mission.run()
    row = rows[index]
    assert mission.scenario == scenario
    assert episode.outcome.value == row["outcome"]
    assert episode.metrics.distance_m == row["distance_m"]
    assert episode.metrics.min_clearance_m == row["min_clearance_m"]
    assert episode.metrics.shortest_path_m == row["shortest_path_m"]
    assert (row["recoveries"], row["behaviors"]) == (0, "")
    assert (row["standing_periods"], row["standing_reason"]) == (0, "")
    assert (row["standing_contacts"], row["unseen_contacts"], row["monitor_stops"]) == (0, 0, None)
    assert row["position_error_m"] == episode.metrics.position_error_m == 0.0
    assert episode.trajectory.poses[-1].tolist() == [row["end_x"], row["end_y"], row["end_yaw"]]


def test_a_copied_task_gives_the_same_rows(rows):
    task = EpisodeTask(suite())
    task(0)
    assert pickle.loads(pickle.dumps(task))(1).unmeasured() == rows[1]


IMPORTED_BY_AN_EPISODE = """
import importlib, sys
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.suite import Suite

world = {"name": "cylinders", "seed": 1}
task = EpisodeTask(Suite.make(worlds=world, maps=sys.argv[1], backends=["kinematic", "mujoco"]))
for name in task.modules:
    importlib.import_module(name)
before = set(sys.modules)
for index in (0, 1, len(task.suite) - 1):
    task(index)
print(*sorted(name for name in set(sys.modules) - before if name.partition(".")[0] in ("mujoco", "numpy", "PIL")))
"""


@pytest.mark.slow
def test_a_process_with_the_modules_of_a_task_imports_no_library_for_an_episode(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    command = [sys.executable, "-c", IMPORTED_BY_AN_EPISODE, str(tmp_path / "room.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_what_is_known_is_noted_before_each_stage():
    noted = []
    row = EpisodeTask(suite())(0, lambda note: noted.append(note | {"row": dict(note["row"])}))
    assert [note["stage"] for note in noted] == ["setup", "setup", "setup", "drive"]
    assert noted[0]["part"] == "world warehouse, robot nova_carter"
    assert "auto" in noted[1]["part"]
    assert noted[0]["row"]["id"] == row.id
    for name in ("mission", "start_x", "goal_y"):
        assert noted[1]["row"][name] == getattr(row, name)


def test_what_is_varied_is_drawn_applied_and_recorded():
    vary = {"wheel_radius": 1.1, "start_pose": {"x": {"uniform": [0.0, 0.05]}}}
    plain = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1))
    varied = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1, vary=vary))
    nominal, row = plain(0), varied(0)
    assert row.vary["wheel_radius"] == 1.1
    assert 0.0 < row.vary["start_pose.x"] <= 0.05
    assert row.start_x == nominal.start_x + row.vary["start_pose.x"]
    assert row.mission == nominal.mission
    assert row.id != nominal.id
    with varied.scenario_of(0).build() as mission:
        assert mission.run().metrics.distance_m == row.distance_m


def test_a_mission_whose_start_is_blocked_has_no_path():
    missions = [{"start": (-100.0, 0.0, 0.0), "goal": (0.0, 0.0)}]
    row = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", missions=missions))(0)
    assert row.outcome == Outcome.NO_PATH.value
    assert row.time_s == 0.0
    assert row.message


def test_listed_missions_drive_through_their_goals_in_order():
    sampled = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1))(0)
    start = (sampled.start_x, sampled.start_y, sampled.start_yaw)
    goal = (sampled.goal_x, sampled.goal_y, sampled.goal_yaw)
    one = suite(worlds=[SMALL], backends="kinematic", missions=[{"start": start, "goal": goal}])
    row = EpisodeTask(one)(0)
    assert row.mission == sampled.mission
    assert row.distance_m == sampled.distance_m
    several = suite(worlds=[SMALL], backends="kinematic", missions=[{"start": start, "goals": [goal, start]}])
    back = EpisodeTask(several)(0)
    assert (back.goal_x, back.goal_y) == (sampled.start_x, sampled.start_y)
    assert back.distance_m > 1.5 * row.distance_m


def straight(costmap, start, goal):
    return [start.as_tuple(), goal.as_tuple()]


class Straight:
    def plan(self, costmap, start, goal):
        from trundle.path import Path

        return Path(straight(costmap, start, goal))


def broken(costmap, start, goal):
    raise RuntimeError("no map today")


@pytest.mark.parametrize("planner", [straight, Straight, Straight()])
def test_functions_classes_and_objects_plan(planner):
    task = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1, planners=["auto", planner]))
    row = pickle.loads(pickle.dumps(task))(1)
    assert row.planner.lower() == "straight"
    gap = ((row.goal_x - row.start_x) ** 2 + (row.goal_y - row.start_y) ** 2) ** 0.5
    assert row.path_length_m == pytest.approx(gap)


def test_what_a_planner_raises_is_raised():
    task = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds=1, planners=broken))
    with pytest.raises(RuntimeError, match="no map today"):
        task(0)


def test_rows_survive_json(rows):
    row = EpisodeTask(suite())(0)
    assert type(row).of(row.as_dict()) == row
    assert replace(row, wall_s=1.0).unmeasured() == row.unmeasured()


def test_a_row_does_not_depend_on_where_a_map_is(room, tmp_path, monkeypatch):
    for folder in (tmp_path, tmp_path / "other"):
        folder.mkdir(exist_ok=True)
        room.save(folder / "room.yaml")
    there = EpisodeTask(suite(worlds=str(tmp_path / "other" / "room.yaml"), backends="kinematic", seeds=1))(0)
    monkeypatch.chdir(tmp_path)
    assert EpisodeTask(suite(worlds="room.yaml", backends="kinematic", seeds=1))(0).unmeasured() == there.unmeasured()


@pytest.mark.slow
def test_an_episode_with_errors_of_everything_is_run_again_exactly_and_drives_the_same_mission():
    errors = {
        "lidar": True,
        "localizer": "odometry",
        "odometry": {"scale": 0.01, "slips": {"every": 2.0}},
        "lidar_errors": {"noise": 0.02, "dropouts": 0.05, "short_returns": 0.02},
        "start_error": [None, {"distance": 0.2, "heading": "5deg"}],
        "map_errors": [None, {"missing": 0.5, "ghosts": 3}],
        "unmapped": {"boxes": 2},
    }
    limits = {"time_limit_s": 8.0}
    task = EpisodeTask(suite(worlds=[SMALL], backends="kinematic", seeds="5:6", limits=limits, **errors))
    rows = [task(index) for index in range(4)]
    assert len({row.mission for row in rows}) == 1
    assert len({row.localization_error_m for row in rows}) == 4
    assert task(0).unmeasured() == rows[0].unmeasured()
    with task.scenario_of(3).build() as mission:
        episode = mission.run()
    assert episode.metrics.localization_error_m == rows[3].localization_error_m
    assert episode.trajectory.poses[-1].tolist() == [rows[3].end_x, rows[3].end_y, rows[3].end_yaw]
