"""Planners, controllers, agents and localizers of a user: given in every way and place, and wrong in every way."""

import functools
import json
import math
from pathlib import Path as FilePath

import numpy as np
import pytest

import trundle
from trundle.cli.entry import run_command
from trundle.control import create_controller
from trundle.errors import InputError, ScenarioError
from trundle.evaluation import Suite
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.localization import create_localizer
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.navigation import Choice, NavigationStatus, Navigator
from trundle.navigation.agents import create_agent
from trundle.observation import Estimate
from trundle.path import Path
from trundle.planning import create_planner, plan_many
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.testing import ConformanceError, check_agent, check_controller, check_localizer, check_planner
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
START, GOAL = Pose2D(2.0, 2.0, 0.0), Pose2D(5.0, 3.0, 0.5)


def room() -> OccupancyGrid:
    data = np.zeros((100, 140), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, 0.05)


# What users write -----------------------------------------------------------------------------------------------------


def plan_points(costmap, start, goal):
    """Points of a straight line, or what a planner of ours finds."""
    points = np.linspace((start.x, start.y), (goal.x, goal.y), 200)
    yaw = math.atan2(goal.y - start.y, goal.x - start.x)
    if costmap.footprint_collides(np.column_stack([points, np.full(200, yaw)])).any():
        return create_planner("least_cost").plan(costmap, start, goal)
    return points


class PointsPlanner:
    """With the robot, the map and an option, and with no keyword of the protocol."""

    def __init__(self, robot, map, count=200):
        self.robot, self.map, self.count = robot, map, count

    def plan(self, costmap, start, goal):
        return plan_points(costmap, start, goal)


def aim(pose, path, robot, gain):
    """Turn to the end of the path, and drive there."""
    limits, goal = robot.limits, path.goal
    distance = math.hypot(goal.x - pose.x, goal.y - pose.y)
    if distance < 0.1:
        error = wrap_angle(goal.yaw - pose.yaw)
        return Twist2D(0.0, max(-0.5, min(0.5, gain * error)) if abs(error) > 0.02 else 0.0)
    error = wrap_angle(math.atan2(goal.y - pose.y, goal.x - pose.x) - pose.yaw)
    v = min(0.5 * limits.linear_speed, distance) if abs(error) < 0.1 else 0.0
    return Twist2D(v, max(-0.5, min(0.5, gain * error)))


def aim_controller(pose, twist, costmap, dt, path, *, robot, gain=2.0):
    return aim(pose, path, robot, gain)


class AimController:
    """With the methods alone that it must have."""

    def __init__(self, robot, gain=2.0):
        self.robot, self.gain, self.path = robot, gain, None

    def set_path(self, path):
        self.path = path

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D() if self.path is None else aim(pose, self.path, self.robot, self.gain)


def aim_agent(observation, estimate, goal, *, robot, gain=2.0):
    return aim(estimate.pose, Path(np.array([goal.pose.as_tuple()])), robot, gain)


class AimAgent:
    def __init__(self, robot, gain=2.0):
        self.robot, self.gain, self.status, self.goal = robot, gain, NavigationStatus.IDLE, None

    def reset(self, *, seed=0):
        self.goal, self.status = None, NavigationStatus.IDLE

    def set_goal(self, goal):
        self.goal, self.status = goal, NavigationStatus.DRIVING

    def update(self, observation, estimate):
        command = aim_agent(observation, estimate, self.goal, robot=self.robot, gain=self.gain)
        if estimate.pose.distance_to(self.goal.pose) < 0.1 and command == Twist2D():
            self.status = NavigationStatus.ARRIVED
        return command


def believe_odometry(observation):
    """In a simulation the odometry begins at the start pose."""
    return observation.odometry


class BelieveOdometry:
    def __init__(self, map, robot, shift=0.0):
        self.map, self.shift = map, shift

    def reset(self, pose):
        self.start, self.first = pose, None

    def update(self, observation):
        self.first = self.first or self.start @ observation.odometry.inverse()
        return self.first @ observation.odometry


