"""Plug-ins that raise: the run ends properly, with a folder, and the exception is raised afterwards."""

import ast
import inspect
import operator
import pickle
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import trundle
from support.observers import Recorder
from support.raising_plugins import GOAL, Agent, Boom, Raising
from trundle.errors import InputError, NoPathError, SimulationError
from trundle.fault import LIBRARIES, find_fault, folder_of
from trundle.mission import Episode, Outcome, Session, run
from trundle.navigation.behaviors import Behavior
from trundle.observation import Estimate
from trundle.planning import create_planner
from trundle.record.run_folder import RunFolder
from trundle.sim.kinematic import KinematicSimulator

RAISED_IN = inspect.getfile(Raising)


class Planner:
    """Plans as `auto` does; raises at its call number `at`."""

    def __init__(self, at=1, error=None):
        self.at, self.error, self.calls, self.inner = at, error or Boom("no idea"), 0, create_planner("auto")

    def plan(self, costmap, start, goal, **options):
        self.calls += 1
        if self.calls >= self.at:
            raise self.error
        return self.inner.plan(costmap, start, goal, **options)


class Controller(Raising):
    """Drives straight on; raises where it is told."""

    def __init__(self, where="compute_velocity", *given, **options):
        super().__init__(where, *given, **options)

    def reset(self, *, seed=0):
        self._call("reset")

    def set_path(self, path):
        self._call("set_path")

    def set_speed_limit(self, limit):
        self._call("set_speed_limit")

    def compute_velocity(self, pose, twist, costmap, dt):
        self._call("compute_velocity")
        return self.returns


class Localizer(Raising):
    def __init__(self, where="update", *given):
        super().__init__(where, *given)

    def reset(self, pose, *, seed=0):
        self._call("reset")
        self.begin = pose

    def update(self, observation):
        self._call("update")
        return Estimate(observation.time, self.begin @ observation.odometry)


class Monitor:
    def __init__(self, where):
        self.where = where

    def reset(self):
        if self.where == "reset":
            raise Boom("no idea")

    def check(self, *_):
        raise Boom("no idea")


class Simulator(KinematicSimulator):
    """A simulator of others, derived from one of trundle."""

    def __init__(self, world, robot, where, error=None):
        self.where, self.error, self.calls = "", error or Boom("no idea"), 0
        super().__init__(world, robot)
        self.where = where

    def reset(self, pose, *, seed=0):
        if self.where == "reset":
            raise self.error
        return super().reset(pose, seed=seed)

    def step(self, command, dt):
        self.calls += 1
        if self.where == "step" and self.calls > 3:
            raise self.error
        return super().step(command, dt)


class Fails(Behavior):
    def update(self, context):
        raise Boom("no idea")


class Smoother:
    def smooth(self, path, costmap):
        raise Boom("no idea")


@pytest.fixture
def drive(make_sim, navigator, start, tmp_path):
    """Run it with a folder and an observer; return the exception, the episode and the observer."""

    def drive(agent=navigator, *, sim=None, goal=GOAL, error=Boom, **options):
        watcher = Recorder()
        with RunFolder(tmp_path / "run", video=False, overwrite=True) as folder, pytest.raises(error) as caught:
            run(sim or make_sim(), agent, start, goal, observers=[watcher, folder], **options)
        return caught.value, Episode.load(tmp_path / "run"), watcher

    return drive


def check_ended(found, kind, plugin, file=__file__):
    """The run ended as it should: the folder and the observer have the fault, the exception has the folder."""
    error, episode, watcher = found
    assert episode.outcome is watcher.episode.outcome is Outcome.ERROR
    assert episode.fault == watcher.episode.fault == find_fault(error)
    assert (episode.fault.kind, episode.fault.plugin, episode.fault.file) == (kind, plugin, file)
    assert f"{file}:{episode.fault.line}" in episode.message
    assert "Traceback" in episode.fault.traceback
    assert folder_of(error) == str(episode.folder)
    assert not episode.observer_errors


# Where a plug-in raises -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("at", [1, 2])
def test_a_planner_that_raises(navigator, drive, at):
    navigator.planner = Planner(at)
    found = drive(goal=[GOAL, (1.0, 1.0)])
    check_ended(found, "planner", "Planner")
    assert found[1].fault.function == "Planner.plan"
    assert found[1].fault.source == "raise self.error"


@pytest.mark.parametrize(
    ("where", "at"), [("reset", 1), ("set_path", 1), ("compute_velocity", 1), ("compute_velocity", 100)]
)
def test_a_controller_that_raises(navigator, drive, where, at):
    navigator.controller = Controller(where, at)
    navigator.progress_checker.time_allowance = 60.0
    found = drive(time_limit_s=30.0)
    check_ended(found, "controller", "Controller", RAISED_IN)
    assert len(found[1].trajectory) == (at if where == "compute_velocity" else 1)


@pytest.mark.parametrize(
    ("where", "at"),
    [(where, 1) for where in ("reset", "set_goal", "set_latency", "update", "behavior_runs")]
    + [("status", 1), ("update", 100), ("status", 100), ("behavior_runs", 100)],
)
def test_an_agent_that_raises(drive, where, at):
    found = drive(Agent(where, at), time_limit_s=60.0)
    check_ended(found, "agent", "Agent", RAISED_IN)


class Unready(Agent):
    """Cannot be made."""

    def __init__(self):
        raise Boom("no idea")


class Lost(Localizer):
    """Cannot be made."""

    def __init__(self):
        raise Boom("no idea")


