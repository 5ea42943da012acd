import re
import subprocess
import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def lines(name: str) -> list[str]:
    return [line for line in (ROOT / name).read_text().splitlines() if line and not line.startswith("#")]


def test_constraints_are_those_of_the_project() -> None:
    assert lines("constraints.txt") == PROJECT["tool"]["uv"]["constraint-dependencies"]


def test_the_engine_is_declared_as_a_range_that_has_its_pin() -> None:
    (declared,) = (line for line in PROJECT["project"]["dependencies"] if line.startswith("mujoco"))
    requirement = Requirement(declared)
    assert {part.operator for part in requirement.specifier} == {">=", "<"}
    pins = {pin.name: pin.specifier for pin in map(Requirement, lines("constraints.txt"))}
    (version,) = (part.version for part in pins["mujoco"])
    assert requirement.specifier.contains(version)
    assert pins["mujoco-core"] == pins["mujoco"]


def test_no_requirement_names_a_place_to_load_from() -> None:
    assert not (ROOT / "uv.lock").exists() or "uv.lock" in (ROOT / ".gitignore").read_text()
    for name in ("constraints.txt", "pyproject.toml", "Makefile"):
        assert not re.search(r"https?://|index-url|find-links|file:", (ROOT / name).read_text()), name


def test_development_requirements_are_those_of_the_project() -> None:
    done = subprocess.run(
        [sys.executable, str(ROOT / "scripts" / "requirements.py"), "dev"], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [item.replace(" ", "") for item in PROJECT["dependency-groups"]["dev"]]


def test_the_doctors_line_installs_the_engine_that_is_pinned() -> None:
    assert f"pip install {lines('constraints.txt')[0]}" in (ROOT / "src/trundle/doctor/machine.py").read_text()


def test_the_readme_installs_from_its_folder_with_extras_that_there_are() -> None:
    (extras,) = re.findall(r'^pip install "\.\[([a-z,]+)\]"', (ROOT / "README.md").read_text(), flags=re.MULTILINE)
    assert set(extras.split(",")) <= set(PROJECT["project"]["optional-dependencies"])
