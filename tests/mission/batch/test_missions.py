"""Missions in the kernel against the same ones step by step in Python: `Session` with the kinematic simulator."""

import numpy as np
import pytest

from support.batch_missions import assert_alike, in_kernel, in_python, scenario, wall
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Scenario, sample_tight_ends
from trundle.mission.batch.missions import BatchMission, HandedOver, MissionBatch
from trundle.mission.batch.needs import needs_python
from trundle.mission.metrics import measure_truth
from trundle.path import Path
from trundle.robots import Robot
from trundle.worlds.movers.mover import PERSON_RADIUS


def test_missions_among_people_are_those_of_the_kinematic_simulator():
    """A robot without lidars sees nobody: it drives the same, until it touches someone."""
    blind = {"sees_robot": False}
    movers = [{"crowd": "person", "count": 12, **blind}, {"crowd": "forklift", "count": 1, **blind}]
    chosen = [scenario(seed=seed, movers=movers) for seed in range(5)]
    ends = MissionBatch(threads=2).drive([BatchMission(each.prepare(), measure_truth) for each in chosen])
    handed = 0
    for each, end in zip(chosen, ends, strict=True):
        driven = in_python(each)
        if isinstance(end, HandedOver):
            assert end.reason == "contact"
            assert driven.outcome is Outcome.COLLIDED
            handed += 1
        else:
            assert_alike(end, driven)
    assert 1 <= handed < 5


def test_people_who_see_the_robot_are_left_to_python():
    """The last digits of a repeated drive would make another crowd of them."""
    movers = [{"crowd": "person", "count": 2, "sees_robot": False}, {"crowd": "forklift", "count": 1}]
    assert in_kernel(scenario(movers=movers)) == HandedOver("a crowd that sees the robot")


def test_commands_are_those_of_the_navigator_in_10_000_control_periods():
    periods, seed = 0, 0
    while periods < 10_000:
        chosen = scenario(
            world={"name": ("office", "warehouse", "cylinders")[seed % 3], "seed": seed},
            robot=("nova_carter", "turtlebot3_burger", "jackal")[seed % 2],
            planner="hybrid_astar" if seed % 4 == 1 else "auto",
            seed=seed,
        )
        driven, found = in_python(chosen), in_kernel(chosen)
        seed += 1
        if isinstance(found, HandedOver):
            assert driven.behaviors or driven.outcome is not Outcome.ARRIVED
            continue
        assert_alike(found, driven)
        periods += len(driven.trajectory) - 1
    assert seed < 60


@pytest.mark.parametrize(
    "settings",
    [
        {"control_frequency": 10.0},
        {"controller": {"name": "regulated_pure_pursuit", "options": {"desired_linear_vel": 0.4}}},
        {
            "controller": {
                "name": "regulated_pure_pursuit",
                "options": {"lookahead_dist": 1.5, "footprint_padding": 0.2},
            }
        },
        {"goal_tolerance": 0.05, "goal_yaw_tolerance": 0.02},
        {"inflation_radius": 0.3, "cost_scaling_factor": 3.0},
        {"smoother": "constrained"},
        {"time_limit_s": 6.0},
        {"planner": {"name": "hybrid_astar", "options": {"in_place": False}}},
    ],
    ids=lambda settings: next(iter(settings)),
)
def test_settings_have_the_same_effect(settings):
    chosen = scenario(seed=2, **settings)
    assert_alike(in_kernel(chosen), in_python(chosen))


@pytest.fixture
def on_a_map(tmp_path):
    def make(doorway: bool, **settings) -> Scenario:
        wall(doorway).save(tmp_path / "map.yaml")
        ends = {"start": (1.0, 2.0, 0.0), "goal": (5.0, 2.0)}
        return scenario(world=None, map=str(tmp_path / "map.yaml"), **ends | settings)

    return make


def test_a_goal_without_a_yaw_is_reached_in_any(on_a_map):
    chosen = on_a_map(True)
    found = in_kernel(chosen)
    assert found.outcome is Outcome.ARRIVED
    assert_alike(found, in_python(chosen))


def test_a_mission_without_a_path_ends_as_in_python(on_a_map):
    chosen = on_a_map(False)
    found, driven = in_kernel(chosen), in_python(chosen)
    assert (found.outcome, found.message, found.complete) == (driven.outcome, driven.message, driven.complete)
    assert found.outcome is Outcome.NO_PATH
    assert np.array_equal(found.trajectory.poses, driven.trajectory.poses)
    assert not found.paths


def straight(costmap, start, goal):
    return Path(np.array([(start.x, start.y, 0.0), (goal.x, goal.y, 0.0)]))