def ways():
    """Every way to give each kind, with objects of their own for each test."""
    return {
        "planner": [PointsPlanner, plan_points, PointsPlanner(CARTER, None), lambda: PointsPlanner(CARTER, None)],
        "controller": [AimController, aim_controller, AimController(CARTER), lambda robot: AimController(robot)],
        "agent": [AimAgent, aim_agent, AimAgent(CARTER), lambda robot: AimAgent(robot)],
        "localizer": [BelieveOdometry, believe_odometry, BelieveOdometry(None, CARTER)],
    }


NAMES = {
    "planner": ["PointsPlanner", "plan_points"],
    "controller": ["AimController", "aim_controller"],
    "agent": ["AimAgent", "aim_agent"],
    "localizer": ["BelieveOdometry", "believe_odometry"],
}
HERE = FilePath(__file__)


def label(value):
    text = value if isinstance(value, str) else getattr(value, "__name__", f"a {type(value).__name__}")
    return text.rpartition("/")[2]


def every_way(test):
    given = [(kind, way) for kind, several in ways().items() for way in several]
    given += [(kind, f"{place}:{name}") for kind in NAMES for name in NAMES[kind] for place in (__name__, HERE)]
    return pytest.mark.parametrize(("kind", "given"), given, ids=label)(test)


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


# Wrong in every way ---------------------------------------------------------------------------------------------------


def make(kind, given, **options):
    return {
        "planner": lambda: create_planner(given, CARTER, room(), **options),
        "controller": lambda: create_controller(given, CARTER, room(), **options),
        "agent": lambda: create_agent(given, CARTER, room(), **options),
        "localizer": lambda: create_localizer(given, room(), CARTER, **options),
    }[kind]()


class Empty:
    pass


class Needy(PointsPlanner, AimController, AimAgent, BelieveOdometry):
    def __init__(self, robot, exponent):
        pass


METHOD = {"planner": r"plan\(", "controller": r"set_path\(", "agent": r"reset\(", "localizer": r"reset\("}


@pytest.mark.parametrize("kind", list(NAMES))
@pytest.mark.parametrize(
    ("given", "message"),
    [
        (3, "{kind} 3 is no {kind}. An? {kind} is a name, an object with {method}"),
        (None, "{kind} None is no {kind}"),
        (Empty, r"{kind} class 'Empty' is no {kind} \('Empty' was made\). An? {kind} is a name, an object with"),
        (Empty(), "{kind} 'Empty' is no {kind}. An? {kind} is a name, an object with {method}"),
        (lambda: None, "is no {kind}"),
        (Needy, r"{kind} class 'Needy' \(.*test_plugins.py:\d+\) needs 'exponent', which nothing gives"),
        ("no_such_module_here:Mine", "there is no module 'no_such_module_here'; install its package, or give its file"),
        ("no_such_file.py:Mine", "{kind} 'no_such_file.py:Mine' cannot be imported: there is no file no_such_file.py"),
        (f"{HERE}:Nothing", "test_plugins.py has no 'Nothing'"),
        ("os:getcwd", "{kind} 'os:getcwd' is no {kind}"),
        ("no_such_name", "unknown {kind} 'no_such_name'"),
    ],
    ids=label,
)
def test_what_is_none_is_refused_in_one_line(kind, given, message):
    with pytest.raises(InputError, match=message.format(kind=kind, method=METHOD[kind])) as raised:
        make(kind, given)
    assert "\n" not in str(raised.value)


class HalfController:
    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D()


def test_the_method_that_is_missing_is_named():
    with pytest.raises(InputError, match=r"controller class 'HalfController' has no set_path\(path\)"):
        make("controller", HalfController)


@pytest.mark.parametrize("answer", [None, "path", 3.0, [], [[1.0]], [[1.0, math.nan]], np.zeros((2, 4)), {"a": 1}])
def test_a_planner_that_returns_something_else_is_named(answer):
    def mine(costmap, start, goal):
        return answer

    planner = make("planner", mine)
    with pytest.raises(InputError, match=r"planner 'mine' returned .*: a planner returns a Path, or finite poses"):
        planner.plan(None, START, GOAL)
    with pytest.raises(ConformanceError, match=r"planner 'mine' returned"):
        check_planner(mine)


