import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts" / "check_tools.py"


def check(
    *, path: str = os.environ["PATH"], before: str = "", cxx: str | None = None
) -> subprocess.CompletedProcess[str]:
    """Run the script with another PATH and CXX, after some lines that change what the interpreter shows."""
    environment = {key: value for key, value in os.environ.items() if key != "CXX"} | {"PATH": path}
    if cxx is not None:
        environment["CXX"] = cxx
    program = f"{before}\nimport runpy\nrunpy.run_path({str(SCRIPT)!r}, run_name='__main__')"
    return subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)


def test_this_machine_passes() -> None:
    done = check()
    assert (done.returncode, done.stderr) == (0, "")


def test_a_missing_compiler_is_named_with_its_package(tmp_path: Path) -> None:
    done = check(path=str(tmp_path))
    assert done.returncode == 1
    assert "no C++ compiler found (looked for c++, g++, clang++): install g++ (Debian, Ubuntu)" in done.stderr


def test_a_compiler_of_the_user_that_is_not_there_is_named(tmp_path: Path) -> None:
    done = check(cxx="no-such-compiler -m64")
    assert done.returncode == 1
    assert "looked for no-such-compiler" in done.stderr


def test_missing_headers_are_named_with_their_package(tmp_path: Path) -> None:
    done = check(before=f"import sysconfig\nsysconfig.get_path = lambda name: {str(tmp_path)!r}")
    assert done.returncode == 1
    assert f"{tmp_path}/Python.h): install python3-dev (Debian, Ubuntu)" in done.stderr


@pytest.mark.parametrize("module", ["venv", "ensurepip"])
def test_a_missing_venv_is_named_with_its_package(module: str, tmp_path: Path) -> None:
    compiler = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
    assert compiler is not None
    (tmp_path / "c++").symlink_to(compiler)
    hidden = (
        "import importlib.util\n"
        "find = importlib.util.find_spec\n"
        f"importlib.util.find_spec = lambda name: None if name == {module!r} else find(name)"
    )
    done = check(path=str(tmp_path), before=hidden)
    assert done.returncode == 1
    assert "install python3-venv (Debian, Ubuntu)" in done.stderr


def test_an_old_python_gets_advice() -> None:
    done = check(before="import sys\nsys.version_info = (3, 9, 2, 'final', 0)")
    assert done.returncode == 1
    assert "Python 3.9.2 at " in done.stderr
    assert "needs 3.11 or newer. Set PYTHON=" in done.stderr


def test_an_old_python_can_at_least_read_the_script() -> None:
    ast.parse(SCRIPT.read_text(), feature_version=(3, 7))


def test_make_stops_at_what_is_missing(tmp_path: Path) -> None:
    """`make setup` in a copy of the build files says what is missing, and makes no environment."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt", "CMakeLists.txt"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(ROOT / "scripts", tmp_path / "scripts")
    done = subprocess.run(
        ["make", "setup", f"PYTHON={sys.executable}"],
        cwd=tmp_path,
        env={**os.environ, "CXX": "no-such-compiler"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "no C++ compiler found (looked for no-such-compiler)" in done.stderr
    assert not (tmp_path / ".venv").exists()
