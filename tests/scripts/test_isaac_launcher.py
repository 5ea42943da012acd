"""The shell launcher, with stand-ins for Isaac Sim's python.sh."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

LAUNCHER = Path(__file__).parents[2] / "isaac.sh"


def put_python(folder: Path, name: str = "python.sh") -> Path:
    """A launcher that prints its arguments, a line each."""
    folder.mkdir(parents=True, exist_ok=True)
    script = folder / name
    script.write_text('#!/bin/sh\nprintf "%s\\n" "$0" "$@"\necho --\n')
    script.chmod(0o755)
    return script


def launch(home: Path, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    kept = {"PATH": "/usr/bin:/bin", "HOME": str(home)}
    return subprocess.run(
        [str(LAUNCHER), *arguments], env=kept | environment, capture_output=True, text=True, check=False
    )


def calls(done: "subprocess.CompletedProcess[str]") -> list[list[str]]:
    assert done.returncode == 0, done.stderr
    return [call.strip().split("\n") for call in done.stdout.split("--\n") if call.strip()]


def test_the_verb_goes_on_with_the_backend(tmp_path: Path) -> None:
    python = put_python(tmp_path / "sim")
    first, second = calls(launch(tmp_path, "run", "a b.yaml", "--headless", ISAACSIM_PATH=str(tmp_path / "sim")))
    assert first[0] == str(python)
    assert first[1].endswith("scripts/isaac_install.py")
    assert first[2] == "--if-missing"
    assert second[1:] == ["-m", "trundle", "run", "a b.yaml", "--headless", "--backend", "isaac"]


@pytest.mark.parametrize("given", [["--backend", "mujoco"], ["--backend=mujoco"]])
def test_a_backend_that_is_given_stays(tmp_path: Path, given: list[str]) -> None:
    put_python(tmp_path / "sim")
    _, call = calls(launch(tmp_path, "run", "x.yaml", *given, ISAACSIM_PATH=str(tmp_path / "sim")))
    assert call[1:] == ["-m", "trundle", "run", "x.yaml", *given]


def test_verbs_without_a_backend_get_none(tmp_path: Path) -> None:
    put_python(tmp_path / "sim")
    _, call = calls(launch(tmp_path, "map", "check", "m.yaml", ISAACSIM_PATH=str(tmp_path / "sim")))
    assert call[1:] == ["-m", "trundle", "map", "check", "m.yaml"]


def test_install_takes_a_wheel_and_runs_nothing_else(tmp_path: Path) -> None:
    put_python(tmp_path / "sim")
    (call,) = calls(launch(tmp_path, "install", "trundle.whl", ISAACSIM_PATH=str(tmp_path / "sim")))
    assert call[1].endswith("scripts/isaac_install.py")
    assert call[2:] == ["trundle.whl"]


@pytest.mark.parametrize(
    "place", ["isaacsim", "isaac-sim", "isaacsim/_build/linux-x86_64/release", ".local/share/ov/pkg/isaac-sim-4.5.0"]
)
def test_the_usual_places_are_found(tmp_path: Path, place: str) -> None:
    python = put_python(tmp_path / place)
    _, call = calls(launch(tmp_path, "joints", "nova_carter"))
    assert call[0] == str(python)


def test_a_pip_installed_one_is_found_in_the_active_environment(tmp_path: Path) -> None:
    python = put_python(tmp_path / "venv" / "bin", "python")
    _, call = calls(launch(tmp_path, "view", "nova_carter", VIRTUAL_ENV=str(tmp_path / "venv")))
    assert call[0] == str(python)


def test_a_python_without_isaacsim_is_not_taken(tmp_path: Path) -> None:
    done = launch(tmp_path, "run", "x.yaml")
    assert done.returncode == 2
    assert "no Isaac Sim found. Set ISAACSIM_PATH" in done.stderr
    assert "pip install 'isaacsim" in done.stderr


def test_a_folder_without_python_sh_is_named(tmp_path: Path) -> None:
    done = launch(tmp_path, "run", "x.yaml", ISAACSIM_PATH=str(tmp_path))
    assert done.returncode == 2
    assert f"ISAACSIM_PATH is {tmp_path}, and there is no python.sh in it" in done.stderr


def test_a_failed_installation_stops_it(tmp_path: Path) -> None:
    python = put_python(tmp_path / "sim")
    python.write_text("#!/bin/sh\nexit 2\n")
    done = launch(tmp_path, "run", "x.yaml", ISAACSIM_PATH=str(tmp_path / "sim"))
    assert (done.returncode, done.stdout) == (2, "")


def test_without_a_verb_it_explains_itself(tmp_path: Path) -> None:
    done = launch(tmp_path)
    assert done.returncode == 0
    assert "./isaac.sh run scenario.yaml" in done.stdout


def test_shellcheck_finds_nothing() -> None:
    shellcheck = shutil.which("shellcheck")
    if shellcheck is None:
        pytest.skip("shellcheck is not installed")
    done = subprocess.run(
        [shellcheck, str(LAUNCHER)], capture_output=True, text=True, check=False, env=dict(os.environ)
    )
    assert (done.returncode, done.stdout) == (0, "")