@pytest.mark.parametrize(("gap", "outcome"), [(-0.02, Outcome.COLLIDED), (0.02, Outcome.ARRIVED)])
def test_a_mover_that_is_near_for_less_than_a_sample_of_a_recording_is_met(tmp_path, gap, outcome):
    """At 2 m/s it turns around beside the robot every 0.25 s, in the middle of each sample of 0.05 s."""
    OccupancyGrid(np.pad(np.zeros((76, 116), np.int8), 2, constant_values=100), 0.05).save(tmp_path / "map.yaml")
    near = 2.0 + 0.25 + PERSON_RADIUS + gap
    mover = {
        "path": [(3.0, near + 0.25), (3.0, near)],
        "speed": 2.0,
        "repeat": "back_and_forth",
        "body": "person",
        "name": "person",
    }
    ends = {"start": (1.0, 2.0, 0.0), "goal": (5.0, 2.0)}
    chosen = scenario(world=None, map=str(tmp_path / "map.yaml"), planner=straight, movers=[mover], **ends)
    assert in_python(chosen).outcome is outcome
    found = in_kernel(chosen)
    assert (found == HandedOver("contact")) == (outcome is Outcome.COLLIDED)


def through_the_wall(costmap, start, goal):
    return Path(np.array([(1.0, 2.0, 0.0), (5.0, 2.0, 0.0)]))


def test_a_robot_that_is_blocked_is_handed_over(on_a_map):
    assert in_kernel(on_a_map(False, planner=through_the_wall)) == HandedOver("blocked")


def test_a_mission_whose_start_is_blocked_gives_the_error_of_python(on_a_map):
    chosen = on_a_map(False, start=(3.0, 2.0, 0.0))
    with pytest.raises(Exception, match="start") as raised:
        in_python(chosen)
    assert str(in_kernel(chosen)) == str(raised.value)


def test_missions_of_one_batch_have_the_bits_of_each_alone_in_any_number_of_threads():
    settings = [scenario(seed=seed).prepare() for seed in range(6)]
    alone = [MissionBatch().drive([BatchMission(setting)])[0] for setting in settings]
    together = MissionBatch(threads=3).drive([BatchMission(setting) for setting in reversed(settings)])[::-1]
    for one, other in zip(alone, together, strict=True):
        assert one.outcome is Outcome.ARRIVED
        assert np.array_equal(one.trajectory.poses, other.trajectory.poses)
        assert one.message == other.message


@pytest.mark.parametrize("seed", range(3))
def test_drives_between_ends_without_room_for_a_turn_are_alike(seed):
    prepared = scenario(seed=seed).prepare()
    start, goal = sample_tight_ends(prepared.navigator.costmap, seed)
    chosen = scenario(seed=seed, start=start.as_tuple(), goal=goal.as_tuple())
    assert_alike(in_kernel(chosen), in_python(chosen))


def away_from_the_wall(costmap, start, goal):
    return Path(np.array([(start.x + 0.02, start.y, 0.0), (goal.x, goal.y, 0.0)]))


@pytest.mark.parametrize("gap", [0.002, 0.008])
def test_a_robot_that_stands_closer_to_a_wall_than_its_padding_drives_off_alike(on_a_map, gap):
    rear = -Robot.load("nova_carter").planar.outline[:, 0].min()
    ends = {"start": (0.1 + rear + gap, 2.0, 0.0), "goal": (2.0 + rear, 2.0)}
    chosen = on_a_map(False, planner=away_from_the_wall, **ends)
    found, driven = in_kernel(chosen), in_python(chosen)
    assert driven.outcome is Outcome.ARRIVED
    assert_alike(found, driven)


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"controller": "trundle.control:RegulatedPurePursuit"}, "controller trundle.control:RegulatedPurePursuit"),
        ({"agent": "policy.onnx"}, "agent"),
        ({"collision_monitor": True}, "collision_monitor without lidars"),
        ({"latency": {"command_delay_s": 0.1}}, "latency"),
        ({"movers": [{"crowd": "person", "count": 1}], "lidar": True}, "movers that lidars see"),
        ({"goals": [(1.0, 1.0), (2.0, 2.0)]}, "several goals"),
        ({"layers": {"obstacle": {"doubt_static": True}}}, "layers: doubt_static"),
        ({"layers": {"obstacle": {"doubt_static": True}}, "lidar": True}, "layers: doubt_static"),
        ({"replan_interval_s": 1.0}, "replan_interval_s"),
        ({"rules": {"arrival_radius": 1.0}}, "rules"),
        ({"actuation": {"wheel_radius": 1.1}}, "actuation"),
    ],
)
def test_what_needs_python_is_named(settings, named):
    assert not needs_python(scenario())
    assert any(named in need for need in needs_python(scenario(**settings)))


def raises(costmap, start, goal):
    raise RuntimeError("no idea")


def test_a_planner_that_raises_costs_only_its_own_mission():
    settings = [scenario(seed=1, **({"planner": raises} if number == 1 else {})).prepare() for number in range(3)]
    ends = MissionBatch().drive([BatchMission(setting) for setting in settings])
    assert ends[1] == HandedOver("RuntimeError while it plans")
    assert [ends[0].outcome, ends[2].outcome] == [Outcome.ARRIVED] * 2
