"""The Python of the user's ROS: chosen, or looked for on PATH, and why each cannot be used."""

import sys
from pathlib import Path

import pytest

from trundle.ros2.transport.rclpy import find


def write_python(folder: Path, text: str) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "python3"
    path.write_text(text)
    path.chmod(0o755)
    return str(path)


def test_a_choice_is_the_only_candidate(tmp_path: Path) -> None:
    environ = {"PATH": str(tmp_path), find.VARIABLE: "/ros/python3"}
    write_python(tmp_path, "")
    assert list(find.candidates("/my/python3", environ)) == ["/my/python3"]
    assert list(find.candidates(None, environ)) == ["/ros/python3"]


def test_every_python3_on_path_is_a_candidate(tmp_path: Path) -> None:
    first, second = write_python(tmp_path / "venv", ""), write_python(tmp_path / "usr", "")
    path = ":".join([str(tmp_path / "venv"), str(tmp_path / "none"), str(tmp_path / "usr"), str(tmp_path / "venv")])
    assert list(find.candidates(None, {"PATH": path})) == [first, second]


def test_the_reason_of_each_is_reported_with_what_to_do(tmp_path: Path) -> None:
    failing = "#!/bin/sh\necho 'Traceback' >&2\necho 'ImportError: librcl.so: cannot open shared object' >&2\nexit 1\n"
    broken = write_python(tmp_path / "shim", failing)
    silent = write_python(tmp_path / "silent", "#!/bin/sh\nexit 3\n")
    reason = find.why_not(None, {"PATH": f"{tmp_path / 'shim'}:{tmp_path / 'silent'}"})
    assert f"{broken}: ImportError: librcl.so: cannot open shared object; {silent}: it ends with code 3" in reason
    assert "source /opt/ros/<distro>/setup.bash" in reason
    assert "--ros-python" in reason
    assert "no python3 is on PATH" in find.why_not(None, {"PATH": str(tmp_path)})
    assert "No such file" in find.why_not(str(tmp_path / "gone"))


def test_one_that_imports_rclpy_can_be_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rclpy.py").write_text("")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert find.why_not(sys.executable) == ""
