"""The seams between packages say everything: no capability goes by a name that no protocol has."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SIZE = runpy.run_path(str(ROOT / "scripts" / "size.py"))
FILES = [SIZE["read"](path) for package in SIZE["SEAMS"] for path in sorted((SIZE["SOURCE"] / package).rglob("*.py"))]


def test_all_packages_with_a_seam_are_read() -> None:
    assert {file.package for file in FILES} == {"mission", "navigation", "sim", "control"}


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.path.relative_to(SIZE["SOURCE"])))
def test_no_capability_goes_by_its_name_or_by_the_class_navigator(file) -> None:
    assert file.names_in_text == 0, "getattr or hasattr with a literal name: make it a member with a default"
    assert file.checks_for_navigator == 0, "isinstance(…, Navigator): make what is needed a member of Agent"


@pytest.mark.parametrize("folder", ["src/trundle", "tests"])
def test_no_file_is_longer_than_a_reader_takes_in_at_once(folder) -> None:
    lines = {path: path.read_text(encoding="utf-8").count("\n") for path in (ROOT / folder).rglob("*.py")}
    long = {str(path.relative_to(ROOT)) for path, count in lines.items() if count > SIZE["LONG_FILE"]}
    assert long <= {"src/trundle/ros2/transport/rclpy/child.py"}  # it runs in the user's ROS, without trundle


def test_the_root_of_the_package_has_at_most_ten_modules() -> None:
    assert len(list(SIZE["SOURCE"].glob("*.py"))) <= 10
