"""Installing into a Python that stands in for Isaac Sim's: nothing that is there may change."""

import base64
import hashlib
import importlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from support.pythons import find_python

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts" / "isaac_install.py"


def make_wheel(folder: Path, name: str, version: str, *requires: str) -> Path:
    """A wheel of an empty module."""
    module = name.replace("-", "_")
    files = {
        f"{module}/__init__.py": f"__version__ = {version!r}\n",
        f"{module}-{version}.dist-info/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
        + "".join(f"Requires-Dist: {line}\n" for line in requires),
        f"{module}-{version}.dist-info/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = f"{module}-{version}.dist-info/RECORD"
    lines = [
        f"{path},sha256={base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b'=').decode()},"
        for path, text in files.items()
    ]
    files[record] = "\n".join([*lines, f"{record},,"]) + "\n"
    wheel = folder / f"{module}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for path, text in files.items():
            archive.writestr(path, text)
    return wheel


@pytest.fixture(scope="module")
def empty_python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("python") / "venv"
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    return folder


class StandIn:
    """A Python with its own pip and no index but a folder of wheels."""

    def __init__(self, template: Path, folder: Path) -> None:
        self.shelf = folder / "wheels"
        self.shelf.mkdir()
        shutil.copytree(template, folder / "venv", symlinks=True)
        self.python = folder / "venv" / "bin" / "python"

    def environment(self) -> dict[str, str]:
        kept = {key: value for key, value in os.environ.items() if not key.startswith("PIP_")}
        return kept | {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(self.shelf), "PYTHONDONTWRITEBYTECODE": "1"}

    def pip(self, *arguments: str) -> str:
        command = [str(self.python), "-m", "pip", *arguments]
        return subprocess.run(command, env=self.environment(), check=True, capture_output=True, text=True).stdout

    def freeze(self) -> set[str]:
        return set(self.pip("freeze").split())

    def install(self, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
        command = [str(self.python), str(SCRIPT), *arguments]
        return subprocess.run(
            command, env=self.environment() | environment, check=False, capture_output=True, text=True
        )


@pytest.fixture
def isaac(empty_python: Path, tmp_path: Path) -> StandIn:
    stand_in = StandIn(empty_python, tmp_path)
    for name, version in (("numpy", "1.26.0"), ("pillow", "10.2.0"), ("numpy", "2.4.0")):
        make_wheel(stand_in.shelf, name, version)
    make_wheel(stand_in.shelf, "rich", "14.0")
    make_wheel(stand_in.shelf, "mujoco", "4.0.0")
    make_wheel(stand_in.shelf, "usd-core", "26.5")
    stand_in.pip("install", "--quiet", "numpy==1.26.0", "pillow==10.2.0")
    return stand_in


def test_only_what_is_missing_and_light_is_added(isaac: StandIn, tmp_path: Path) -> None:
    wheel = make_wheel(
        tmp_path, "trundle", "0.1.0", "numpy>=1.26", "rich>=13", "mujoco==4.0.0", 'usd-core; extra == "usd"'
    )
    before = isaac.freeze()
    # Where somebody has pip install elsewhere by default, other Pythons would share what is for Isaac Sim.
    done = isaac.install(str(wheel), PIP_USER="1", PIP_TARGET=str(tmp_path / "elsewhere"))
    assert (done.returncode, done.stderr) == (0, "")
    added = isaac.freeze() - before
    assert before <= isaac.freeze()
    assert {line.split("=")[0].split(" ")[0] for line in added if line} >= {"rich", "trundle"}
    assert not any(line.startswith(("mujoco", "usd")) for line in added)


def test_an_installed_package_that_would_change_is_refused(isaac: StandIn, tmp_path: Path) -> None:
    wheel = make_wheel(tmp_path, "trundle", "0.1.0", "numpy>=2", "rich>=13")
    before = isaac.freeze()
    done = isaac.install(str(wheel))
    assert done.returncode == 2
    assert "trundle was not installed: nothing was changed" in done.stderr
    assert "numpy" in done.stderr
    assert isaac.freeze() == before


def test_a_dependency_that_brings_usd_core_is_refused(isaac: StandIn, tmp_path: Path) -> None:
    make_wheel(isaac.shelf, "sneaky", "1.0", "usd-core")
    wheel = make_wheel(tmp_path, "trundle", "0.1.0", "sneaky")
    before = isaac.freeze()
    done = isaac.install(str(wheel))
    assert done.returncode == 2
    assert "it would bring usd-core" in done.stderr
    assert isaac.freeze() == before


def test_a_dependency_that_cannot_be_had_changes_nothing(isaac: StandIn, tmp_path: Path) -> None:
    wheel = make_wheel(tmp_path, "trundle", "0.1.0", "rich>=13", "not-to-be-had")
    before = isaac.freeze()
    done = isaac.install(str(wheel))
    assert done.returncode == 2
    assert "not-to-be-had" in done.stderr
    assert isaac.freeze() == before


def test_it_is_installed_again_only_when_the_version_differs(isaac: StandIn, tmp_path: Path) -> None:
    source = tmp_path / "source"
    (source / "src").mkdir(parents=True)
    module = source / "src" / "module.py"
    module.write_text("")
    (source / "pyproject.toml").write_text('[project]\nname = "trundle"\nversion = "0.1.0"\n')
    assert isaac.install(str(make_wheel(tmp_path, "trundle", "0.1.0"))).returncode == 0
    done = isaac.install("--if-missing", str(source))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    ahead = 2.0 * module.stat().st_mtime
    os.utime(module, (ahead, ahead))
    done = isaac.install("--if-missing", str(source))
    assert (done.returncode, done.stdout) == (0, "")
    assert "the sources changed since trundle was installed: ./isaac.sh install takes them over" in done.stderr
    (source / "pyproject.toml").write_text('[project]\nname = "trundle"\nversion = "0.2.0"\n')
    done = isaac.install("--if-missing", str(source))
    assert (done.returncode, done.stdout) == (2, "building trundle's kernels for this Python (about a minute)\n")


def test_a_folder_that_cannot_be_written_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.syspath_prepend(SCRIPT.parent)
    isaac_install = importlib.import_module("isaac_install")
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(isaac_install.InstallError, match=r"nothing was changed: .* cannot be written"):
        isaac_install.install(tmp_path / "trundle-0.1.0-py3-none-any.whl")


@pytest.mark.parametrize("version", ["3.8", "3.10"])
def test_the_python_of_an_older_isaac_sim_is_refused_with_a_reason(version: str) -> None:
    python = find_python(version)
    if python is None:
        pytest.skip(f"no Python {version} on this machine")
    done = subprocess.run([python, str(SCRIPT), "."], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert f"is Python {version}." in done.stderr
    assert "trundle needs 3.11 or newer: Isaac Sim 5.1 or newer" in done.stderr


def test_a_wheel_that_cannot_be_used_changes_nothing(isaac: StandIn, tmp_path: Path) -> None:
    other_python = make_wheel(tmp_path, "trundle", "0.1.0", "rich>=13").rename(
        tmp_path / "trundle-0.1.0-cp399-cp399-any.whl"
    )
    no_wheel = tmp_path / "trundle-0.1.0-py3-none-any.whl"
    no_wheel.write_text("not a wheel")
    newer = make_wheel(isaac.shelf, "numpy", "2.5.0")
    before = isaac.freeze()
    for wheel, said in (
        (other_python, "not a supported wheel"),
        (no_wheel, "invalid"),
        (newer, "is a wheel of numpy: give one of trundle"),
    ):
        done = isaac.install(str(wheel))
        assert done.returncode == 2
        assert "nothing was changed" in done.stderr
        assert said in done.stderr
    assert isaac.freeze() == before


@pytest.mark.parametrize("source", ["no-such.whl", "no-such-folder"])
def test_a_source_that_is_not_there_is_named(isaac: StandIn, source: str) -> None:
    done = isaac.install(source)
    assert done.returncode == 2
    assert source in done.stderr


def test_a_python_without_pip_gets_advice_on_installing_it(isaac: StandIn) -> None:
    shutil.rmtree(next((isaac.python.parents[1] / "lib").glob("python*/site-packages/pip")))
    done = isaac.install("x.whl")
    assert done.returncode == 2
    assert "has no pip. Add it with:" in done.stderr
