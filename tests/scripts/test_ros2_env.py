"""The builder of real ROS 2 environments, where nothing can be built and before anything is."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.modules import load
from trundle.testing.isaac.environment import UnavailableError, find_python

SCRIPTS = Path(__file__).parents[2] / "scripts"


environments = load(SCRIPTS / "ros2_env.py")
interfaces = load(SCRIPTS / "ros2_interfaces.py")


def run(*arguments: str, **env: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(SCRIPTS / "ros2_env.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **env}, check=False)


def put_python(folder: Path, text: str) -> Path:
    folder.mkdir(parents=True)
    python = folder / "python3.12"
    python.write_text(f"#!/bin/sh\n{text}\n")
    python.chmod(0o755)
    return python


def test_an_unknown_distribution_is_refused_with_the_choices() -> None:
    done = run("jazy")
    assert done.returncode == 2
    assert "unknown distribution jazy; choose of jazzy, kilted" in done.stderr


def test_what_is_not_built_is_described_with_what_to_do(tmp_path: Path) -> None:
    done = run("--describe", XDG_CACHE_HOME=str(tmp_path))
    found = json.loads(done.stdout)
    assert found == {
        distro: {"reason": f"no ROS 2 {distro.capitalize()}: it is not built: run make test-ros2"}
        for distro in ("jazzy", "kilted")
    }
    assert not any(tmp_path.iterdir())


def test_a_build_that_cannot_be_says_why_in_one_line_and_keeps_it_for_the_tests(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    done = run("kilted", XDG_CACHE_HOME=str(cache), CC="no-such-compiler")
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line == "No ROS 2 Kilted for tests: there is no compiler no-such-compiler."
    found = json.loads(run("--describe", "kilted", XDG_CACHE_HOME=str(cache)).stdout)
    assert found == {"kilted": {"reason": "no ROS 2 Kilted: there is no compiler no-such-compiler."}}


def test_a_build_that_fails_leaves_no_environment(tmp_path: Path) -> None:
    put_python(tmp_path / "bin", 'test "$1" = -c && echo "[true, true]" && exit\necho oh dear >&2\nexit 3')
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    done = run("jazzy", XDG_CACHE_HOME=str(tmp_path / "cache"), PATH=path)
    assert done.returncode == 1
    assert "could not make an environment: oh dear" in done.stderr.splitlines()[-1]
    (folder,) = (tmp_path / "cache" / "trundle" / "ros2").iterdir()
    assert {path.name for path in folder.iterdir()} == {"jazzy.lock", "jazzy.log", "jazzy.failed"}


def test_a_shim_that_fails_is_passed_over_for_a_python_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put_python(tmp_path / "shims", "echo no version set >&2\nexit 127")
    put_python(tmp_path / "other", 'echo "[false, true]"')
    works = put_python(tmp_path / "pyenv" / "versions" / "3.12.4" / "bin", 'echo "[true, true]"')
    monkeypatch.setenv("PATH", f"{tmp_path / 'shims'}:{tmp_path / 'other'}:/bin")
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    assert find_python() == str(works)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("exit 127", "does not start or lacks venv or ssl"),
        ('echo "[false, true]"', "is not Python 3.12"),
        ('echo "[true, false]"', "has no headers"),
    ],
)
def test_it_says_what_is_wrong_with_the_only_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, reason: str
) -> None:
    put_python(tmp_path / "bin", text)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}")
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    with pytest.raises(UnavailableError, match=reason):
        find_python()


def test_without_any_python_it_says_where_it_looked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    with pytest.raises(UnavailableError, match="neither on PATH nor in pyenv"):
        find_python()


def test_a_definition_keeps_the_lines_of_its_distribution() -> None:
    text = "int32 a\nint32 b  #[jazzy]\nuint32 b #[kilted]\n# A comment.\nint32 c\n"
    assert interfaces.of_distro(text, "jazzy") == "int32 a\nint32 b\n# A comment.\nint32 c\n"
    assert interfaces.of_distro(text, "kilted") == "int32 a\nuint32 b\n# A comment.\nint32 c\n"


def test_a_definition_may_belong_to_one_distribution() -> None:
    assert interfaces.of_distro("#[kilted]\nint32 a\n", "kilted") == "int32 a\n"
    assert interfaces.of_distro("#[kilted]\nint32 a\n", "jazzy") is None


def test_every_mark_names_a_distribution_that_is_built() -> None:
    folder = environments.TESTS / "interfaces"
    marks = {
        line.rpartition("#[")[2].rstrip("]")
        for path in folder.rglob("*.*")
        for line in path.read_text().splitlines()
        if "#[" in line
    }
    assert marks == set(environments.DISTROS)


def test_the_packages_are_those_that_are_built() -> None:
    folders = {path.name for path in (environments.TESTS / "interfaces").iterdir()}
    assert folders == set(interfaces.PACKAGES)


def test_requirements_are_pinned_and_name_no_place() -> None:
    for path in (environments.TESTS / "requirements").iterdir():
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        assert all(line.count("==") == 1 and "/" not in line for line in lines), path
