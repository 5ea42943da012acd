"""The runner's command line: what it says where something is missing, and how scripts end."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from trundle.testing.isaac import __main__ as runner
from trundle.testing.isaac import environment

BEGIN = """from isaacsim import SimulationApp
simulation_app = SimulationApp({"headless": True})
"""


def write(folder: Path, text: str, begin: str = BEGIN) -> Path:
    (folder / "script.py").write_text(begin + text, encoding="utf-8")
    return folder / "script.py"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nowhere.py"], "nowhere.py: no such file; give a Python script"),
        (["--assets", "nowhere", __file__], "--assets nowhere: it has no subfolder Isaac"),
    ],
)
def test_what_is_missing_is_one_message(arguments: list[str], says: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert runner.main(arguments) == 2
    assert says in capfd.readouterr().err


@pytest.mark.parametrize(
    "arguments", [[], ["--seconds", "-1", "x.py"], ["--seconds", "nan", "x.py"], ["--api", "4", "x.py"]]
)
def test_a_wrong_command_line_is_explained(arguments: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        runner.main(arguments)
    assert end.value.code == 2
    assert "usage: python -m trundle.testing.isaac" in capfd.readouterr().err


def test_without_an_environment_it_says_how_to_get_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert runner.main([str(write(tmp_path, ""))]) == 2
    said = capfd.readouterr().err
    assert "`python -m trundle.testing.isaac --build` builds it, once" in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("sys.platform", "darwin", "are for Linux on x86-64, not for darwin"),
        ("platform.machine", lambda: "aarch64", "not for linux on aarch64"),
        ("platform.libc_ver", lambda: ("glibc", "2.31"), "need glibc 2.35 or later, and here is glibc 2.31"),
        ("os.get_exec_path", lambda: ["/nowhere"], "there is no Python 3.12, neither on PATH nor in pyenv"),
    ],
)
def test_a_machine_that_cannot_have_it_is_told_why_and_the_tests_too(
    name: str, value: object, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    monkeypatch.setattr(f"trundle.testing.isaac.environment.{name}", value)
    with pytest.raises(environment.UnavailableError, match=says):
        environment.build()
    if name == "os.get_exec_path":
        with pytest.raises(environment.UnavailableError, match=says):
            environment.find()


def test_arguments_of_the_script_are_its_own() -> None:
    import argparse

    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("script")
    parser.add_argument("--seconds")
    own, rest = runner._split(parser, ["a.py", "--seconds", "3", "--map", "m.yaml", "--", "--seconds", "9"])
    assert (own.script, own.seconds, rest) == ("a.py", "3", ["--map", "m.yaml", "--seconds", "9"])


@pytest.mark.isaac
def test_an_exception_has_pythons_traceback_and_exit_status(isaac: Callable[..., Any], tmp_path: Path) -> None:
    script = write(tmp_path, 'def drive():\n    raise ValueError("no wheels")\ndrive()\n')
    done = isaac(script)
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    assert lines[0] == "Traceback (most recent call last):"
    assert lines[-1] == "ValueError: no wheels"
    assert f'File "{script}", line 5' in done.stderr
    assert "trundle" not in done.stderr.replace(str(tmp_path), "")


@pytest.mark.isaac
@pytest.mark.parametrize(
    ("text", "begin", "status", "says"),
    [
        ("import sys\nsys.exit(7)\n", BEGIN, 7, ""),
        ("sys.exit('no map')\n", "import sys\n", 1, "no map"),
        ("import isaacsim.core.api\n", "", 1, "can only be imported after SimulationApp is created"),
        ("import isaacsim.core.utils.torch as utils\nutils.rad2deg(1.0)\n", BEGIN, 1, "there is no PyTorch without"),
        ("import isaacsim.asset.importer.urdf\n", BEGIN, 1, "'isaacsim.asset': without Isaac Sim there are only the"),
        ("while simulation_app.is_running():\n    simulation_app.update()\nprint('end')\n", BEGIN, 0, ""),
        (
            "from isaacsim.core.api import World\nworld = World(physics_dt=0.02, rendering_dt=0.02)\nworld.reset()\n"
            "while True:\n    world.step(render=False)\n",
            BEGIN, 3, "went on after the simulation had ended (--seconds 2.0), and was ended",
        ),
    ],
    ids=["exit status", "exit message", "too early", "no PyTorch", "not there", "update", "endless"],
)  # fmt: skip
def test_a_script_ends(
    isaac: Callable[..., Any], tmp_path: Path, text: str, begin: str, status: int, says: str
) -> None:
    done = isaac(write(tmp_path, text, begin), "--seconds", 2)
    assert (done.returncode, says in done.stderr) == (status, True), done.stderr


@pytest.mark.isaac
def test_a_script_that_hangs_is_ended(isaac: Callable[..., Any], tmp_path: Path) -> None:
    done = isaac(write(tmp_path, "while True:\n    pass\n", ""), "--timeout", 3)
    assert done.returncode == 124
    assert "did not end within 3 s, and was ended (--timeout)" in done.stderr
