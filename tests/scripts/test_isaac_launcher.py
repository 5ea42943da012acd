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
    "place", ["isaacsim", "isaac-sim", "isaacsim/_build/linux-aarch64/release", ".local/share/ov/pkg/isaac-sim-4.5.0"]
)
def test_the_usual_places_are_found(tmp_path: Path, place: str) -> None:
    python = put_python(tmp_path / place)
    _, call = calls(launch(tmp_path, "joints", "nova_carter"))
    assert call[0] == str(python)


def test_a_pip_installed_one_is_found_in_the_active_environment(tmp_path: Path) -> None:
    python = put_python(tmp_path / "venv" / "bin", "python")
    _, call = calls(launch(tmp_path, "view", "nova_carter", VIRTUAL_ENV=str(tmp_path / "venv")))
    assert call[0] == str(python)


def test_one_of_an_active_conda_environment_is_found(tmp_path: Path) -> None:
    python = put_python(tmp_path / "conda" / "envs" / "sim" / "bin", "python")
    _, call = calls(launch(tmp_path, "view", "nova_carter", CONDA_PREFIX=str(tmp_path / "conda" / "envs" / "sim")))
    assert call[0] == str(python)


def test_the_active_environment_goes_before_the_usual_folders(tmp_path: Path) -> None:
    put_python(tmp_path / "isaacsim")
    python = put_python(tmp_path / "venv" / "bin", "python")
    _, call = calls(launch(tmp_path, "view", "nova_carter", VIRTUAL_ENV=str(tmp_path / "venv")))
    assert call[0] == str(python)


def test_an_active_environment_without_isaacsim_is_passed_over(tmp_path: Path) -> None:
    put_python(tmp_path / "venv" / "bin", "python").write_text("#!/bin/sh\nexit 1\n")
    python = put_python(tmp_path / "isaacsim")
    _, call = calls(launch(tmp_path, "view", "nova_carter", VIRTUAL_ENV=str(tmp_path / "venv")))
    assert call[0] == str(python)


def test_a_link_to_it_finds_its_scripts(tmp_path: Path) -> None:
    put_python(tmp_path / "sim")
    link = tmp_path / "a link"
    link.symlink_to(LAUNCHER)
    environment = {"PATH": "/usr/bin:/bin", "ISAACSIM_PATH": str(tmp_path / "sim")}
    for arguments in (["joints", "jackal"], []):
        done = subprocess.run(
            [str(link), *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        if arguments:
            assert calls(done)[0][1] == str(LAUNCHER.parent / "scripts" / "isaac_install.py")
        else:
            assert "./isaac.sh run scenario.yaml" in done.stdout


def test_it_works_without_a_home(tmp_path: Path) -> None:
    done = subprocess.run(
        [str(LAUNCHER), "run", "x.yaml"], env={"PATH": "/usr/bin:/bin"}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "no Isaac Sim found. Set ISAACSIM_PATH" in done.stderr


def test_folders_with_spaces_are_folders(tmp_path: Path) -> None:
    python = put_python(tmp_path / "my home" / "isaacsim")
    first, second = calls(launch(tmp_path / "my home", "run", "my map.yaml"))
    assert (first[0], second[0], second[4]) == (str(python), str(python), "my map.yaml")


def test_isaac_sims_own_variable_without_a_launcher_is_no_mistake(tmp_path: Path) -> None:
    python = put_python(tmp_path / "isaacsim")
    _, call = calls(launch(tmp_path, "joints", "jackal", ISAAC_PATH=str(tmp_path)))
    assert call[0] == str(python)
    elsewhere = put_python(tmp_path / "elsewhere")
    _, call = calls(launch(tmp_path, "joints", "jackal", ISAAC_PATH=str(tmp_path / "elsewhere")))
    assert call[0] == str(elsewhere)


def test_a_python_without_isaacsim_is_not_taken(tmp_path: Path) -> None:
    done = launch(tmp_path, "run", "x.yaml")
    assert done.returncode == 2
    assert "no Isaac Sim found. Set ISAACSIM_PATH" in done.stderr
    assert "pip install 'isaacsim" in done.stderr


def test_a_mere_folder_called_isaacsim_makes_no_python_one_of_isaac_sim(tmp_path: Path) -> None:
    (tmp_path / "isaacsim").mkdir()
    done = subprocess.run(
        [str(LAUNCHER), "run", "x.yaml"],
        cwd=tmp_path,
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "no Isaac Sim found" in done.stderr


def test_a_folder_without_python_sh_is_named(tmp_path: Path) -> None:
    done = launch(tmp_path, "run", "x.yaml", ISAACSIM_PATH=str(tmp_path))
    assert done.returncode == 2
    assert f"ISAACSIM_PATH is {tmp_path}, and there is no python.sh in it" in done.stderr


def test_a_python_sh_that_may_not_be_executed_is_named(tmp_path: Path) -> None:
    put_python(tmp_path / "sim").chmod(0o644)
    done = launch(tmp_path, "run", "x.yaml", ISAACSIM_PATH=str(tmp_path / "sim"))
    assert done.returncode == 2
    assert "python.sh may not be executed: chmod +x it" in done.stderr


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