def test_an_agent_and_a_localizer_whose_classes_raise_as_they_are_made(drive):
    check_ended(drive(Unready), "agent", "Unready")
    check_ended(drive(localizer=Lost), "localizer", "Lost")


@pytest.mark.parametrize(("where", "at"), [("reset", 1), ("update", 1), ("update", 20)])
def test_a_localizer_that_raises(drive, where, at):
    check_ended(drive(localizer=Localizer(where, at)), "localizer", "Localizer", RAISED_IN)


@pytest.mark.parametrize("where", ["reset", "check"])
def test_a_collision_monitor_that_raises(drive, where):
    check_ended(drive(monitor=Monitor(where)), "collision monitor", "Monitor")


def test_a_smoother_that_raises(navigator, drive):
    navigator.smoother = Smoother()
    check_ended(drive(), "smoother", "Smoother")


def test_a_behavior_that_raises(room, carter, drive):
    tour = [trundle.navigation.Waypoint(1.5, 1.0, tasks=[Fails()])]
    check_ended(drive(goal=tour), "behavior", "Fails")


@pytest.mark.parametrize("where", ["reset", "step"])
def test_a_simulator_that_raises(carter, drive, where):
    found = drive(sim=Simulator(trundle.World("hall", ()), carter, where))
    check_ended(found, "simulator", "Simulator")


def test_what_measures_a_run_and_raises(make_sim, navigator, start):
    def measure(*arguments, **named):
        raise Boom("no idea")

    session = Session(make_sim(), navigator, start, GOAL, measure=measure)
    with pytest.raises(Boom):
        session.run()
    assert (session.outcome, session.finish().fault.plugin) == (Outcome.ERROR, "measure")


# What is raised -------------------------------------------------------------------------------------------------------


class Odd(Exception):  # noqa: N818
    """Has no text, and cannot be pickled."""

    def __str__(self):
        raise RuntimeError("no text")

    def __reduce__(self):
        raise RuntimeError("not pickled")


class Base(BaseException):
    pass


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (InputError("of a plug-in"), "of a plug-in"),
        (OSError(2, "No such file", "x.bin"), "[Errno 2] No such file: 'x.bin'"),
        (Odd(), "(its text cannot be made: RuntimeError)"),
        (Base("base"), "base"),
        (SystemExit(3), "3"),
        (ValueError("a" * 10_000), "a" * 2_000),
        (ValueError("\udcff"), "\\udcff"),
        (MemoryError(), ""),
    ],
)
def test_any_exception_is_kept_in_words(drive, error, message):
    raised, episode, _ = drive(Agent("update", 3, error), error=type(error))
    assert raised is error
    assert (episode.fault.type, episode.fault.message) == (type(error).__name__, message)
    assert pickle.loads(pickle.dumps(episode.fault)) == episode.fault


def test_no_path_and_a_broken_simulator_are_outcomes(carter, make_sim, start):
    sim = Simulator(trundle.World("hall", ()), carter, "step", SimulationError("gone"))
    assert run(sim, Agent(""), start, GOAL).outcome is Outcome.ABORTED
    for where, at in (("update", 3), ("set_goal", 1)):
        episode = run(make_sim(), Agent(where, at, NoPathError("no way")), start, GOAL)
        assert (episode.outcome, episode.message, episode.fault) == (Outcome.NO_PATH, "no way", None)


def test_ctrl_c_in_a_plugin_aborts(make_sim, start):
    episode = run(make_sim(), Agent("update", 3, KeyboardInterrupt()), start, GOAL)
    assert (episode.outcome, episode.message) == (Outcome.ABORTED, "stopped by Ctrl-C")


def test_what_is_refused_leaves_no_folder(make_sim, navigator, start, tmp_path):
    with RunFolder(tmp_path / "run", video=False) as folder, pytest.raises(trundle.errors.BlockedPoseError):
        run(make_sim(), navigator, start, (0.01, 0.01), observers=[folder])
    assert not (tmp_path / "run").exists()


def test_an_agent_that_returns_something_else_is_named(drive):
    error, episode, _ = drive(Agent("", returns=None), error=InputError)
    assert str(error).startswith("agent 'Agent' returned None: an agent returns a Twist2D(v, w)")
    assert (episode.fault.plugin, episode.fault.function) == ("Agent", "Agent.update")
    assert episode.fault.file == inspect.getfile(Agent)


def test_a_compiled_plugin_is_named_by_its_class(drive, monkeypatch):
    module = types.ModuleType("fast_agents")
    module.__file__ = "/opt/fast_agents.so"
    monkeypatch.setitem(sys.modules, "fast_agents", module)
    compiled = type("Fast", (Agent,), {"update": staticmethod(operator.truediv), "__module__": "fast_agents"})
    _, episode, _ = drive(compiled(""), error=TypeError)
    assert (episode.fault.kind, episode.fault.plugin) == ("agent", "Fast")
    assert episode.fault.place == "/opt/fast_agents.so:0"


def test_what_a_plugin_calls_is_its_fault_at_its_own_line(drive):
    class Divides(Agent):
        def update(self, observation, estimate):
            return np.linalg.inv(np.zeros((2, 2)))

    _, episode, _ = drive(Divides(""), error=np.linalg.LinAlgError)
    assert (episode.fault.plugin, episode.fault.file) == ("Divides", __file__)
    assert episode.fault.source == "return np.linalg.inv(np.zeros((2, 2)))"


def test_every_library_that_trundle_imports_is_no_plugin():
    named = set()
    for file in Path(trundle.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                named.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                named.add(node.module)
    tops = {name.partition(".")[0] for name in named}
    assert tops - set(sys.stdlib_module_names) - {"trundle", "__future__"} <= LIBRARIES
