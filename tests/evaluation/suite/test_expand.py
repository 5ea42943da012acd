import shutil

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.evaluation.suite import Suite
from trundle.geometry import Pose2D


def make(**settings):
    return Suite.make(**{"worlds": "warehouse", "backends": "kinematic"} | settings)


@pytest.fixture
def map_yaml(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    return tmp_path / "room.yaml"


def test_cases_run_fastest_then_missions_robots_and_worlds():
    suite = make(
        worlds=["warehouse", {"name": "office", "missions": [7]}],
        robots=["nova_carter", "jackal"],
        planners=["auto", "astar"],
        seeds="2:4",
        unknown=["blocked", "free"],
    )
    specs = [suite.spec(index) for index in range(len(suite))]
    names = [(spec.world, spec.robot, spec.seed, spec.planner, spec.settings) for spec in specs]
    expected = [
        (world, robot, seed, planner, f"unknown={unknown}")
        for world, seeds in (("warehouse", (2, 3)), ("office", (7,)))
        for robot in ("nova_carter", "jackal")
        for seed in seeds
        for planner in ("auto", "astar")
        for unknown in ("blocked", "free")
    ]
    assert names == expected
    assert len({spec.id for spec in specs}) == len(suite)
    assert [suite.id_of(index) for index in range(len(suite))] == [spec.id for spec in specs]


@pytest.mark.parametrize("index", [-1, 1])
def test_an_episode_that_is_not_there_is_an_error(index):
    with pytest.raises(InputError, match="there is no episode"):
        make(seeds=1).spec(index)


def test_a_suite_of_a_thousand_million_episodes_is_refused_and_not_expanded():
    suite = make(seeds="0:1000000000")
    assert suite.expansion.total == 10**9
    assert suite.spec(999_999_999).seed == 999_999_999
    with pytest.raises(InputError, match=r"the suite has 1,000,000,000 episodes .* at most 10,000,000"):
        suite.check()
    huge = make(seeds=f"0:{2**63}", planners=["auto", "astar"])
    assert f"{2**64:,}" in repr(huge)
    with pytest.raises(InputError, match="take fewer seeds"):
        huge.check()


def test_an_id_follows_content_and_not_paths_labels_or_the_rest_of_the_suite(map_yaml, tmp_path):
    (tmp_path / "copy").mkdir()
    for name in ("room.yaml", "room.png"):
        shutil.copy(tmp_path / name, tmp_path / "copy" / name)
    base = make(worlds=str(map_yaml), seeds=[4])
    same = make(
        worlds=["office", {"name": str(tmp_path / "copy" / "room.yaml"), "label": "other"}],
        planners=["astar", "auto"],
        seeds=[1, 4],
        goal_tolerance=0.25,
        limits={"wall_s": 5},
    )
    assert base.id_of(0) in {same.id_of(index) for index in range(len(same))}


@pytest.mark.parametrize(
    "change",
    [
        {"seeds": [5]},
        {"planners": "astar"},
        {"planners": {"name": "auto", "options": {"goal_tolerance": 0.5}}},
        {"controllers": "lookahead"},
        {"smoothers": "constrained"},
        {"backends": "mujoco"},
        {"robots": "jackal"},
        {"inflation_radius": 0.4},
        {"vary": {"latency_s": 0.1}},
        {"limits": {"time_limit_s": 30}},
        {"missions": {"seeds": [4], "ends": "tight"}},
        {"missions": {"seeds": [4], "min_distance": 2.0}},
        {"missions": {"seeds": [4], "listed": [{"start": [1, 1], "goal": [2, 2]}]}},
    ],
)
def test_an_id_changes_with_everything_that_decides_the_episode(map_yaml, change):
    base = make(worlds=str(map_yaml), missions={"seeds": [4]})
    other = make(worlds=str(map_yaml), **({"missions": {"seeds": [4]}} | change if "seeds" not in change else change))
    assert base.id_of(0) != other.id_of(0)


def test_an_id_changes_with_the_pixels_of_a_map(map_yaml, room):
    before = make(worlds=str(map_yaml), seeds=1).id_of(0)
    data = np.array(room.data)
    data[5, 5] = 100 - data[5, 5]
    type(room)(data, room.resolution, room.origin).save(map_yaml)
    assert make(worlds=str(map_yaml), seeds=1).id_of(0) != before


def test_worlds_follow_the_seed_unless_they_have_their_own():
    own, fixed = make(seeds=2), make(worlds={"name": "warehouse", "seed": 3}, seeds=2)
    assert own.spec(0).content != own.spec(1).content
    assert fixed.spec(0).content == fixed.spec(1).content


def test_options_of_a_world_are_drawn_by_seed():
    suite = make(worlds={"name": "warehouse", "options": {"aisle_width": {"uniform": [1.1, 1.8]}}}, seeds=20)
    widths = [suite.spec(index).scenario.world.options["aisle_width"] for index in range(20)]
    assert all(1.1 <= width <= 1.8 for width in widths)
    assert len(set(widths)) == 20
    assert widths[7] == float(np.random.default_rng(7).uniform(1.1, 1.8))


def test_labels_tell_equal_names_apart_by_their_options():
    suite = make(
        worlds=[{"name": "warehouse", "seed": 1}, {"name": "warehouse", "seed": 2}, "office"],
        planners=[
            "hybrid_astar",
            {"name": "hybrid_astar", "options": {"in_place": True}},
            {"name": "astar", "label": "a"},
        ],
        seeds=1,
    )
    assert suite.expansion.worlds == ["warehouse 1", "warehouse 2", "office"]
    assert suite.expansion.planners == ["hybrid_astar", "hybrid_astar(in_place=True)", "a"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"planners": ["auto", "auto"]}, "two planners are called 'auto'"),
        ({"planners": ["auto", {"name": "auto", "label": "again"}]}, "planner again is given twice, also as auto"),
        ({"worlds": ["warehouse", "warehouse"]}, "two worlds are called 'warehouse'"),
        ({"robots": ["jackal", "jackal"]}, "two robots are called 'jackal'"),
        ({"inflation_radius": [0.5, 0.5]}, "inflation_radius 0.5 is given twice"),
        ({"smoothers": ["constrained", "constrained"]}, "smoother constrained is given twice"),
        ({"planners": {"name": "auto", "options": {"colour": 1}}}, "planner 'auto' has no option 'colour'"),
        ({"controllers": {"name": "lookahead", "options": {"colour": 1}}}, "has no option 'colour'"),
        ({"worlds": {"name": "warehouse", "options": {"aisle": 1}}}, r"did you mean 'aisle_width'\?"),
        ({"worlds": "gone.yaml"}, "cannot read gone.yaml"),
        ({"worlds": "gone.sdf"}, "cannot read gone.sdf"),
        ({"robots": "nova_cartr"}, "Did you mean 'nova_carter'"),
        ({"vary": {"friction": 0.5}}, "friction can only be varied with the backend mujoco, not kinematic"),
        ({"worlds": ["office", {"name": "gone.usd", "options": {"trusted": True}}]}, "cannot read gone.usd"),
        ({"seeds": [2**63 + 1]}, "seeds must be below"),
        ({"backends": {"name": "kinematic", "options": {"colour": 1}}}, "backend 'kinematic' has no option 'colour'"),
        ({"require": "success[planner=astar]>=0.9"}, "unknown planner in a requirement of this suite 'astar'"),
        ({"unknown_cost": 10}, 'where unknown="costly"'),
    ],
)
def test_what_cannot_run_is_refused_before_it_starts(settings, message):
    with pytest.raises(InputError, match=message):
        make(**{"seeds": 1} | settings).check()


