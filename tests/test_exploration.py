"""`conftest.py`: property tests repeat their examples, and `--explore` draws others."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name("conftest.py")
RECORDED = """
from hypothesis import given, settings
from hypothesis import strategies as st

@given(number=st.integers(0, 10**9))
@settings(max_examples=20)
def test_numbers_are_recorded(number):
    with open("numbers", "a") as file:
        print(number, file=file)

def test_that_draws_nothing():
    raise AssertionError
"""
RARE = """
from hypothesis import given
from hypothesis import strategies as st

@given(number=st.integers(0, 1000), fraction=st.floats(0.25, 0.75))
def test_no_number_is_513(number, fraction):
    assert number != 513
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copy(CONFTEST, tmp_path)
    return tmp_path


def run_pytest(folder: Path, test: str, *arguments: str) -> str:
    (folder / "test_it.py").write_text(test)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--rootdir", str(folder), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120).stdout


def examples_in(out: str) -> int:
    found = re.search(r"(\d+) examples, passed: test_it.py::test_numbers_are_recorded", out)
    assert found is not None
    return int(found.group(1))


def numbers_of(folder: Path) -> list[str]:
    numbers = (folder / "numbers").read_text().split()
    (folder / "numbers").unlink()
    return numbers


def test_two_runs_try_the_same_examples(folder: Path) -> None:
    first, second = ((run_pytest(folder, RECORDED), numbers_of(folder))[1] for _ in range(2))
    assert len(first) >= 20
    assert first == second


def test_exploration_runs_only_property_tests_on_other_examples_until_there_are_enough(folder: Path) -> None:
    runs = []
    for _ in range(2):
        out = run_pytest(folder, RECORDED, "--explore", "--explore-examples", "90")
        assert "1 passed, 1 deselected" in out
        runs.append(numbers_of(folder))
        assert examples_in(out) == len(runs[-1]) >= 90
    assert runs[0] != runs[1]


def test_exploration_ends_with_its_time(folder: Path) -> None:
    assert 0 < examples_in(run_pytest(folder, RECORDED, "--explore", "--explore-seconds", "0.1")) < 20_000


def test_a_rare_failure_is_found_with_its_arguments(folder: Path) -> None:
    out = run_pytest(folder, RARE, "--explore", "--explore-examples", "100000")
    assert "1 failed" in out
    assert "number=513" in out
