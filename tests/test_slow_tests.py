"""The tests marked slow run in parts, which together are all of them."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CASES = """
import pytest

@pytest.mark.slow
@pytest.mark.parametrize("case", range(7))
def test_slow(case): pass

@pytest.mark.parametrize("case", range(2))
def test_fast(case): pass
"""
SETTINGS = "[pytest]\nmarkers = slow: many seconds\naddopts = --strict-markers\n"


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    shutil.copy(Path(__file__).with_name("conftest.py"), tmp_path)
    (tmp_path / "pytest.ini").write_text(SETTINGS)
    (tmp_path / "test_cases.py").write_text(CASES)
    return tmp_path


def run(suite: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-vv", "-p", "no:cacheprovider", *options]
    return subprocess.run(command, cwd=suite, capture_output=True, text=True, check=False)


def passed(suite: Path, *options: str) -> set[str]:
    done = run(suite, *options)
    assert done.returncode == 0, done.stdout + done.stderr
    return {word for line in done.stdout.splitlines() if "PASSED" in line for word in line.split() if "::" in word}


def test_all_run_without_the_option(suite: Path) -> None:
    assert len(passed(suite)) == 9


def test_parts_together_are_all_slow_tests_and_each_has_all_others(suite: Path) -> None:
    parts = [passed(suite, "--slow", f"{number}/3") for number in (1, 2, 3)]
    slow = [{name for name in part if "slow" in name} for part in parts]
    assert sorted(map(len, slow)) == [2, 2, 3]
    assert len(set.union(*slow)) == 7
    assert [len(part - chosen) for part, chosen in zip(parts, slow, strict=True)] == [2, 2, 2]


def test_the_processes_agree_on_todays_part_and_it_is_named(suite: Path) -> None:
    done = run(suite, "--slow", "today/3", "-n", "2")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "make test-slow runs all" in done.stdout
    assert any(f"slow tests: part {number} of 3 (--slow {number}/3)" in done.stdout for number in (1, 2, 3))


@pytest.mark.parametrize("part", ["tomorrow/3", "4/3", "1/0"])
def test_a_part_that_there_is_not_is_refused(suite: Path, part: str) -> None:
    done = run(suite, "--slow", part)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert f"--slow {part}: " in done.stdout + done.stderr
