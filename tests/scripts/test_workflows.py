"""The workflows are YAML that GitHub would take, and agree with the project."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def read(path: Path) -> dict:
    # YAML 1.1 reads the key `on` as true; BaseLoader keeps every scalar as text.
    return yaml.load(path.read_text(), yaml.BaseLoader)


def test_there_are_workflows_for_tests_wheels_docs_and_release() -> None:
    assert [path.stem for path in WORKFLOWS] == ["docs", "release", "tests", "wheels"]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_has_triggers_least_permissions_and_jobs_that_exist(path: Path) -> None:
    workflow = read(path)
    assert workflow["name"] == path.stem
    assert workflow["on"]
    assert workflow["permissions"] == {"contents": "read"}
    for job in workflow["jobs"].values():
        needs = job.get("needs", [])
        assert ({needs} if isinstance(needs, str) else set(needs)) <= set(workflow["jobs"])
        if "uses" in job:
            assert (ROOT / job["uses"]).is_file()
            continue
        assert job["runs-on"]
        for step in job["steps"]:
            assert ("run" in step) != ("uses" in step)
            if "uses" in step:
                assert re.fullmatch(r"[\w-]+/[\w./-]+@[\w./-]+", step["uses"])
            for target in re.findall(r"^make ([a-z -]+)$", step.get("run", ""), flags=re.MULTILINE):
                assert all(f"\n{name}:" in (ROOT / "Makefile").read_text() for name in target.split())


def test_the_tests_run_what_decides() -> None:
    steps = read(ROOT / ".github/workflows/tests.yml")["jobs"]["ci"]["steps"]
    assert steps[-1]["run"] == ".ci/run"


def test_the_oldest_engine_that_is_tested_is_the_oldest_that_is_declared() -> None:
    (lowest,) = re.findall(r"mujoco>=([\d.]+),", " ".join(PROJECT["project"]["dependencies"]))
    (tested,) = re.findall(r"pip install mujoco==([\d.]+)", (ROOT / ".github/workflows/tests.yml").read_text())
    assert tested in (lowest, f"{lowest}.0")


def test_wheels_are_built_for_3_11_and_for_the_stable_abi_of_3_12() -> None:
    assert PROJECT["tool"]["scikit-build"]["wheel"]["py-api"] == "cp312"
    built = PROJECT["tool"]["cibuildwheel"]["build"]
    assert {name.split("-")[0] for name in built} == {"cp311", "cp312"}
    assert PROJECT["project"]["requires-python"] == ">=3.11"
    runners = read(ROOT / ".github/workflows/wheels.yml")["jobs"]["wheels"]["strategy"]["matrix"]["include"]
    assert [runner["name"] for runner in runners] == ["linux-x86_64", "linux-aarch64", "macos-arm64"]
