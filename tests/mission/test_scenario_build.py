"""Missions that are built of scenarios, and their runs."""

import numpy as np
import pytest

from mission.conftest import write_scenario
from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, UnknownNameError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Scenario, Trajectory, run

SMALL = {"world": {"name": "warehouse", "options": {"size": [14, 11]}}, "seed": 5}


@pytest.fixture(scope="module")
def room_yaml(room, tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "room.yaml"
    room.save(path)
    return path


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_the_same_scenario_gives_the_same_run_bit_for_bit(backend):
    runs = []
    for _ in range(2):
        with Scenario.make(**SMALL, backend=backend).build() as mission:
            runs.append(mission.run())
    assert runs[0].outcome is Outcome.ARRIVED
    for name in Trajectory.columns():
        assert getattr(runs[0].trajectory, name).tobytes() == getattr(runs[1].trajectory, name).tobytes()


def test_a_second_run_of_one_mission_repeats_the_first():
    with Scenario.make(**SMALL, backend="mujoco").build() as mission:
        first, second = mission.run(), mission.run()
    for name in Trajectory.columns():
        assert getattr(first.trajectory, name).tobytes() == getattr(second.trajectory, name).tobytes()


def test_a_map_is_extruded_and_driven_in(room_yaml):
    scenario = Scenario.make(map=str(room_yaml), start=(1.5, 1.5, 0.0), goal=(6.5, 1.5), backend="mujoco")
    with scenario.build() as mission:
        assert mission.world.solids
        assert mission.scenario == scenario
        assert mission.run().outcome is Outcome.ARRIVED


def test_what_is_picked_stands_in_the_exact_scenario():
    with Scenario.make(**SMALL, backend="kinematic").build() as mission:
        assert mission.scenario.start == mission.start.as_tuple()
        assert mission.scenario.goal == mission.goals[0]
    with Scenario.make(**SMALL, backend="kinematic", goals=[mission.goals[0], mission.goals[0][:2]]).build() as again:
        assert again.goals == (mission.goals[0], mission.goals[0][:2])
        assert again.scenario.goals == again.goals
        assert again.scenario.start is not None


def test_the_worlds_own_seed_comes_before_the_scenarios():
    def layout(seed, world_seed=None):
        world = {"name": "warehouse", "options": {"size": [14, 11]}, "seed": world_seed}
        with Scenario.make(world=world, seed=seed, backend="kinematic").build() as mission:
            return mission.world

    assert layout(5) != layout(6)
    assert layout(5, world_seed=1) == layout(6, world_seed=1)


def test_options_reach_planner_controller_backend_and_costmap(room_yaml):
    common = {"map": str(room_yaml), "backend": "kinematic"}
    with Scenario.make(
        **common, inflation_radius=1.5, cost_scaling_factor=4.0, control_frequency=10.0
    ).build() as built:
        assert built.navigator.costmap.inflation_radius == 1.5
        assert built.navigator.costmap.cost_scaling_factor == 4.0
        assert built.navigator.dt == 0.1
    common["smoother"] = "constrained"
    for choice in ("planner", "controller", "smoother", "backend"):
        bad = {"name": getattr(Scenario.make(**common), choice).name, "options": {"no_such_option": 1}}
        with pytest.raises(InputError, match="no_such_option"):
            Scenario.make(**{**common, choice: bad}).build()


@pytest.mark.parametrize("key", ["robot", "planner", "controller", "backend", "world"])
def test_an_unknown_name_offers_the_nearest(key):
    near = {
        "robot": "nova_cartr",
        "planner": "least_costs",
        "controller": "regulated_pure_persuit",
        "backend": "mujocco",
        "world": "warehose",
    }
    with pytest.raises(UnknownNameError, match="Did you mean"):
        Scenario.make(**{**SMALL, "backend": "kinematic", key: near[key]}).build()


def test_a_start_inside_a_rack_is_bad_input():
    with Scenario.make(**SMALL, backend="kinematic").build() as mission:
        low, high = next(solid for solid in mission.world.solids if solid.name.startswith("rack")).bounds()
        start = ((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, 0.0)
        with pytest.raises(BlockedPoseError):
            run(mission.sim, mission.navigator, start, mission.goals)


def save_zone(path, value, x0, y0, x1, y1):
    """Write a mask of one zone [m] with cells of 0.2 m."""
    shape = round((y1 - y0) / 0.2), round((x1 - x0) / 0.2)
    OccupancyGrid(np.full(shape, value, dtype=np.int8), 0.2, Pose2D(x0, y0)).save(path, mode="raw")


def test_a_mission_stays_out_of_a_zone_and_within_the_limit_of_another(tmp_path):
    data = np.zeros((160, 240), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    OccupancyGrid(data, 0.05).save(tmp_path / "hall.yaml")
    save_zone(tmp_path / "zones.yaml", 100, 3.0, 2.0, 5.0, 6.0)
    save_zone(tmp_path / "limits.yaml", 25, 7.0, 0.0, 9.0, 8.0)
    text = (
        "map: hall.yaml\nkeepout: zones.yaml\nspeed_mask: limits.yaml\nbackend: kinematic\n"
        "start: [1.2, 4, 0]\ngoal: [10.8, 4]\n"
    )
    scenario = Scenario.load(write_scenario(tmp_path, text))
    with scenario.build() as mission:
        episode = mission.run()
        limit = 0.25 * mission.robot.limits.linear_speed
    assert episode.outcome is Outcome.ARRIVED
    poses, speeds = episode.trajectory.poses, np.abs(episode.trajectory.v)
    # The zone and nothing else, on finer cells than the navigator's, for every pose of the whole robot.
    zone = np.zeros((800, 1200), dtype=np.int8)
    zone[200:600, 300:500] = 100
    assert not Costmap.from_grid(OccupancyGrid(zone, 0.01), mission.robot, 0.0).footprint_collides(poses).any()
    inside = (poses[:, 0] >= 7.0) & (poses[:, 0] < 9.0)
    assert inside.sum() > 100
    assert speeds[inside].max() <= limit + 1e-6
    assert speeds.max() > 0.7
    scenario.save(tmp_path / "again.yaml")
    assert Scenario.load(tmp_path / "again.yaml").prepare().navigator.speed_mask is not None


def test_a_mask_that_cannot_be_used_is_named(tmp_path):
    save_zone(tmp_path / "far.yaml", 100, 500.0, 0.0, 501.0, 1.0)
    scenario = Scenario.load(write_scenario(tmp_path, "world: warehouse\nkeepout: far.yaml\n"))
    with pytest.raises(InputError, match=r"far\.yaml: the mask does not overlap the map"):
        scenario.prepare()
    with pytest.raises(InputError, match=r"none\.yaml"):
        Scenario.make(world="warehouse", speed_mask="none.yaml").prepare()


def test_the_default_time_limit_allows_for_a_speed_mask(tmp_path):
    data = np.zeros((80, 240), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    OccupancyGrid(data, 0.05).save(tmp_path / "hall.yaml")
    save_zone(tmp_path / "limits.yaml", 10, 2.0, 0.0, 11.0, 4.0)
    ends = {"start": (1.2, 2.0, 0.0), "goal": (10.8, 2.0), "backend": "kinematic"}
    scenario = Scenario.make(map=str(tmp_path / "hall.yaml"), speed_mask=str(tmp_path / "limits.yaml"), **ends)
    with scenario.build() as mission:
        episode = mission.run()
    # 8.8 m at 0.08 m/s take 110 s, which is more than 60 s and four times 12 s.
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.time_s > 109.0


def test_a_run_has_no_planning_deadline_unless_the_scenario_asks_for_one(tmp_path):
    assert Scenario.make(**SMALL).planning_deadline_s is None
    hasty = Scenario.make(**SMALL, backend="kinematic", planning_deadline_s=1e-9)
    hasty.save(tmp_path / "hasty.yaml")
    assert Scenario.load(tmp_path / "hasty.yaml").planning_deadline_s == 1e-9
    with hasty.build() as mission:
        assert mission.run().outcome is Outcome.PLANNING_TIMED_OUT
