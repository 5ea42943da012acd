"""Planners, controllers, agents and localizers of a user, given in every way and place."""

import json

import pytest

import trundle
from support.plugins.given_plugins import (
    CARTER,
    GOAL,
    HERE,
    NAMES,
    START,
    AimAgent,
    AimController,
    PointsPlanner,
    aim_agent,
    every_way,
    label,
    plan_points,
    room,
    ways,
)
from trundle.cli.entry import run_command
from trundle.errors import InputError, ScenarioError
from trundle.evaluation import Suite
from trundle.mission import Scenario
from trundle.navigation import Navigator
from trundle.planning import plan_many
from trundle.sim import simulate
from trundle.testing import ConformanceError, check_agent, check_controller, check_localizer, check_planner
from trundle.worlds import World

# Every way in every place ---------------------------------------------------------------------------------------------


@every_way
def test_a_run_takes_it(kind, given):
    world = World("floor", ())
    choices = {"planner": "auto", "controller": "regulated_pure_pursuit"}
    agent = given
    if kind != "agent":
        parts = {name: given if name == kind else choices[name] for name in choices}
        agent = Navigator(room(), CARTER, **parts)
    localizer = given if kind == "localizer" else None
    with simulate(world, CARTER, backend="kinematic") as sim:
        for _ in range(2):  # the second run begins like the first
            episode = trundle.run(sim, agent, START, GOAL, localizer=localizer, time_limit_s=60.0)
            assert episode.arrived, episode.message


def fast_scenario(kind, given, **more):
    return Scenario.make(
        world={"name": "office", "seed": 3}, backend="kinematic", seed=1, time_limit_s=1.0, **{kind: given}, **more
    )


@every_way
def test_a_scenario_takes_it(kind, given):
    with fast_scenario(kind, given).build() as mission:
        episode = mission.run()
    assert episode.outcome.value in ("timed_out", "collided"), episode.message
    assert episode.trajectory.time[-1] > 0.5
    if kind == "planner" and "PointsPlanner" in label(given):
        made = mission.navigator.planner.planner
        assert made.map is mission.grid or not isinstance(given, str | type)


@every_way
def test_its_check_takes_it(kind, given):
    check = {
        "planner": check_planner,
        "controller": check_controller,
        "agent": check_agent,
        "localizer": check_localizer,
    }[kind]
    if "believe_odometry" in label(given):
        with pytest.raises(ConformanceError, match="must stay near the truth"):  # where odometry begins anywhere
            check(given)
    else:
        check(given)


SUITE_FIELD = {"planner": "planners", "controller": "controllers", "agent": "agents", "localizer": "localizer"}


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(NAMES))
def test_an_evaluation_takes_all_ways_side_by_side(kind, tmp_path):
    cls, function, instance, *_ = ways()[kind]
    given = [cls, function]
    if kind != "localizer":
        given += [{"name": instance, "label": "object"}]
        given += [{"name": f"{HERE}:{name}", "label": f"file {name}"} for name in NAMES[kind]]
    field = SUITE_FIELD[kind]
    suite = Suite.make(
        worlds={"name": "office", "seed": 3},
        backends="kinematic",
        missions={"listed": [{"start": [2.0, 2.0, 0.0], "goal": [2.5, 2.0]}], "seeds": 2},
        limits={"time_limit_s": 1.0},
        **{field: given},
    )
    evaluation = trundle.evaluate(suite, workers=1, out=tmp_path / "out")
    rows = list(evaluation.rows())
    assert len(rows) == len(suite) == 2 * len(given)
    assert not [row.error for row in rows if row.outcome == "error"]
    if kind == "agent":
        assert {row.planner for row in rows} == {"none"}


def test_agents_stand_beside_the_planners_and_controllers_that_are_given_too():
    suite = Suite.make(
        worlds="office", planners=["astar", "auto"], controllers="lookahead", agents=[AimAgent, aim_agent], seeds=1
    )
    suite.check()
    groups = [(suite.spec(k).planner, suite.spec(k).controller) for k in range(len(suite))]
    assert groups == [("astar", "lookahead"), ("auto", "lookahead"), ("none", "AimAgent"), ("none", "aim_agent")]
    assert len({suite.id_of(k) for k in range(len(suite))}) == 4


def test_options_of_a_class_in_an_evaluation_are_given_with_it():
    slow = {"name": AimController, "options": {"gain": 1.0}, "label": "slow"}
    suite = Suite.make(worlds="office", controllers=[AimController, slow], seeds=1)
    suite.check()
    assert [suite.spec(k).controller for k in range(2)] == ["AimController", "slow"]
    assert suite.id_of(0) != suite.id_of(1)


