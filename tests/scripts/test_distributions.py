"""What is published: an sdist of what git tracks, and wheels that run where there is nothing else."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from support.pythons import find_python

ROOT = Path(__file__).parents[2]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")


def tracked_files() -> list[str]:
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of what git tracks, with what it ignores beside it."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("this is no checkout")
    folder = tmp_path_factory.mktemp("sources")
    for name in tracked_files():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)
    for ignored in ("runs/1/episode.json", "build/x.o", "site/index.html", "src/trundle/__pycache__/a.pyc"):
        (folder / ignored).parent.mkdir(parents=True, exist_ok=True)
        (folder / ignored).write_text("")
    return folder


def test_an_sdist_holds_what_git_tracks(sources: Path, tmp_path: Path) -> None:
    code = f"from scikit_build_core.build import build_sdist; print(build_sdist({str(tmp_path)!r}))"
    done = subprocess.run([sys.executable, "-c", code], cwd=sources, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (archive,) = tmp_path.glob("trundle-*.tar.gz")
    with tarfile.open(archive) as tar:
        held = {name.split("/", 1)[1] for name in tar.getnames()}
    assert held - {"PKG-INFO"} == set(tracked_files())


@pytest.fixture(scope="module")
def wheels(sources: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Wheels for 3.11 and of the stable ABI, of those that a Python here can build."""
    folder = tmp_path_factory.mktemp("wheels")
    for version in PYTHONS[:2]:
        if (python := find_python(version)) is not None:
            builder = tmp_path_factory.mktemp("builder")  # an environment that uv made has no pip
            subprocess.run([python, "-m", "venv", str(builder)], check=True)
            pip = [str(builder / "bin/python"), "-m", "pip"]
            subprocess.run([*pip, "wheel", "-q", "--no-deps", "-w", str(folder), str(sources)], check=True)
    return folder


@pytest.mark.slow
@pytest.mark.wheel
@pytest.mark.parametrize("version", PYTHONS)
def test_a_wheel_runs_the_demo_in_an_empty_environment(wheels: Path, version: str, tmp_path: Path) -> None:
    python = find_python(version)
    if python is None:
        pytest.skip(f"there is no Python {version} here")
    tag = "cp311-cp311" if version == "3.11" else "cp312-abi3"
    (wheel,) = wheels.glob(f"*-{tag}-*.whl")
    subprocess.run([python, "-m", "venv", str(tmp_path / "venv")], check=True)
    install = [str(tmp_path / "venv/bin/python"), "-m", "pip", "install", "--quiet", str(wheel)]
    subprocess.run([*install, "-c", str(ROOT / "constraints.txt")], check=True)
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    demo = [str(tmp_path / "venv/bin/trundle"), "demo", "--no-video", "--json", "--out", "demo"]
    done = subprocess.run(demo, cwd=tmp_path, env=kept, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["outcome"] == "arrived"
