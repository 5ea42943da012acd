"""Every extra, missing: what needs it ends in one message with the line that installs it, and no traceback."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from trundle import extras
from trundle.extras import EXTRAS, install_line

ROOT = Path(__file__).parents[2]

HIDE = """
import os, sys

sys.modules.update(dict.fromkeys(os.environ["HIDDEN"].split(",")))
"""


@pytest.fixture
def without(tmp_path: Path):
    """Run Python without some modules, in its child processes as well."""
    (tmp_path / "hide").mkdir()
    (tmp_path / "hide" / "sitecustomize.py").write_text(HIDE)
    (tmp_path / "a.glb").write_bytes(b"glTF")
    (tmp_path / "a.usda").write_text("#usda 1.0")

    def run(modules: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join([str(tmp_path / "hide"), *filter(None, [os.environ.get("PYTHONPATH")])])
        settings = {**os.environ, "HIDDEN": modules, "PYTHONPATH": path}
        command = [sys.executable, *arguments]
        return subprocess.run(
            command, capture_output=True, text=True, env=settings, cwd=tmp_path, timeout=200, check=False
        )

    return run


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "extra", "command"),
    [
        ("zstandard", "record", "run office --record"),
        ("mcap", "record", "drive nova_carter --command 1,0,1 --record"),
        ("zstandard", "record", "record to-run run.mcap"),
        ("zstandard", "record", "record recover run.mcap"),
        ("rosbags", "record", "record info run.mcap"),
        ("rosbags", "ros2", "ros2 serve office"),
        ("cyclonedds", "ros2", "ros2 serve office --transport dds"),
        ("trimesh", "mesh", "map build a.glb"),
        ("trimesh", "mesh", "export office --to glb -o b.glb"),
        ("pxr", "usd", "map build a.usda"),
        ("pxr", "usd", "export office --to usd -o b.usda"),
        ("ovphysx", "physx", "run office --backend physx"),
        ("ray", "ray", "evaluate office --seeds 1 --ray auto"),
    ],
)
def test_a_missing_extra_is_one_line(without, tmp_path, monkeypatch, hidden, extra, command):
    if hidden == "cyclonedds" and extras.lacks_wheels():
        pytest.skip("Cyclone DDS has no wheel here")
    if hidden == "ovphysx" and not extras.is_offered(hidden):
        pytest.skip("PhysX has no wheel here")
    done = without(hidden, "-m", "trundle", *command.split())
    monkeypatch.chdir(tmp_path)
    assert "Traceback" not in done.stderr
    assert done.returncode == 2, done.stderr
    assert install_line(extra) in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "extra", "code"),
    [
        ("pandas", "pandas", "trundle.mission.trajectory.Trajectory.to_pandas(None)"),
        ("duckdb", "evaluate", "from trundle.evaluation.store import parts; parts.connect('asking in SQL')"),
        ("zstandard", "record", "from trundle.bags import read_info"),
    ],
)
def test_python_gets_the_same_error(without, tmp_path, monkeypatch, hidden, extra, code):
    program = f"import trundle, trundle.mission.trajectory\ntry:\n    {code}\n"
    program += "except trundle.errors.MissingExtraError as error:\n    print(error)"
    done = without(hidden, "-c", program)
    monkeypatch.chdir(tmp_path)
    assert install_line(extra) in done.stdout, done.stderr


def test_the_table_of_extras_is_that_of_the_project():
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    plain = {extra: {re.split("[>=;]", one)[0].strip() for one in libraries} for extra, libraries in listed.items()}
    assert {extra: set(has.modules) for extra, has in EXTRAS.items()} == plain


@pytest.mark.parametrize(
    ("url", "what"),
    [
        ({}, '"trundle[record]"'),
        ({"url": "file:///gone/trundle", "dir_info": {}}, '"trundle[record]"'),
        (
            {"url": "https://example.org/trundle.git", "vcs_info": {"vcs": "git"}},
            '"trundle[record] @ git+https://example.org/trundle.git"',
        ),
    ],
)
def test_the_line_is_worded_for_how_trundle_was_installed(monkeypatch, tmp_path, url, what):
    monkeypatch.setattr(extras, "__file__", str(tmp_path / "site-packages" / "trundle" / "extras.py"))
    monkeypatch.setattr(extras, "_direct_url", lambda: url)
    assert install_line("record").endswith(f"install {what}")


def test_in_a_checkout_the_line_names_it(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)
    monkeypatch.chdir(ROOT)
    assert install_line("record") == 'pip install ".[record]"'
    monkeypatch.chdir(tmp_path)
    assert install_line("record") == f'pip install "{ROOT}[record]"'
