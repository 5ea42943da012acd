"""Plug-ins of a user that are wrong, that return something else, and what is made of what they return."""

import math

import numpy as np
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
    BelieveOdometry,
    PointsPlanner,
    aim_controller,
    label,
    room,
)
from trundle.control import create_controller
from trundle.errors import InputError
from trundle.fault import find_fault
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import create_localizer
from trundle.navigation import Agent, Choice, NavigationStatus, Navigator
from trundle.navigation.agents import create_agent
from trundle.observation import Estimate, Observation
from trundle.path import Path
from trundle.planning import create_planner
from trundle.sim import simulate
from trundle.testing import ConformanceError, check_agent, check_controller, check_localizer, check_planner
from trundle.worlds import World

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
        (Needy, r"{kind} class 'Needy' \(.*test_plugin_answers.py:\d+\) needs 'exponent', which nothing gives"),
        ("no_such_module_here:Mine", "there is no module 'no_such_module_here'; install its package, or give its file"),
        ("no_such_file.py:Mine", "{kind} 'no_such_file.py:Mine' cannot be imported: there is no file no_such_file.py"),
        (f"{HERE}:Nothing", "given_plugins.py has no 'Nothing'"),
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


class Worded(AimAgent):
    """Says in plain texts what it is doing."""

    driving = "driving"

    @property
    def status(self):
        return self.driving if self._status is NavigationStatus.DRIVING else self._status.value

    @status.setter
    def status(self, status):
        self._status = status


class WordedAgent(Worded, Agent):
    """The same, derived from `Agent`."""


@pytest.mark.parametrize("kind", [Worded, WordedAgent])
def test_an_agent_may_say_its_status_in_words(kind):
    with simulate(World("floor", ()), CARTER, backend="kinematic") as sim:
        episode = trundle.run(sim, kind, START, GOAL, time_limit_s=60.0)
    assert episode.outcome.value == "arrived"


@pytest.mark.parametrize("status", ["drivin", None, 3])
def test_an_agent_with_a_status_that_is_none_is_named(status):
    class Wrong(Worded):
        driving = status

    told = pytest.raises(InputError, match=rf"agent 'Wrong' has the status {status!r}: a status is .*, driving, ")
    with simulate(World("floor", ()), CARTER, backend="kinematic") as sim, told as caught:
        trundle.run(sim, Wrong, START, GOAL)
    assert (find_fault(caught.value).kind, find_fault(caught.value).function) == ("agent", "Wrong.status")


def test_an_estimate_of_another_time_is_the_localizers_fault():
    def late(observation):
        return Estimate(max(0.0, observation.time - 5.0), START)

    made = make("localizer", late)
    made.reset(START)
    made.update(Observation(0.0, Twist2D(), START))
    with pytest.raises(InputError, match=r"'late' returned an estimate of 2 s for an observation of 7 s") as caught:
        made.update(Observation(7.0, Twist2D(), START))
    assert find_fault(caught.value).kind == "localizer"
    assert make("localizer", lambda seen: Estimate(seen.time + 1e-9, START)).update(Observation(1.0, Twist2D(), START))


def test_a_function_agent_finishes_when_it_returns_none():
    def leave(observation, estimate):
        return Twist2D(0.3, 0.0) if observation.time < 1.0 else None

    with simulate(World("floor", ()), CARTER, backend="kinematic") as sim:
        episode = trundle.run(sim, leave, START, None)
    assert episode.outcome.value == "finished"
    assert episode.controller == "leave"


def test_a_pose_becomes_an_estimate_at_the_time_of_the_observation():
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
