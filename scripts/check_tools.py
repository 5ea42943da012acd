"""Check that this machine can build and run trundle; name the package that brings what is missing.

Runs with the system's Python and its standard library alone, before anything is installed.
"""

# So that a Python that is too old reaches the check of its version.
from __future__ import annotations

import importlib.util
import os
import shutil
import sys
import sysconfig


def missing_tools() -> list[str]:
    """One line for each thing that is missing."""
    problems = []
    if sys.version_info < (3, 11):
        found = ".".join(map(str, sys.version_info[:3]))
        problems.append(
            f"Python {found} at {sys.executable} is too old: trundle needs 3.11 or newer. "
            "Set PYTHON=/path/to/python3.11 when you call make."
        )
    elif shutil.which("uv") is None and any(importlib.util.find_spec(name) is None for name in ("venv", "ensurepip")):
        problems.append("Python's venv module is missing: install python3-venv (Debian, Ubuntu).")
    return problems + missing_build_tools()


def missing_build_tools() -> list[str]:
    """One line for each thing that is missing to compile the kernels."""
    problems = []
    include = sysconfig.get_path("include")
    if not os.path.exists(os.path.join(include, "Python.h")):
        problems.append(
            f"Python's headers are missing ({include}/Python.h): install python3-dev (Debian, Ubuntu) "
            "or python3-devel (Fedora)."
        )
    compilers = [os.environ["CXX"].split()[0]] if os.environ.get("CXX") else ["c++", "g++", "clang++"]
    if not any(shutil.which(name) for name in compilers):
        problems.append(
            f"no C++ compiler found (looked for {', '.join(compilers)}): install g++ (Debian, Ubuntu), "
            "gcc-c++ (Fedora) or Xcode's command line tools (macOS)."
        )
    return problems


if __name__ == "__main__":
    found = missing_tools()
    for problem in found:
        print(f"trundle cannot be set up here: {problem}", file=sys.stderr)
    sys.exit(1 if found else 0)