def test_every_backend_of_a_suite_must_simulate_what_is_varied():
    with pytest.raises(InputError, match="not kinematic"):
        make(backends=["mujoco", "kinematic"], vary={"mass": 1.1}, seeds=1).check()


def test_lidars_and_errors_of_odometry_are_crossed():
    suite = make(seeds=1, lidar=[False, True, ["front", "back"]], odometry=[None, {"scale": 0.01, "heading": 0.5}])
    specs = [suite.spec(index) for index in range(len(suite))]
    assert {spec.settings for spec in specs} == {
        f"lidar={lidar} odometry={odometry}"
        for lidar in ("False", "True", "front+back")
        for odometry in ("none", "{scale:0.01,heading:0.5}")
    }
    assert [spec.scenario.lidar for spec in specs[::2]] == [False, True, ("front", "back")]
    assert specs[1].scenario.odometry.heading == 0.5
    assert len({spec.id for spec in specs}) == 6
    assert make(seeds=1, lidar=False, odometry=None).id_of(0) == make(seeds=1).id_of(0)


def test_a_lidar_that_a_robot_of_the_suite_lacks_is_refused():
    with pytest.raises(InputError, match="unknown lidar of jackal 'back'"):
        make(seeds=1, robots=["nova_carter", "jackal"], lidar=[["front", "back"]]).check()


