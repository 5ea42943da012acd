import pickle
from pathlib import Path

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.suite import Suite, suite_names
from trundle.evaluation.suite.suite import SuiteKeywords
from trundle.files.choice import Choice
from trundle.files.kinds import SUITE, find_kind
from trundle.planning import create_planner


def write(folder, text, name="suite.yaml"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.fixture
def map_yaml(room, tmp_path):
    (tmp_path / "maps").mkdir()
    room.save(tmp_path / "maps" / "room.yaml")
    return tmp_path / "maps" / "room.yaml"


# Reading --------------------------------------------------------------------------------------------------------------


def test_a_file_names_worlds_planners_missions_and_settings(tmp_path):
    text = """
name: nightly
worlds:
  - warehouse
  - {name: office, label: quiet office, seed: 3, options: {}}
planners: [auto, {name: hybrid_astar, options: {max_expansions: 1e3}}]
controllers: lookahead
smoothers: [null, constrained]
backends: [kinematic]
inflation_radius: [0.3, null]
goal_tolerance: 0.1
missions: {seeds: "0:500", ends: tight}
vary: {wheel_radius: {normal: [1.0, 0.01]}, latency_s: 0.1}
limits: {wall_s: 60, memory_mb: 500, time_limit_s: 90}
require: success>=0.99
"""
    suite = Suite.load(write(tmp_path, text))
    assert len(suite) == 2 * 500 * 2 * 2 * 2
    assert suite.require == ("success>=0.99",)
    first = suite.spec(0)
    assert first.scenario.goal_tolerance == 0.1
    assert first.scenario.time_limit_s == 90
    assert (first.world, first.planner, first.controller, first.backend) == (
        "warehouse",
        "auto",
        "lookahead",
        "kinematic",
    )
    assert first.settings == "smoother=none inflation_radius=0.3"
    assert suite.spec(1).settings == "smoother=none inflation_radius=none"
    last = suite.spec(len(suite) - 1)
    assert last.scenario.planner == Choice.of("hybrid_astar", max_expansions=1000.0)
    assert last.scenario.smoother.name == "constrained"
    assert (last.world, last.seed, last.missions.ends) == ("quiet office", 499, "tight")
    assert last.scenario.world.seed == 3
    assert first.scenario.world.seed is None
    assert first.scenario.latency.command_delay_s == 0.1
    assert first.scenario.actuation.wheel_radius == first.vary["wheel_radius"] != 1.0


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("planners: [auto]\n", ":1:1: worlds: is missing"),
        ("worlds: warehouse\nplaners: [auto]\n", ":2:1: planers: unknown key. Did you mean 'planners'?"),
        ("worlds: [warehouse, offfice]\n", ":1:21: worlds.1: unknown world 'offfice'. Did you mean 'office'?"),
        ("worlds: [warehouse]\nplanners:\n  - auto\n  - astarr\n", ":4:5: planners.1: unknown planner 'astarr'."),
        ("worlds: warehouse\ncontrollers: [{name: luckahead}]\n", "unknown controller 'luckahead'"),
        ("worlds: warehouse\nsmoothers: [konstrained]\n", "unknown smoother 'konstrained'. Did you mean 'constrained'"),
        ("worlds: warehouse\nbackends: mujocco\n", ":2:11: backends: unknown backend 'mujocco'."),
        ("worlds: warehouse\nplanners: []\n", ":2:11: planners: an empty list: the cross product has no episodes"),
        ("worlds: []\n", ":1:9: worlds: an empty list"),
        ("worlds: warehouse\ninflation_radius: []\n", ":2:19: inflation_radius: an empty list"),
        ("worlds: warehouse\nmissions: '7:7'\n", "no seeds: the cross product has no episodes"),
        ("worlds: warehouse\nmissions: {seeds: []}\n", ":2:19: missions.seeds: no seeds"),
        ("worlds: warehouse\nmissions: [3, 3]\n", "seed 3 is given twice"),
        ("worlds: warehouse\nmissions: a:b\n", 'a range "0:500"'),
        ("worlds: warehouse\nmissions: -3\n", "a number of seeds"),
        ("worlds: warehouse\nmissions: [{start: [0, 0]}]\n", "give either goal or goals"),
        ("worlds: warehouse\nmissions: {ends: thight}\n", "'thight' is unknown. Did you mean 'tight'?"),
        ("worlds: warehouse\nplanning_deadline_s: 2\n", ":2:22: planning_deadline_s: planning has no deadline"),
        ("worlds: warehouse\ngoal_tolerance: [0.1, -1]\n", ":2:23: goal_tolerance.1: -1 is out of range"),
        ("worlds: warehouse\ngoal_tolerance: -1\n", ":2:17: goal_tolerance: -1 is out of range"),
        ("worlds: warehouse\nunknown: [blocked, fre]\n", ":2:20: unknown.1: 'fre' is unknown"),
        ("worlds: warehouse\nvary: {frction: 1}\n", ":2:8: vary.frction: unknown key. Did you mean 'friction'?"),
        ("worlds: warehouse\nvary: {friction: {uniform: [2, 1]}}\n", "uniform: the lowest value, 2, is above"),
        ("worlds: warehouse\nvary: {mass: {normal: [1, 0.5]}}\n", "vary.mass: -1 to 3 is out of range"),
        ("worlds: warehouse\nvary: {mass: {uniform: [1, 2], normal: [1, 1]}}\n", "give either uniform"),
        ("worlds: warehouse\nlimits: {wall_s: 0}\n", ":2:18: limits.wall_s: 0 is out of range"),
        ("worlds: {name: map.yaml, seed: 1}\n", "seed is for generated worlds"),
        ("worlds: {name: hall.yaml, options: {a: {uniform: [1, 2]}}}\n", "option a is drawn"),
        ("worlds: warehouse\nplanners: [nowhere.to:Be]\n", "planner 'nowhere.to:Be' cannot be imported"),
        ("worlds: warehouse\nrequire: [sucess>=0.9]\n", ":2:11: require.0: unknown figure in a requirement 'sucess'"),
        (
            "worlds: warehouse\nplanners: {name: auto, lable: x}\n",
            ":2:24: planners.lable: unknown key. Did you mean 'label'? There are: label, name, options",
        ),
        (
            "worlds: warehouse\nplanners: [auto, {name: astar, lable: x}]\n",
            ":2:32: planners.1.lable: unknown key. Did you mean 'label'? There are: label, name, options",
        ),
        (
            "worlds: {name: warehouse, options: {aisle_width: {unifrm: [1, 2]}}}\n",
            ":1:51: worlds.options.aisle_width.unifrm: unknown key. Did you mean 'uniform'? There are: uniform, normal",
        ),
        (
            "worlds: warehouse\nvary: {start_pose: {x: {uniform: [0]}}}\n",
            ":2:34: vary.start_pose.x.uniform: has 1 items, it must have 2",
        ),
        ("worlds: warehouse\nvary: {mass: {uniform: [a, 1]}}\n", ":2:25: vary.mass.uniform.0: must be a number"),
        ("worlds: warehouse\nrequire: success=0.9\n", ":2:10: require: cannot read the requirement 'success=0.9'"),
        ("worlds: warehouse\nplanners: [os:system]\n", "planner 'os:system' is no planner"),
    ],
)
def test_every_mistake_is_reported_with_its_place(tmp_path, text, where):
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        Suite.load(path)
    assert str(caught.value).startswith(str(path))
    assert where in str(caught.value)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n", "a map"),
        ("world: warehouse\ngoal: [1, 2]\n", "a scenario"),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(tmp_path, text, kind):
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        Suite.load(path)
    assert str(caught.value) == f"{path}: this is {kind}, not a suite"


