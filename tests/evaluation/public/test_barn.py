import math

import numpy as np
import pytest

from support.public_worlds import write_barn
from trundle.errors import InputError, TrundleError
from trundle.evaluation import Suite
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.public.barn import GOAL, START, barn_suite, find_worlds
from trundle.evaluation.public.conditions import Conditions, benchmark_robot, write_robot
from trundle.robots import Robot

KINEMATIC = Conditions(seeds=1, backends=["kinematic"])


def test_worlds_are_found_by_number_with_their_paths(barn):
    assert list(find_worlds(barn)) == [0, 7]
    assert find_worlds(barn, [7]) == {7: (barn / "world_7.world", barn / "path_7.npy")}


def test_paths_may_lie_in_a_folder_of_their_own_as_in_the_data_set(barn):
    (barn / "path_files").mkdir()
    (barn / "path_7.npy").rename(barn / "path_files" / "path_7.npy")
    assert find_worlds(barn)[7][1] == barn / "path_files" / "path_7.npy"


def test_other_files_are_no_worlds(barn):
    for name in ("world_7.world.bak", "world_x.world", "world_.world", "LICENSE"):
        (barn / name).write_text("")
    assert list(find_worlds(barn)) == [0, 7]


def test_a_missing_path_is_named(barn):
    (barn / "path_7.npy").unlink()
    with pytest.raises(InputError, match=r"there is no path_7\.npy for world_7\.world"):
        find_worlds(barn)
    assert list(find_worlds(barn, [0])) == [0]


def test_a_number_that_is_not_there_is_named_with_those_that_are(barn):
    with pytest.raises(InputError, match=r"no world_3\.world; it has worlds 0, 7"):
        find_worlds(barn, [0, 3])


def test_wrong_folders_are_named(barn, tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        find_worlds(tmp_path / "nowhere")
    with pytest.raises(InputError, match="a file: give the folder that holds it"):
        find_worlds(barn / "world_0.world")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"no world_N\.world in it; Daffan"):
        find_worlds(tmp_path / "empty")
    with pytest.raises(InputError, match=r"there are some in .*BARN"):
        find_worlds(tmp_path)


def test_a_damaged_path_is_refused_before_anything_runs(barn):
    (barn / "path_0.npy").write_bytes(b"\x93NUMPY")
    with pytest.raises(InputError, match=r"path_0\.npy: no path of BARN's"):
        barn_suite(barn)


def test_the_robot_gets_no_map_and_the_run_ends_as_in_the_challenge(barn):
    spec = barn_suite(barn, KINEMATIC).spec(0)
    scenario = spec.scenario
    assert (spec.world, spec.listed.start, spec.listed.goal) == ("world_0", START, GOAL)
    assert not scenario.known_map
    assert scenario.lidar is True
    assert scenario.time_limit_s == 100.0
    assert (scenario.rules.arrival_radius, scenario.rules.every_contact) == (1.0, True)
    assert (scenario.odometry.walk, scenario.odometry.heading_walk) == (0.005, 0.005)
    assert scenario.localizer.name == "odometry"


def test_conditions_reach_the_scenario(barn):
    conditions = Conditions(drift=False, scan_age_s=0.05, command_delay_s=0.1, planners=["least_cost"])
    scenario = barn_suite(barn, conditions).spec(0).scenario
    assert scenario.odometry is None
    assert scenario.localizer is None
    assert (scenario.latency.scan_age_s, scenario.latency.command_delay_s) == (0.05, 0.1)
    assert scenario.planner.name == "least_cost"


def test_an_episode_has_barns_score_and_the_shortest_time(barn):
    row = EpisodeTask(barn_suite(barn, KINEMATIC))(0)
    assert row.outcome == "arrived"
    length = np.sum(np.hypot(*np.diff([(-2.25, 3.0), (-2.175, 5.075), (-2.175, 9.425), (-2.25, 13.0)], axis=0).T))
    assert row.reference_path_m == pytest.approx(length, abs=1e-6)
    best = length / 2.0
    assert row.barn_score == pytest.approx(best / min(max(row.time_s, 2.0 * best), 8.0 * best))
    assert row.shortest_time_s == pytest.approx((length - 1.0) / 2.0 + 1.0 / 3.0, abs=0.01)
    assert row.time_s > row.shortest_time_s
    assert 0.9 < math.dist((row.end_x, row.end_y), GOAL) <= 1.0


def test_a_run_that_fails_scores_nothing(tmp_path):
    wall = [(x, 6.0) for x in np.arange(-8.0, 4.0, 0.15)]
    write_barn(tmp_path / "b", 0, wall)
    suite = barn_suite(tmp_path / "b", KINEMATIC)
    short = Suite.make(
        **{name: getattr(suite, name) for name in suite.model_fields_set} | {"limits": {"time_limit_s": 3}}
    )
    row = EpisodeTask(short)(0)
    assert row.outcome == "timed_out"
    assert row.barn_score == 0.0
    assert row.shortest_time_s > 0.0


def test_episodes_are_told_apart_by_the_reference_path_and_the_suite_can_be_saved(barn, tmp_path):
    suite = barn_suite(barn, KINEMATIC)
    suite.save(tmp_path / "suite.yaml")
    again = Suite.load(tmp_path / "suite.yaml")
    assert again.id_of(0) == suite.id_of(0)
    assert again.spec(0).reference == str(barn / "path_0.npy")
    cells = np.load(barn / "path_0.npy")
    np.save(barn / "path_0.npy", cells[:-3])
    assert barn_suite(barn, KINEMATIC).id_of(0) != suite.id_of(0)


def test_the_robot_has_barns_lidar(tmp_path):
    file = write_robot(tmp_path, benchmark_robot("jackal", speed=3.0, noise=0.02))
    assert file.endswith("jackal_3mps.yaml")
    jackal = Robot.load(file)
    (lidar,) = jackal.lidars.values()
    assert (lidar.beams, lidar.range_max, lidar.rate, lidar.noise) == (720, 10.0, 20.0, 0.02)
    assert lidar.fov == pytest.approx(math.radians(270.0))
    assert (jackal.limits.linear_speed, jackal.limits.reverse_speed) == (3.0, 3.0)
    assert jackal.limits.linear_acceleration == Robot.load("jackal").limits.linear_acceleration


@pytest.mark.parametrize(
    ("numbers", "named"),
    [({"speed": -1.0}, "linear_speed"), ({"speed": 1e3}, "linear_speed"), ({"noise": -0.1}, "noise")],
)
def test_numbers_out_of_range_are_named(numbers, named):
    with pytest.raises(InputError, match=named):
        benchmark_robot("jackal", **{"speed": 2.0, "noise": 0.0, **numbers})


def test_a_robot_without_lidar_is_refused(tmp_path):
    (tmp_path / "blind.yaml").write_text("base: jackal\nname: blind\nlidars: null\n")
    with pytest.raises(TrundleError, match="lidar"):
        benchmark_robot(str(tmp_path / "blind.yaml"), speed=2.0, noise=0.0)
