import json
import logging
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from trundle import __version__
from trundle.cli.entry import PLUGIN_GROUPS, VERBS, _show_log, run_command
from trundle.cli.shared.termination import BAD_INPUT, DONE, FAULT, INTERRUPTED, PIPE_CLOSED
from trundle.control import controller_names
from trundle.control.controller import CONTROLLERS
from trundle.errors import InputError, OutputError
from trundle.localization.localizer import LOCALIZERS
from trundle.navigation.agents import AGENTS
from trundle.navigation.behaviors.behavior import BEHAVIORS
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.robots import robot_names
from trundle.robots.robot import _PLUGINS
from trundle.sim.simulator import SIMULATORS
from trundle.worlds import world_names
from trundle.worlds.world import WORLDS


def fail_with(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> int:
    def dispatch(_arguments: object) -> int:
        raise error

    monkeypatch.setattr("trundle.cli.entry._dispatch", dispatch)
    return run_command(["joints"])


def test_overview_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["--help"]) == DONE
    text = capsys.readouterr().out
    assert all(f"  {verb} " in text for verb in VERBS)


def test_no_arguments_give_the_overview(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command([]) == DONE
    assert capsys.readouterr().out.startswith("Usage: trundle VERB")


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["--version"]) == DONE
    assert capsys.readouterr().out == f"{__version__}\n"


@pytest.mark.parametrize(
    "verb",
    [[verb] for verb in VERBS if verb not in ("map", "robot", "record", "ros2")]
    + [["map", "build"], ["robot", "new"], ["ros2", "serve"], ["ros2", "check"]],
)
def test_every_verb_explains_itself_with_an_example_and_json(
    verb: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command([*verb, "--help"]) == DONE
    text = capsys.readouterr().out
    assert f"trundle {' '.join(verb)}" in text.split("Example", 1)[1]
    assert "--json" in text
    assert "--quiet" in text
    assert not any(raw in text for raw in ("options=", "[default: ()]", "[default: None]"))


def test_unknown_verb_offers_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["jonits"]) == BAD_INPUT
    streams = capsys.readouterr()
    assert streams.out == ""
    assert "unknown verb 'jonits'. Did you mean 'joints'?" in streams.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["joints"], "requires an argument"),
        (["joints", "nova_carter", "--jsn"], "--json"),
        (["joints", "nova_carter", "spare"], "spare"),
        (["map", "bild"], "build"),
        (["map", "build", "warehouse", "--resolution", "fine"], "fine"),
    ],
)
def test_usage_errors_are_bad_input_and_point_to_the_help(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(arguments) == BAD_INPUT
    streams = capsys.readouterr()
    assert streams.out == ""
    assert words in streams.err
    assert "--help" in streams.err


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (InputError("map.yaml: no"), BAD_INPUT, "trundle: map.yaml: no\n"),
        (OutputError("cannot write x"), BAD_INPUT, "trundle: cannot write x\n"),
        (KeyboardInterrupt(), INTERRUPTED, "interrupted\n"),
    ],
)
def test_errors_on_purpose_become_one_message(
    error: BaseException,
    code: int,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert fail_with(error, monkeypatch) == code
    assert capsys.readouterr() == ("", words)


@pytest.mark.parametrize("arguments", [[], ["--json"]])
def test_what_the_system_refuses_is_bad_input_and_json_where_asked(
    arguments: list[str],
) -> None:
    program = (
        "import sys\n"
        "from trundle.cli import entry\n"
        "def refuse(_arguments): raise PermissionError(13, 'Permission denied', 'map.yaml')\n"
        "entry._dispatch = refuse\n"
        "sys.exit(entry.run_command(['joints', *sys.argv[1:]]))"
    )
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == BAD_INPUT
    assert done.stderr == "trundle: [Errno 13] Permission denied: 'map.yaml'\n"
    if arguments:
        error = json.loads(done.stdout)["error"]
        assert (error["type"], error["message"]) == ("PermissionError", "[Errno 13] Permission denied: 'map.yaml'")
    else:
        assert done.stdout == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
def test_a_full_disk_is_one_message() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "trundle", "--help"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == BAD_INPUT
    assert "No space left" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_fault_of_ours_shows_its_traceback_and_is_no_exit_code_of_a_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fail_with(ZeroDivisionError("oh"), monkeypatch) == FAULT
    assert "ZeroDivisionError: oh" in capsys.readouterr().err


def test_a_reader_that_leaves_is_no_traceback() -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "trundle", "--help"], stdout=write_end, stderr=subprocess.PIPE, check=False
        )
    finally:
        os.close(write_end)
    assert done.returncode == PIPE_CLOSED
    assert done.stderr == b""


