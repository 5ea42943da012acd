"""Plug-ins that raise, on the command line: five lines that name them, exit code 3, and a folder."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from support.command_line import Trundle
from support.page_visitor import OpenPage, Visitor
from trundle.cli.shared.termination import BAD_INPUT, FAULT, PLUGIN_RAISED
from trundle.mission import Episode, Outcome, Scenario
from trundle.sim.simulator import SIMULATORS
from trundle.worlds.world import WORLDS

ENDS = ("--start", "0.5,0.5", "--goal", "6.5,3.5", "--backend", "kinematic")
SOURCE = """
import sys
from trundle.errors import InputError, MissingExtraError, UnknownNameError
from trundle.geometry import Twist2D
from trundle.planning import create_planner
from trundle.sim.kinematic import KinematicSimulator


class Odd(Exception):
    def __str__(self):
        raise RuntimeError("no text")

    def __reduce__(self):
        raise RuntimeError("not pickled")


class Base(BaseException):
    pass


ERRORS = {
    "value": ValueError("no idea\\nat all " + "x" * 5000),
    "input": InputError("of a plug-in"),
    "unknown": UnknownNameError("thing", "x", ["y"]),
    "os": FileNotFoundError(2, "No such file", "weights.bin"),
    "odd": Odd(),
    "base": Base("base"),
    "exit": SystemExit(0),
    "broken": BrokenPipeError("its own pipe"),
    "surrogate": ValueError("\\udcff"),
}


class Planner:
    def __init__(self, error="value", at=1, where="plan"):
        self.error, self.at, self.calls, self.inner = ERRORS[error], at, 0, create_planner("auto")
        if where == "init":
            raise self.error

    def plan(self, costmap, start, goal, **options):
        self.calls += 1
        if self.calls >= self.at:
            raise self.error
        return self.inner.plan(costmap, start, goal, **options)


class Controller:
    def __init__(self, robot, at=1, kind="value", returns=True):
        self.at, self.calls, self.error, self.returns = at, 0, ERRORS[kind], returns

    def reset(self, *, seed=0):
        pass

    def set_path(self, path):
        pass

    def compute_velocity(self, pose, twist, costmap, dt):
        self.calls += 1
        if self.calls >= self.at:
            raise self.error
        return Twist2D(0.1, 0.0) if self.returns else None


class Simulator(KinematicSimulator):
    def step(self, command, dt):
        raise ERRORS["value"]


def make_world(*, seed):
    raise ERRORS["os"]


class Localizer:
    def __init__(self, grid, robot):
        raise TypeError("no idea")

    def reset(self, pose, *, seed=0):
        pass

    def update(self, observation):
        pass
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of somebody's module, which can be imported."""
    folder = tmp_path / "lib"
    folder.mkdir()
    (folder / "my_plugins.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "my_plugins", raising=False)
    return folder / "my_plugins.py"


def check_five_lines(err: str, *names: str) -> None:
    lines = err.rstrip("\n").splitlines()[-5:]
    assert lines[0].startswith("trundle: the ")
    assert [line.split()[0] for line in lines[1:]] == ["where", "line", "record", "do"]
    assert "Traceback" not in err
    assert max(map(len, lines)) < 500
    for name in names:
        assert name in err


def only_run() -> Episode:
    (folder,) = Path("runs").iterdir()
    return Episode.load(folder)


@pytest.mark.slow
@pytest.mark.parametrize("error", ["value", "input", "unknown", "os", "odd", "base", "exit", "broken", "surrogate"])
def test_a_planner_that_raises_anything(trundle: Trundle, room_map: Path, mine: Path, error: str) -> None:
    options = ("--planner", "my_plugins:Planner", "--planner-option", f"error={error}", "--no-video")
    done = trundle("run", room_map, *ENDS, *options)
    assert (done.code, done.out) == (PLUGIN_RAISED, ""), done.err
    episode = only_run()
    check_five_lines(done.err, "the planner Planner", f"Planner.plan, {mine}:", str(episode.folder))
    assert episode.outcome is Outcome.ERROR
    assert (episode.fault.plugin, episode.fault.file) == ("Planner", str(mine))
    assert (episode.folder / "report.html").is_file()
    assert Scenario.load(episode.folder).planner.name == "my_plugins:Planner"


def test_a_constructor_that_raises_leaves_a_folder_too(trundle: Trundle, room_map: Path, mine: Path) -> None:
    options = ("--planner", "my_plugins:Planner", "--planner-option", "where=init", "--no-video")
    done = trundle("run", room_map, *ENDS, *options, "-o", "out", "--json")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the planner Planner", f"Planner.__init__, {mine}:", "out")
    episode = Episode.load("out")
    assert (episode.outcome, episode.fault.function) == (Outcome.ERROR, "Planner.__init__")
    assert done.json["error"]["run_dir"] == "out"
    assert (done.json["error"]["type"], done.json["error"]["plugin"]) == ("ValueError", "Planner")
    assert "Traceback" in done.json["error"]["traceback"]


def test_a_type_error_in_a_constructor_is_of_the_plugin(trundle: Trundle, room_map: Path, mine: Path) -> None:
    done = trundle("run", room_map, *ENDS, "--localizer", "my_plugins:Localizer", "--no-video")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the localizer Localizer raised TypeError: no idea", f"{mine}:")
    assert only_run().fault.kind == "localizer"


def test_an_option_that_a_plugin_does_not_have_is_bad_input(trundle: Trundle, room_map: Path, mine: Path) -> None:
    done = trundle("run", room_map, *ENDS, "--planner", "my_plugins:Planner", "--planner-option", "x=1", "--no-video")
    assert (done.code, "has no option 'x'" in done.err) == (BAD_INPUT, True)
    assert not list(Path().glob("runs/*"))


def test_a_run_that_is_recorded_closes_its_bag(trundle: Trundle, room_map: Path, mine: Path) -> None:
    pytest.importorskip("mcap")
    options = ("--controller", "my_plugins:Controller", "--controller-option", "at=40", "--no-video", "--record")
    done = trundle("run", room_map, *ENDS, *options, "-o", "out")
    assert done.code == PLUGIN_RAISED, done.err
    assert not Path("out/run.partial.mcap").exists()
    info = trundle("record", "info", "out/run.mcap", "--json")
    assert (info.code, info.json["outcome"], info.json["damage"]) == (0, "error", None)
    assert trundle("report", "out", "-o", "again.html").code == 0
    assert "out" in done.err


def test_what_a_plugin_returns_wrong_is_named(trundle: Trundle, room_map: Path, mine: Path) -> None:
    options = ("--controller", "my_plugins:Controller", "--controller-option", "at=99", "--no-video")
    done = trundle("run", room_map, *ENDS, *options, "--controller-option", "returns=false")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "returned None: compute_velocity returns a Twist2D", f"{mine}:")


