"""Into two Pythons that stand in for Isaac Sim's, trundle goes without changing what is there, and drives there.

They hold the packages that Isaac Sim pins. Its application and its own USD are the stand-in's: the latter comes from a
folder beside, as Kit's does.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

from support.command_line import room
from support.pythons import find_python

ROOT = Path(__file__).parents[3]
TESTS = ROOT / "tests"
PINS = {
    "3.11": (5, ["numpy==1.26.0"]),
    "3.12": (
        6,
        ["numpy==2.3.1", "scipy==1.17.0", "pillow<13", "trimesh==4.11.1", "mujoco==3.12.0", "websockets<15"],
    ),
}


def run(*command: str | Path, **environment: str) -> str:
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("version", PINS)
def test_it_is_added_and_a_mission_arrives(version: str, assets: Path, tmp_path: Path) -> None:
    interpreter = find_python(version)
    if interpreter is None:
        pytest.skip(f"no Python {version} on this machine")
    generation, pins = PINS[version]
    run(interpreter, "-m", "venv", tmp_path / "sim")
    python = tmp_path / "sim" / "bin" / "python"
    launcher = tmp_path / "sim" / "python.sh"
    launcher.write_text(f'#!/bin/sh\nexec "{python}" "$@"\n')
    launcher.chmod(0o755)
    pip = [python, "-m", "pip", "--disable-pip-version-check"]
    run(*pip, "install", "--quiet", "--only-binary", ":all:", *pins)
    before = set(run(*pip, "freeze").splitlines())

    run(ROOT / "isaac.sh", "install", ISAACSIM_PATH=str(tmp_path / "sim"))

    after = set(run(*pip, "freeze").splitlines())
    assert before < after, before - after
    added = {line.partition("==")[0].partition(" @")[0].lower() for line in after - before}
    assert "trundle" in added
    assert not added & {"mujoco", "mujoco-core", "usd-core", "viser", "scipy", "numpy", "trimesh"}

    run(*pip, "install", "--quiet", "--no-deps", "--target", tmp_path / "kit", "usd-core")
    room().save(tmp_path / "room.yaml")
    report = run(
        launcher, "-m", "support.fake_isaac", str(generation), assets, tmp_path / "kit",
        "run", tmp_path / "room.yaml", "--start", "0,0,0", "--goal", "5,2",
        "--backend", "isaac", "--headless", "--no-video", "--out", tmp_path / "run", "--json",
        PYTHONPATH=str(TESTS),
    )  # fmt: skip
    assert json.loads(report)["outcome"] == "arrived"