@pytest.mark.parametrize("answer", [None, (0.1, 0.0), 0.1])
def test_a_controller_an_agent_and_a_localizer_that_return_something_else_are_named(answer):
    class Mine(AimController):
        def compute_velocity(self, pose, twist, costmap, dt):
            return answer

    with pytest.raises(InputError, match=r"controller 'Mine' returned .*: compute_velocity returns a Twist2D"):
        make("controller", Mine).compute_velocity(START, Twist2D(), None, 0.05)
    with pytest.raises(ConformanceError, match="controller 'Mine' returned"):
        check_controller(Mine)

    def locate(observation):
        return answer

    with pytest.raises(ConformanceError, match=r"localizer 'locate' returned .*: a localizer returns an Estimate"):
        check_localizer(locate)
    if answer is not None:  # which says that the agent has finished

        def drive(observation, estimate):
            return answer

        with pytest.raises(ConformanceError, match=r"agent 'drive' returned .*: an agent returns a Twist2D"):
            check_agent(drive)


# What is made of them -------------------------------------------------------------------------------------------------


def test_points_become_a_path_that_turns_in_place_at_its_corners_and_ends():
    planner = make("planner", lambda costmap, start, goal: [(2.0, 2.0), (2.0, 3.0), (5.0, 3.0)])
    path = planner.plan(None, START, GOAL)
    up = math.pi / 2
    expected = [(2, 2, 0), (2, 2, up), (2, 3, up), (2, 3, 0), (5, 3, 0), (5, 3, 0.5)]
    assert path.poses == pytest.approx(np.array(expected, dtype=float))
    free = planner.plan(None, START, (GOAL.x, GOAL.y))
    assert free.poses == pytest.approx(np.array(expected[:-1], dtype=float))


def test_points_that_end_elsewhere_are_not_stretched_to_the_goal():
    planner = make("planner", lambda costmap, start, goal: [(2.0, 2.0), (4.0, 2.0)])
    assert planner.plan(None, START, GOAL).goal == Pose2D(4.0, 2.0, 0.0)


def test_a_single_point_is_a_path():
    assert make("planner", lambda costmap, start, goal: [(2.0, 2.0)]).plan(None, START, START).poses.shape == (1, 3)


def test_a_function_takes_the_keywords_of_a_call_that_it_names():
    given = {}

    def mine(costmap, start, goal, *, cancel, deadline_s=None):
        given.update(cancel=cancel, deadline_s=deadline_s)
        return [start.as_tuple(), goal.as_tuple()]

    make("planner", mine).plan(None, START, GOAL, deadline_s=3.0)
    assert given == {"cancel": None, "deadline_s": 3.0}


def test_a_wrapped_controller_keeps_what_else_it_has():
    class Telling(AimController):
        reason = "waits"
        tracks = ()

        def set_tracks(self, tracks):
            self.tracks = tracks

        def reset(self):
            self.path = None

    made = make("controller", Telling)
    made.set_tracks((1,))
    made.reset(seed=3)
    assert (made.reason, made.tracks, made.controller.tracks) == ("waits", (1,), (1,))
    assert (made.intent, made.rollouts()) == (None, None)
    with pytest.raises(AttributeError):
        made.marks  # noqa: B018 - that there is none is what is tested


def test_a_function_controller_stands_without_a_path_and_forgets_it_at_a_reset():
    made = make("controller", aim_controller)
    assert made.compute_velocity(START, Twist2D(), None, 0.05) == Twist2D()
    made.set_path(Path(np.array([START.as_tuple(), (4.0, 2.0, 0.0)])))
    assert made.compute_velocity(START, Twist2D(), None, 0.05).v > 0.0
    made.reset(seed=1)
    assert made.compute_velocity(START, Twist2D(), None, 0.05) == Twist2D()