def test_an_unknown_suite_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean 'smoke'"):
        Suite.load("smok")


def test_paths_are_relative_to_the_file(map_yaml, tmp_path, monkeypatch):
    text = "worlds: [maps/room.yaml, {name: maps/room.yaml, label: masked, keepout: zones.yaml}]\nrobots: ./mine.yaml\n"
    path = write(tmp_path, text)
    monkeypatch.chdir(tmp_path.parent)
    suite = Suite.load(path)
    assert suite.worlds[0].name == str(map_yaml)
    assert suite.worlds[1].keepout == str(tmp_path / "zones.yaml")
    assert Path(suite.robots[0]) == tmp_path / "mine.yaml"


def test_a_saved_suite_comes_back_as_it_was(map_yaml, tmp_path):
    suite = Suite.make(
        maps=str(map_yaml),
        worlds=[{"name": "warehouse", "options": {"aisle_width": {"uniform": [1.1, 1.8]}, "size": [14, 11]}}],
        planners=["auto", Choice.of("hybrid_astar", in_place=True)],
        smoothers=[None, "constrained"],
        missions={"seeds": [3, 5], "min_distance": 2.0},
        vary={"friction": 0.7, "start_pose": {"yaw": {"normal": [0.0, 0.1]}}},
        unknown=["blocked", "free"],
    )
    suite.save(tmp_path / "suite.yaml")
    again = Suite.load(tmp_path / "suite.yaml")
    assert again == suite
    assert [again.id_of(i) for i in range(len(again))] == [suite.id_of(i) for i in range(len(suite))]


# Shipped suites -------------------------------------------------------------------------------------------------------


def test_shipped_suites_are_found_by_name_and_sound():
    assert suite_names() == ["smoke", "tight", "warehouses"]
    for name in suite_names():
        suite = Suite.load(name)
        assert suite.title == name
        suite.check()


# Python objects -------------------------------------------------------------------------------------------------------


def plan(costmap, start, goal):
    return [start.as_tuple(), goal.as_tuple()]


def factory(offset):
    def mine(costmap, start, goal):
        return [start.as_tuple(), (goal.x + offset, goal.y, goal.yaw)]

    return mine


class NoPlanner:
    pass


def test_a_function_is_a_planner_with_its_name():
    suite = Suite.make(worlds="warehouse", planners=["auto", plan], seeds=1)
    suite.check()
    assert suite.expansion.planners == ["auto", "plan"]
    assert pickle.loads(pickle.dumps(suite)).planners[1].given is plan