def test_a_plan_alone_names_the_planner(trundle: Trundle, room_map: Path, mine: Path) -> None:
    done = trundle("plan", room_map, "--start", "0.5,0.5", "--goal", "6.5,3.5", "--planner", "my_plugins:Planner")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the planner Planner", "nothing was recorded")


def test_a_live_run_raises_as_well(trundle: Trundle, room_map: Path, mine: Path) -> None:
    options = ("--controller", "my_plugins:Controller", "--controller-option", "at=11", "--no-video", "--speed", "max")
    done = trundle("run", room_map, *ENDS, *options)
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the controller Controller")
    assert len(only_run().trajectory) == 11


def test_a_fault_of_trundle_itself_ends_a_run_properly(
    trundle: Trundle, room_map: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = {"inv": np.linalg.inv, "zeros": np.zeros((2, 2)), "__name__": "trundle.navigation.progress"}
    exec("def advance(self, pose): inv(zeros)", names)  # as if the method were trundle's
    monkeypatch.setattr("trundle.navigation.progress.FollowedPath.advance", names["advance"])
    done = trundle("run", room_map, *ENDS, "--no-video")
    assert (done.code, "Traceback" in done.err) == (FAULT, True)
    episode = only_run()
    assert (episode.outcome, episode.fault.is_plugin) == (Outcome.ERROR, False)
    assert episode.message == "trundle raised LinAlgError: Singular matrix"


def test_a_page_shows_the_error_and_can_restart(trundle: Trundle, room_map: Path, mine: Path, play) -> None:
    seen: list[dict] = []

    def part(page: OpenPage) -> None:
        seen.append(page.wait("end"))
        page.send("restart", seed="next")
        page.wait("run", lambda message: message["n"] == 2)
        seen.append(page.wait("end"))

    errors = play(part)
    options = ("--planner", "my_plugins:Planner", "--no-video", "--browser")
    done = trundle("run", room_map, *ENDS, *options)
    assert (done.code, errors) == (PLUGIN_RAISED, []), done.err
    assert [end["outcome"] for end in seen] == ["error", "error"]
    assert "Planner raised ValueError" in seen[0]["message"]
    assert seen[0]["replay"] is not None
    assert len(list(Path("runs").iterdir())) == 2


@pytest.mark.slow
@pytest.mark.parametrize(("option", "shown"), [("at=1", "end"), ("where=init", "error")])
def test_a_server_stays_up_after_a_plugin_has_raised(tmp_path: Path, mine: Path, option: str, shown: str) -> None:
    command = [sys.executable, "-m", "trundle", "serve", "office", "--backend", "kinematic", "--port", "0", "--no-open"]
    with subprocess.Popen(
        [*command, "--planner", "my_plugins:Planner", "--planner-option", option],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(mine.parent)},
    ) as process:
        try:
            with Visitor.of_address(process.stdout.readline().strip()).open() as page:
                page.wait("hello")
                page.send("setup", seed=2)
                assert "Planner raised ValueError: no idea" in str(page.wait(shown))
                page.ping()
                page.send("restart", seed="next")
                page.wait(shown)
                page.ping()
                assert any("recorded in runs/" in message["text"] for message in page.got if message["type"] == "error")
                page.send("setup", seed=2, planner="auto")
                page.wait("run")
                page.send("speed", factor="max")
                page.wait("frame", lambda message: message["waiting"])  # at the goal, for the next one
                page.send("end")
                assert page.wait("end")["outcome"] == "arrived"
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=120) == 130
        finally:
            process.kill()
    ends = sorted(json.loads(file.read_text())["outcome"] for file in (tmp_path / "runs").glob("*/episode.json"))
    assert ends == ["arrived", "error", "error"]


def test_a_drive_by_commands_names_the_simulator(trundle: Trundle, mine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SIMULATORS._builtin, "mine", "my_plugins:Simulator")
    done = trundle("drive", "nova_carter", "--backend", "mine", "--command", "0.4,0,1", "-o", "out")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the simulator Simulator", f"Simulator.step, {mine}:")
    assert Path("out/drive.csv").is_file()


def test_a_world_that_raises_leaves_a_folder_too(trundle: Trundle, mine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(WORLDS._builtin, "mine", "my_plugins:make_world")
    done = trundle("run", "mine", "--backend", "kinematic", "--no-video", "-o", "out")
    assert done.code == PLUGIN_RAISED, done.err
    check_five_lines(done.err, "the world make_world", f"make_world, {mine}:", "out")
    assert Episode.load("out").outcome is Outcome.ERROR