def test_many_queries_take_a_class_and_a_function():
    from trundle.costmap import Costmap

    costmap = Costmap.from_grid(room(), CARTER)
    for given in (plan_points, lambda: PointsPlanner(CARTER, None)):
        (path,) = plan_many(given, costmap, [START], [GOAL])
        assert (path.start, path.goal) == (START, GOAL)


COMMANDS = [(kind, names[0]) for kind, names in NAMES.items()]


@pytest.mark.parametrize(("kind", "name"), COMMANDS)
def test_the_command_line_takes_a_file(kind, name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(HERE.read_text())
    command = ["run", "office", "--seed", "3", "--backend", "kinematic", "--time-limit", "1", "--no-video"]
    code = run_command([*command, "--no-report", f"--{kind}", f"mine.py:{name}", "--json", "--quiet", "-o", "out"])
    assert code in (0, 1)
    assert json.loads(capsys.readouterr().out)["outcome"] in ("timed_out", "collided", "arrived")
    assert f"{kind}: mine.py:{name}" in (tmp_path / "out" / "scenario.yaml").read_text()


def test_options_reach_a_class_from_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(HERE.read_text())
    command = ["run", "office", "--backend", "kinematic", "--no-video", "--agent", "mine.py:AimAgent"]
    assert run_command([*command, "--agent-option", "speed=1"]) == 2
    assert "agent 'mine.py:AimAgent' has no option 'speed'; it has: gain" in capsys.readouterr().err


# Files ----------------------------------------------------------------------------------------------------------------


def test_a_file_of_somebody_runs_no_python_beside_it(tmp_path):
    (tmp_path / "mine.py").write_text("raise SystemExit('it was run')\n")
    (tmp_path / "scenario.yaml").write_text("world: office\nplanner: mine.py:Planner\n")
    with pytest.raises(InputError, match=r"'mine.py:Planner' is a file of Python, which another file cannot name"):
        Scenario.load(tmp_path / "scenario.yaml").prepare()
    (tmp_path / "suite.yaml").write_text("worlds: office\nagents: mine.py:Agent\nlocalizer: mine.py:Localizer\n")
    with pytest.raises(InputError, match=r"'mine.py:Agent' is a file of Python, which another file cannot name"):
        Suite.load(tmp_path / "suite.yaml").check()


@pytest.mark.parametrize(
    "line",
    [
        "recovery: [mine.py:Behavior]",
        "recovery: [{replan_with: mine.py:Planner}]",
        "recovery: [replan_with=mine.py:Planner]",
        "recovery: [{replan_with: {planner: mine.py:Planner}}]",
        "backend: mine.py:Simulator",
        "backend: {name: 'subprocess:call', options: {args: [touch, called]}}",
        "world: mine.py:World",
        "controller: {name: mine.py:Controller, options: {gain: 1}}",
        "localizer: mine.py:Localizer",
        "smoother: mine.py:Smoother",
        "agent: 'python:mine.py:Agent'",
    ],
)
def test_nothing_that_a_file_names_runs_a_file_or_calls_a_function(line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("mine.py", "python:mine.py"):
        (tmp_path / name).write_text("open('called', 'w')\n")
    (tmp_path / "scenario.yaml").write_text("" if "world" in line else "world: office\n")
    with (tmp_path / "scenario.yaml").open("a") as file:
        file.write(f"{line}\n")
    with pytest.raises(InputError), Scenario.load(tmp_path / "scenario.yaml").build() as mission:
        mission.session()
    assert not (tmp_path / "called").exists()


def test_a_file_that_changes_is_another_plugin_in_an_evaluation(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ids = set()
    for text in ("def plan(costmap, start, goal): return None\n", "def plan(costmap, start, goal): return []\n"):
        (tmp_path / "mine.py").write_text(text)
        ids.add(Suite.make(worlds="office", planners="mine.py:plan", seeds=1).id_of(0))
    assert len(ids) == 2


def test_a_scenario_of_a_python_object_says_so_when_it_comes_from_its_file(tmp_path):
    fast_scenario("planner", plan_points).save(tmp_path / "scenario.yaml")
    with pytest.raises(InputError, match="planner 'plan_points' was a Python object, which a file cannot hold"):
        Scenario.load(tmp_path / "scenario.yaml").prepare()


def test_an_object_is_the_same_at_the_start_of_each_run_of_a_scenario():
    class Counting(AimController):
        calls = 0

        def compute_velocity(self, *arguments):
            self.calls += 1
            return super().compute_velocity(*arguments)

    controller = Counting(CARTER)
    for _ in range(2):
        with fast_scenario("controller", controller).build() as mission:
            mission.run()
        assert mission.navigator.controller.controller.calls > 5
    assert controller.calls == 0


def test_a_scenario_says_that_a_number_is_no_plugin():
    with pytest.raises(ScenarioError, match="controller"):
        fast_scenario("controller", 3)