def test_functions_that_differ_in_what_they_enclose_are_not_one():
    ids = {Suite.make(worlds="warehouse", planners=factory(k), seeds=1).id_of(0) for k in (0.0, 0.0, 1.0)}
    assert len(ids) == 2


def test_of_a_saved_python_object_the_name_is_left(tmp_path):
    Suite.make(worlds="warehouse", planners=plan, seeds=1).save(tmp_path / "suite.yaml")
    suite = Suite.load(tmp_path / "suite.yaml")
    assert suite.spec(0).planner == "plan"
    with pytest.raises(InputError, match="'plan' was a Python object, which a file cannot hold"):
        suite.check()


@pytest.mark.parametrize("planner", [NoPlanner, NoPlanner(), 3])
def test_what_cannot_plan_is_refused(planner):
    with pytest.raises(InputError, match=r"planners|planner (class )?'NoPlanner' is no planner"):
        Suite.make(worlds="warehouse", planners=[planner], seeds=1).check()


def test_a_class_is_named_by_module_and_class():
    made = create_planner("astar")
    suite = Suite.make(worlds="warehouse", planners=f"{type(made).__module__}:{type(made).__name__}", seeds=1)
    suite.check()
    assert suite.spec(0).planner == "AStarPlanner"


# Made in Python -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [Suite, Suite.make])
def test_seeds_and_maps_are_fields_of_a_suite_however_it_is_made(make, map_yaml):
    suite = make(maps=map_yaml, worlds="warehouse", seeds="0:500", missions={"ends": "tight"}, lidar=[True, False])
    assert [world.name for world in suite.worlds] == ["warehouse", str(map_yaml)]
    assert (suite.missions.seeds, suite.missions.ends) == ("0:500", "tight")
    assert len(suite) == 2 * 500 * 2
    assert suite == make(
        worlds=["warehouse", str(map_yaml)], missions={"ends": "tight", "seeds": "0:500"}, lidar=[True, False]
    )
    assert len(make(maps=[map_yaml, "warehouse"], seeds=[3, 5])) == 4
    assert make(worlds="warehouse", seeds=3).spec(0).id == make(worlds="warehouse", missions=3).spec(0).id


def test_a_file_may_have_seeds_and_maps_too_and_keeps_its_places(map_yaml, tmp_path):
    file = write(tmp_path, "maps: maps/room.yaml\nseeds: '0:7'\n")
    assert find_kind(file) == SUITE
    suite = Suite.load(file)
    assert len(suite) == 7
    assert suite.worlds[0].name == str(map_yaml)
    suite.save(tmp_path / "again.yaml")
    assert Suite.load(tmp_path / "again.yaml") == suite


@pytest.mark.parametrize("make", [Suite, Suite.make])
@pytest.mark.parametrize(
    ("given", "first"),
    [
        ({"worlds": "warehouse", "planer": "auto"}, "planer: unknown key. Did you mean 'planners'? There are: name, w"),
        ({"worlds": "warehouse", "seed": 3}, "seed: unknown key. Did you mean 'seeds'? There are: name, worlds, maps"),
        ({"world": "warehouse", "seeds": 3}, "world: unknown key. Did you mean 'worlds'?"),
        ({"map": "room.yaml"}, "map: unknown key. Did you mean 'maps'?"),
        ({"worlds": "nowhere", "goal_tolerance": -1, "seed": 3}, "seed: unknown key. Did you mean 'seeds'?"),
        ({"seeds": 3}, "worlds: is missing"),
        ({"worlds": "warehouse", "seeds": "a:b"}, "seeds: must be a number of seeds"),
        ({"maps": ["room.yaml", 3]}, "maps.1: must be a mapping, got 3"),
        ({"worlds": "warehouse", "missions": 5, "seeds": 3}, "seeds: missions has seeds, too; leave one of them out"),
    ],
)
def test_the_likely_mistake_is_named_first(make, given, first):
    with pytest.raises(InputError) as refused:
        make(**given)
    assert str(refused.value).startswith(first)


def test_a_mistake_in_a_files_seeds_has_its_place(tmp_path):
    with pytest.raises(InputError, match=r"suite\.yaml:2:8: seeds: must be a number of seeds"):
        Suite.load(write(tmp_path, "worlds: warehouse\nseeds: a:b\n"))


def test_type_checkers_know_every_field_and_no_other():
    assert set(SuiteKeywords.__annotations__) == set(Suite.model_fields) - {"planning_deadline_s"}


def test_a_changed_suite_keeps_the_other_fields():
    suite = Suite.make(worlds="warehouse", seeds=3, goal_tolerance=[0.1, 0.2], require="success>=0.5")
    changed = suite.with_fields(require="success>=0.9", planners=["auto", "astar"])
    assert changed == Suite.make(
        worlds="warehouse", seeds=3, goal_tolerance=[0.1, 0.2], require="success>=0.9", planners=["auto", "astar"]
    )