def test_help_loads_no_library() -> None:
    program = (
        "import sys\n"
        "from trundle.cli.entry import run_command\n"
        "run_command(['--help'])\n"
        "print(*{'numpy', 'pydantic', 'rich', 'cyclopts', 'mujoco', 'PIL', 'yaml'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == ""


def test_a_stream_that_cannot_show_a_letter_is_no_fault() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "trundle", "d\u00e9mo"],
        env={**os.environ, "PYTHONIOENCODING": "ascii:strict"},
        capture_output=True,
        check=False,
    )
    assert done.returncode == BAD_INPUT
    assert b"unknown verb 'd?mo'" in done.stderr


@pytest.mark.parametrize("before", ["", "egl"])
def test_the_engine_starts_without_its_window_and_leaves_the_environment(before: str) -> None:
    program = (
        "import os, sys\n"
        "from trundle.sim.mujoco.engine import import_engine\n"
        "import_engine()\n"
        "print('mujoco' in sys.modules, 'glfw' in sys.modules, os.environ.get('MUJOCO_GL', ''))"
    )
    environment = {key: value for key, value in os.environ.items() if key != "MUJOCO_GL"}
    environment |= {"MUJOCO_GL": before} if before else {}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split(" ", 2) == ["True", "False", f"{before}\n"]


@pytest.mark.slow
def test_a_run_loads_no_library_that_it_does_not_need(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from trundle.cli.entry import run_command\n"
        "code = run_command(['run', 'warehouse', '--time-limit=0.1', '--no-video', '--quiet', '--out=out'])\n"
        "heavy = {'scipy', 'matplotlib', 'av', 'OpenGL', 'glfw', 'rich', 'asyncio', 'numpy.ma'}\n"
        "print(code, *sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "1"


def test_what_is_logged_is_said_once_on_stderr(capsys, monkeypatch):
    logger = logging.getLogger("trundle")
    monkeypatch.setattr(logger, "handlers", [])
    monkeypatch.setattr(logger, "level", logging.NOTSET)
    _show_log(logging.INFO)
    for _ in range(2):
        logging.getLogger("trundle.sim").info("a mesh is %s", "concave")
    logging.getLogger("trundle.sim").debug("nobody asked")
    assert capsys.readouterr().err == "trundle: a mesh is concave\n"


@pytest.mark.parametrize(
    ("arguments", "kind", "word"),
    [
        (["run", "warehose", "--json"], "UnknownNameError", "warehouse"),
        (["plan", "none.yaml", "--json"], "MapError", "none.yaml"),
        (["plan", "m.yaml", "--start", "1", "2", "--json"], "UsageError", "--start 1,2"),
    ],
)
def test_with_json_an_error_is_one_json_value_with_the_same_exit_code(
    arguments: list[str], kind: str, word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(arguments) == BAD_INPUT
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["type"] == kind
    assert word in error["message"]
    assert run_command(arguments[:-1]) == BAD_INPUT
    assert capsys.readouterr().out == ""


def test_completion_is_installed_for_a_shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert run_command(["--install-completion", "bash"]) == DONE
    written = [path for path in tmp_path.rglob("*") if path.is_file() and "--resolution" in path.read_text()]
    assert len(written) == 1
    assert str(written[0]) in capsys.readouterr().out
    assert run_command(["--install-completion", "tcsh"]) == BAD_INPUT
    assert "bash, zsh, fish, powershell" in capsys.readouterr().err


def test_help_lists_the_names_that_an_option_accepts(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["run", "--help"]) == DONE
    words = set(re.findall(r"[\w]+", capsys.readouterr().out))
    ours = (PLANNERS._builtin, robot_names(), controller_names(), ["mujoco", "kinematic", "isaac"], world_names())
    assert [name for names in ours for name in names if name not in words] == []


def test_help_lists_the_plug_ins_that_are_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    installed = tmp_path / "lawn-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Name: lawn\nVersion: 1.0\n")
    (installed / "entry_points.txt").write_text("[trundle.planners]\nstripes = lawn:Stripes\nspiral = lawn:Spiral\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert run_command(["plan", "--help"]) == DONE
    assert "Plug-ins installed:\n  planners: spiral, stripes\n" in capsys.readouterr().out


def test_plug_ins_are_looked_for_where_the_registries_do() -> None:
    ours = (_PLUGINS, WORLDS, PLANNERS, CONTROLLERS, SMOOTHERS, AGENTS, LOCALIZERS, SIMULATORS, BEHAVIORS)
    assert [registry._group for registry in ours] == list(PLUGIN_GROUPS.values())


@pytest.mark.parametrize("verb", ["export", "map check"])
def test_help_lists_the_robots_that_an_option_accepts(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command([*verb.split(), "--help"]) == DONE
    listed = capsys.readouterr().out.partition("--robot STR")[2]
    assert [name for name in robot_names() if name not in re.findall(r"[\w]+", listed)] == []


@pytest.mark.parametrize("verb", ["view", "drive", "joints"])
def test_help_lists_robots_and_worlds(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command([verb, "--help"]) == DONE
    words = set(re.findall(r"[\w]+", capsys.readouterr().out))
    names = [*robot_names(), *(world_names() if verb != "joints" else [])]
    assert [name for name in names if name not in words] == []