def test_what_the_robot_senses_and_knows_is_crossed():
    suite = make(
        seeds=1,
        lidar=True,
        known_map=[True, False],
        localizer=[None, "odometry"],
        latency=[None, {"scan_age_s": 0.1}],
        layers={"rolling_window": True},
        collision_monitor=[True, False],
    )
    suite.check()
    specs = [suite.spec(index) for index in range(len(suite))]
    assert len({spec.id for spec in specs}) == 16
    assert "known_map=False localizer=odometry latency={scan_age_s:0.1} collision_monitor=True" in {
        spec.settings for spec in specs
    }
    assert all(spec.scenario.layers.rolling_window for spec in specs)


def test_an_unknown_localizer_of_a_suite_is_refused():
    with pytest.raises(InputError, match="unknown localizer 'odometri'"):
        make(seeds=1, localizer="odometri").check()


def test_localizers_of_one_name_are_told_apart_by_their_labels_or_refused():
    first = lambda observation: observation.odometry  # noqa: E731 - both are called <lambda>
    second = lambda observation: Pose2D(1.0, 2.0)  # noqa: E731
    with pytest.raises(InputError, match="two localizers are called '<lambda>': leave one out, or give one of them a"):
        make(seeds=1, localizer=[first, second]).check()
    suite = make(seeds=1, localizer=[first, {"name": second, "label": "by odometry"}])
    suite.check()
    specs = [suite.spec(index) for index in range(2)]
    assert [spec.settings for spec in specs] == ["localizer=<lambda>", "localizer=by_odometry"]
    assert [spec.scenario.localizer.given for spec in specs] == [first, second]
    with pytest.raises(InputError, match="localizer L2 is given twice"):
        make(seeds=1, localizer=[{"name": first, "label": "L1"}, {"name": first, "label": "L2"}]).check()


def test_the_label_of_a_localizer_changes_no_id_and_stays_in_the_file(tmp_path):
    named = make(seeds=1, localizer={"name": "odometry", "label": "wheels"})
    assert named.id_of(0) == make(seeds=1, localizer="odometry").id_of(0)
    named.save(tmp_path / "suite.yaml")
    assert Suite.load(tmp_path / "suite.yaml").localizer[0].label == "wheels"
    assert "label" not in named.spec(0).scenario.plain()["localizer"]


def test_the_errors_of_a_localizers_world_are_crossed():
    suite = make(
        seeds=1,
        lidar=True,
        localizer="odometry",
        odometry=[{"slips": 6}, {"scale": 0.05, "slips": {"count": 6, "distance": 0.2}}],
        lidar_errors=[None, {"dropouts": 0.01}],
        map_errors=[None, {"missing": 0.25, "ghosts": 12}],
        start_error=[None, {"distance": 1.0, "heading": "20deg"}, "unknown"],
    )
    suite.check()
    specs = [suite.spec(index) for index in range(len(suite))]
    assert len({spec.id for spec in specs}) == len({spec.settings for spec in specs}) == 24
    assert (
        "lidar_errors={dropouts:0.01} odometry={scale:0.05,slips:{count:6,distance:0.2}} "
        "map_errors={missing:0.25,ghosts:12+12} start_error={unknown:True}"
    ) in {spec.settings for spec in specs}


def test_movers_are_crossed_as_lists():
    people = {"crowd": "person", "count": 4, "speed": 1.0}
    forklifts = {"crowd": "forklift", "count": 2}
    one = make(seeds=1, lidar=True, movers=[people, forklifts])
    assert len(one) == 1
    assert [choice.crowd for choice in one.spec(0).scenario.movers] == ["person", "forklift"]
    several = make(seeds=1, lidar=True, movers=[[], [people], [people, forklifts]])
    specs = [several.spec(index) for index in range(len(several))]
    assert [len(spec.scenario.movers) for spec in specs] == [0, 1, 2]
    assert len({spec.id for spec in specs}) == 3
    assert specs[0].settings == "movers=none"
    assert specs[2].id == one.id_of(0)
    assert make(seeds=1, movers=[]).id_of(0) == make(seeds=1).id_of(0)
    several.check()


def test_orders_of_recovery_are_crossed():
    orders = [["replan", "back_up"], ["replan", {"back_up": {"distance": 0.5}}, "spin"]]
    suite = Suite.make(worlds="warehouse", recovery=orders, missions={"seeds": 1})
    specs = [suite.spec(index) for index in range(suite.expansion.total)]
    assert [spec.settings for spec in specs] == [
        "recovery=replan+back_up",
        "recovery=replan+back_up(distance=0.5)+spin",
    ]
    assert [[step.name for step in spec.scenario.recovery] for spec in specs][1] == ["replan", "back_up", "spin"]
    assert len({spec.id for spec in specs}) == 2