def test_an_agent_of_a_class_that_returns_something_else_is_named():
    class Pair(AimAgent):
        def update(self, observation, estimate):
            return (0.1, 0.0)

    told = pytest.raises(InputError, match=r"agent 'Pair' returned \(0.1, 0.0\): an agent returns a Twist2D")
    with simulate(World("floor", ()), CARTER, backend="kinematic") as sim, told:
        trundle.run(sim, Pair, START, GOAL)


def test_a_function_agent_finishes_when_it_returns_none():
    def leave(observation, estimate):
        return Twist2D(0.3, 0.0) if observation.time < 1.0 else None

    with simulate(World("floor", ()), CARTER, backend="kinematic") as sim:
        episode = trundle.run(sim, leave, START, None)
    assert episode.outcome.value == "finished"
    assert episode.controller == "leave"


def test_a_pose_becomes_an_estimate_at_the_time_of_the_observation():
    from trundle.observation import Observation

    made = make("localizer", lambda observation: Pose2D(1.0, 2.0, 0.0))
    made.reset(START)
    found = made.update(Observation(0.5, Twist2D(), Pose2D(7.0, 7.0, 1.0)))
    assert isinstance(found, Estimate)
    assert (found.time, found.pose) == (0.5, Pose2D(1.0, 2.0, 0.0))
    assert found.odom_pose.distance_to(Pose2D(7.0, 7.0)) < 1e-9
    with pytest.raises(InputError, match="times must increase"):
        made.update(Observation(0.5, Twist2D(), Pose2D(7.0, 7.0, 1.0)))


def test_a_choice_with_options_makes_a_class():
    choice = Choice.of_object(PointsPlanner, options={"count": 5})
    planner = Navigator(room(), CARTER, planner=choice).planner.planner
    assert (planner.count, planner.robot) == (5, CARTER)
    assert planner.map is not None


def test_a_scenario_says_that_a_number_is_no_plugin():
    with pytest.raises(ScenarioError, match="controller"):
        fast_scenario("controller", 3)


# Planners of earlier versions -----------------------------------------------------------------------------------------


class Older:
    def plan(self, costmap, start, goal, *, goal_yaw_free=False, deadline_s=None, cancel=None):
        return [start.as_tuple(), goal.as_tuple()]


class OlderByPlace:
    def plan(self, costmap, start, goal, goal_yaw_free):
        return [start.as_tuple(), goal.as_tuple()]


class Decorated:
    @functools.wraps(Older.plan)
    def plan(self, *arguments, **keywords):
        return Older.plan(self, *arguments, **keywords)


def older(costmap, start, goal, *, goal_yaw_free=False):
    return [start.as_tuple(), goal.as_tuple()]


def older_by_place(costmap, start, goal, goal_yaw_free):
    return [start.as_tuple(), goal.as_tuple()]


FORMER = r"test_plugins\.py:\d+\) takes 'goal_yaw_free'.*plan\(costmap, start, goal, \*, deadline_s=None, cancel=None\)"


@pytest.mark.parametrize(
    "planner",
    [
        Older,
        Older(),
        lambda: Older(),
        OlderByPlace,
        Decorated,
        older,
        older_by_place,
        f"{__name__}:Older",
        f"{__file__}:older",
    ],
)
def test_a_planner_that_takes_the_former_keyword_is_refused_with_the_new_signature(planner):
    with pytest.raises(InputError, match=FORMER):
        create_planner(planner)
    with pytest.raises(InputError, match=FORMER):
        Navigator(None, "jackal", planner=planner)
    with pytest.raises(ConformanceError, match=FORMER):
        check_planner(planner)


def test_a_planner_that_hands_on_whatever_it_gets_is_not_taken_for_an_older_one():
    def mine(costmap, start, goal, **keywords):
        return create_planner("least_cost").plan(costmap, start, goal, **keywords)

    check_planner(mine)


def test_an_evaluation_refuses_an_older_planner_before_it_begins(tmp_path):
    with pytest.raises(InputError, match=FORMER):
        trundle.evaluate({"worlds": "warehouse", "planners": Older, "seeds": 1}, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
