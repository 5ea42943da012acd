"""How unknown cells are treated, from the costmap to the drive."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle import Navigator, Robot, run, simulate
from trundle.costmap import (
    DEFAULT_UNKNOWN_COST,
    INSCRIBED,
    LETHAL,
    NO_INFORMATION,
    UNKNOWN_POLICIES,
    Costmap,
    CostmapSettings,
)
from trundle.errors import InputError, MapError, PlanningError, ScenarioError
from trundle.geometry import Pose2D
from trundle.maps import KeepoutMask
from trundle.maps.grid import OccupancyGrid
from trundle.mission import Scenario
from trundle.mission.sampling import sample_mission
from trundle.planning import PathCheck, create_planner, planner_names
from trundle.worlds import World

SMALL = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))
BURGER = Robot.load("turtlebot3_burger")


def hall(gap=30):
    """10 × 6 m, split by unknown space of 2 m; along one edge a detour that has been seen."""
    data = np.zeros((120, 200), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[gap:-1, 80:120] = -1
    return OccupancyGrid(data, 0.05)


START, GOAL = Pose2D(1.5, 4.5, 0.0), Pose2D(8.5, 4.5, 0.0)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), cost=st.integers(0, 252))
def test_free_and_costly_are_the_costs_of_a_map_where_unknown_is_free(seed, cost):
    rng = np.random.default_rng(seed)
    data = rng.choice([-1, 0, 0, 0, 50, 100], (40, 50), p=[0.2, 0.2, 0.2, 0.28, 0.1, 0.02]).astype(np.int8)
    grid, opened = OccupancyGrid(data, 0.05), OccupancyGrid(np.where(data < 0, 0, data).astype(np.int8), 0.05)
    plain = Costmap.from_grid(opened, SMALL)
    free = Costmap.from_grid(grid, SMALL, unknown="free")
    costly = Costmap.from_grid(grid, SMALL, unknown="costly", unknown_cost=cost)
    blocked = Costmap.from_grid(grid, SMALL)
    assert np.array_equal(free.data, plain.data)
    assert np.array_equal(costly.data, np.where(data < 0, np.maximum(plain.data, cost), plain.data))
    for costmap in (free, costly, blocked):
        assert np.array_equal(costmap.unknown_cells, data < 0)
    assert (blocked.data[data < 0] == NO_INFORMATION).all()


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), policy=st.sampled_from(UNKNOWN_POLICIES), masked=st.booleans())
def test_an_updated_costmap_is_that_of_the_changed_map(seed, policy, masked):
    rng = np.random.default_rng(seed)
    data = rng.choice([-1, 0, 100], (60, 70), p=[0.1, 0.88, 0.02]).astype(np.int8)
    zones = OccupancyGrid(rng.choice([0, 40, 100], (6, 7), p=[0.7, 0.2, 0.1]).astype(np.int8), 0.5)
    options = {"unknown": policy, "keepout": KeepoutMask(zones) if masked else None}
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), SMALL, **options)
    for _ in range(4):
        row, col, high, wide = (int(rng.integers(*ends)) for ends in ((0, 50), (0, 60), (1, 10), (1, 10)))
        values = rng.choice([-1, 0, 100], (high, wide)).astype(np.int8)
        data[row : row + high, col : col + wide] = values
        costmap = costmap.update(slice(row, row + high), slice(col, col + wide), values)
        fresh = Costmap.from_grid(OccupancyGrid(data, 0.05), SMALL, **options)
        assert np.array_equal(costmap.data, fresh.data)
        if not masked:
            assert np.array_equal(costmap.unknown_cells, fresh.unknown_cells)


@pytest.mark.parametrize("name", planner_names())
def test_every_planner_keeps_to_the_policy_and_the_checks_agree(name):
    options = {"cost_weight": 8.0} if name == "hybrid_astar" else {}
    blocked, free, costly = (Costmap.from_grid(hall(), SMALL, unknown=policy) for policy in UNKNOWN_POLICIES)
    paths = [create_planner(name, **options).plan(costmap, START, GOAL) for costmap in (blocked, free, costly)]
    around, through, weighed = (path.length for path in paths)
    assert around > 8.0
    assert through == pytest.approx(7.0, abs=0.02)
    expected = around if name in ("auto", "least_cost", "hybrid_astar") else through
    assert weighed == pytest.approx(expected, rel=0.1)
    for costmap, path in zip((blocked, free, costly), paths, strict=True):
        if name != "manhattan_astar":  # which knows no footprint
            assert PathCheck(path).first_hit(costmap) is None
            assert math.isfinite(PathCheck(path).cost_from(costmap))
    # What leads through unknown space is blocked as soon as that blocks.
    assert PathCheck(paths[1]).first_hit(blocked) is not None


@pytest.mark.parametrize(("name", "options"), [("least_cost", {}), ("hybrid_astar", {"cost_weight": 8.0})])
def test_what_unknown_cells_cost_decides_whether_to_go_round_them(name, options):
    through = []
    for cost in (0, 20, DEFAULT_UNKNOWN_COST, 252):
        costmap = Costmap.from_grid(hall(), SMALL, unknown="costly", unknown_cost=cost)
        path = create_planner(name, **options).plan(costmap, START, GOAL)
        through.append(bool(costmap.unknown_cells[costmap.world_to_cell(path.poses[:, 0], path.poses[:, 1])].any()))
    assert through == [True, True, False, False]


def test_with_no_other_path_costly_unknown_space_is_driven_through():
    grid = hall(gap=1)
    with pytest.raises(PlanningError, match="unknown space"):
        Navigator(grid, BURGER).planner.plan(Costmap.from_grid(grid, BURGER), START, GOAL)
    navigator = Navigator(grid, BURGER, costmap=CostmapSettings(unknown="costly"))
    with simulate(World.from_map(grid, unknown="free"), BURGER, backend="kinematic") as sim:
        episode = run(sim, navigator, start=START, goal=GOAL)
    assert episode.arrived


def test_a_scenario_drives_through_unknown_space_where_it_is_allowed_to(tmp_path):
    hall(gap=1).save(tmp_path / "hall.yaml")
    settings_ = {"map": str(tmp_path / "hall.yaml"), "robot": "turtlebot3_burger", "backend": "kinematic"}
    ends = {"start": START.as_tuple(), "goal": GOAL.as_tuple()}
    scenario = Scenario.make(**settings_, **ends, unknown="costly", unknown_cost=100)
    scenario.save(tmp_path / "mission.yaml")
    assert Scenario.load(tmp_path / "mission.yaml") == scenario.model_copy(update={"map": str(tmp_path / "hall.yaml")})
    with scenario.build() as mission:
        assert mission.navigator.costmap.unknown == "costly"
        assert mission.run().arrived
    # Nobody said otherwise: what is unknown is solid for a robot that stays out of it, and free for one that goes in.
    solids = [
        len(Scenario.make(**settings_, **ends, unknown=policy).prepare().world.solids) for policy in UNKNOWN_POLICIES
    ]
    assert solids[0] > solids[1] == solids[2]
    with pytest.raises(ScenarioError, match="unknown"):
        Scenario.make(**settings_, unknown="open")


def test_starts_and_goals_are_picked_where_the_map_is_known():
    costmap = Costmap.from_grid(hall(), SMALL, unknown="free")
    for seed in range(20):
        for pose in sample_mission(costmap, seed):
            assert not costmap.unknown_cells[costmap.world_to_cell(pose.x, pose.y)]


def test_outside_the_map_stays_blocked():
    costmap = Costmap.from_grid(OccupancyGrid(np.full((20, 20), -1, np.int8), 0.05), SMALL, unknown="free")
    assert (costmap.data < INSCRIBED).all()
    assert costmap.footprint_collides([(0.05, 0.5, 0.0), (0.5, 0.5, 0.0)]).tolist() == [True, False]


@pytest.mark.parametrize(
    "options",
    [
        {"unknown": "open"},
        {"unknown": None},
        {"unknown_cost": 253},
        {"unknown_cost": -1},
        {"unknown_cost": 0.5},
        {"unknown_cost": True},
    ],
    ids=str,
)
def test_other_policies_and_costs_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        Costmap.from_grid(hall(), SMALL, **{"unknown": "costly", **options})


@pytest.mark.parametrize("unknown", ["blocked", "free"])
def test_a_price_of_unknown_cells_is_for_those_that_have_one(unknown):
    with pytest.raises(InputError, match='unknown_cost is what unknown cells cost where unknown="costly"'):
        Navigator(hall(), BURGER, costmap=CostmapSettings(unknown=unknown, unknown_cost=120))


def test_unseen_cells_belong_to_the_policy():
    data, unseen = np.zeros((4, 4), np.uint8), np.zeros((4, 4), bool)
    with pytest.raises(MapError, match="unseen"):
        Costmap(data, 0.05, Pose2D(0, 0), SMALL, 0.3, unseen=unseen)
    with pytest.raises(MapError, match="unseen tells which"):
        Costmap(data, 0.05, Pose2D(0, 0), SMALL, 0.3, unknown="free")
    with pytest.raises(MapError, match=r"bool of shape \(4, 4\), got bool \(4, 3\)"):
        Costmap(data, 0.05, Pose2D(0, 0), SMALL, 0.3, unknown="free", unseen=unseen[:, 1:])
    costmap = Costmap(data, 0.05, Pose2D(0, 0), SMALL, 0.3, unknown="free", unseen=unseen)
    unseen[0] = True
    assert not costmap.unknown_cells.any()
    assert LETHAL not in costmap.data
    with pytest.raises(InputError, match="made already"):
        Navigator(costmap, BURGER, costmap=CostmapSettings(unknown="free"))
