"""The Python of the user's ROS: where to look for it, and why it cannot be used."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from trundle.guard.process import last_line

VARIABLE = "TRUNDLE_ROS_PYTHON"
"""Names the Python of ROS where --ros-python does not."""

ADVICE = (
    "Source ROS 2 first (source /opt/ros/<distro>/setup.bash), or name the Python that imports rclpy with "
    f"--ros-python or {VARIABLE}."
)

_TRY = """
import sys
if sys.version_info < (3, 10):
    raise SystemExit("Python %d.%d is too old: 3.10 or later is needed" % sys.version_info[:2])
import rclpy
"""
_TRY_S = 30.0


def candidates(python: str | None = None, environ: Mapping[str, str] | None = None) -> Sequence[str]:
    """Return the Pythons to try, in this order.

    Args:
        python: The user's choice; then it is the only one.
        environ: The environment, `os.environ` by default; TRUNDLE_ROS_PYTHON in it is a choice as well. Otherwise
            every `python3` on its PATH is tried: the first is often that of a virtual environment without ROS.
    """
    source = os.environ if environ is None else environ
    chosen = python or source.get(VARIABLE)
    if chosen:
        return [chosen]
    folders = dict.fromkeys(source.get("PATH", os.defpath).split(os.pathsep))
    paths = [Path(folder) / "python3" for folder in folders if folder]
    return [str(path) for path in paths if os.access(path, os.X_OK)]


def try_python(python: str, environ: Mapping[str, str] | None = None) -> str:
    """Return why a Python cannot import rclpy; "" if it can."""
    try:
        done = subprocess.run(
            [python, "-c", _TRY],
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=_TRY_S,
            env=None if environ is None else dict(environ),
        )
    except subprocess.TimeoutExpired:
        return f"it does not answer within {_TRY_S:.0f} s"
    except OSError as error:
        return str(error.strerror or error)
    if done.returncode == 0:
        return ""
    return last_line(done.stderr) or f"it ends with code {done.returncode}"


def why_not(python: str | None = None, environ: Mapping[str, str] | None = None) -> str:
    """Return why rclpy cannot be used here and what to do about it; "" if it can.

    Args:
        python: The Python to use; otherwise those of `candidates`.
        environ: The environment, `os.environ` by default.
    """
    tried: list[tuple[str, str]] = []
    for candidate in candidates(python, environ):
        reason = try_python(candidate, environ)
        if not reason:
            return ""
        tried.append((candidate, reason))
    return describe(tried)


def describe(tried: Sequence[tuple[str, str]]) -> str:
    """Make the message for Pythons that could not be used, with the reason for each."""
    if not tried:
        return f"no python3 is on PATH. {ADVICE}"
    return f"no Python here imports rclpy ({'; '.join(f'{path}: {reason}' for path, reason in tried)}). {ADVICE}"
