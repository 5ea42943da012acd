"""`python -m trundle.testing.isaac SCRIPT [--seconds N] [ARGUMENT …]`: run a script for Isaac Sim, unmodified."""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from trundle.testing.isaac import environment

_DESCRIPTION = """Run a script for Isaac Sim, unmodified, without Isaac Sim: NVIDIA's own 6.2 Python classes and PhysX
on the CPU, in a Python 3.12 that --build puts into the user's cache. Nothing is rendered. Other arguments are the
script's; so is everything after `--`."""


def main(arguments: Sequence[str]) -> int:
    """Run what the command line says; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m trundle.testing.isaac", description=_DESCRIPTION, allow_abbrev=False, add_help=False
    )
    parser.add_argument("-h", "--help", action="help", help="show this, and end")
    parser.add_argument("script", nargs="?", metavar="SCRIPT", help="a Python file")
    parser.add_argument("-m", dest="module", metavar="MODULE", help="run a module instead, such as trundle")
    parser.add_argument(
        "--seconds", type=_positive, default=120.0, metavar="N",
        help="is_running() is false after N simulated seconds (120)",
    )  # fmt: skip
    parser.add_argument(
        "--timeout", type=_positive, default=900.0, metavar="N", help="end the script after N seconds (900)"
    )
    parser.add_argument(
        "--api", type=int, choices=(5, 6), default=6, help="5: leave out the classes that Isaac Sim 5.1 lacks"
    )
    parser.add_argument("--assets", type=Path, metavar="FOLDER", help="asset root; default: trundle's own assets")
    parser.add_argument("--build", action="store_true", help="build the environment, if it is not there")
    own, rest = _split(parser, arguments)
    if own.build:
        return _build()
    if own.module:
        target = ["-m", own.module, *([own.script] if own.script else []), *rest]
    elif own.script:
        target = [own.script, *rest]
        if not Path(own.script).is_file():
            return _fail(f"{own.script}: no such file; give a Python script")
    else:
        parser.error("give a SCRIPT, or --build")
    if own.assets is not None and not (own.assets / "Isaac").is_dir():
        return _fail(f"--assets {own.assets}: it has no subfolder Isaac; give the folder that contains Isaac/Robots")
    try:
        found = environment.find()
    except environment.UnavailableError as error:
        return _fail(f"there is no Python with NVIDIA's packages: {error}")
    assets = str((own.assets or found.assets).resolve())
    command = found.command("inside.py", str(own.seconds), str(own.api), assets, *target)
    variables = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONHOME")}
    process = subprocess.Popen(command, env=variables)
    try:
        return _status(process.wait(timeout=own.timeout))
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return _fail(f"{target[0]} did not end within {own.timeout:g} s, and was ended (--timeout)", 124)
    except KeyboardInterrupt:
        # The script has been interrupted as well, and may have something to write.
        try:
            return _status(process.wait(timeout=30.0))
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            process.kill()
            return 130


def _split(parser: argparse.ArgumentParser, arguments: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """Split the runner's own options from the script's; `--` ends the runner's."""
    given = list(arguments)
    end = given.index("--") if "--" in given else len(given)
    own, rest = parser.parse_known_args(given[:end])
    return own, [*rest, *given[end + 1 :]]


def _build() -> int:
    try:
        found = environment.build()
    except environment.UnavailableError as error:
        return _fail(f"no Python with NVIDIA's packages: {error}", 1)
    print(found.python)
    return 0


def _positive(text: str) -> float:
    value = float(text)
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(text)
    return value


def _status(code: int) -> int:
    return code if code >= 0 else 128 - code


def _fail(message: str, status: int = 2) -> int:
    print(f"trundle.testing.isaac: {message}", file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
