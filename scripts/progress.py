"""Run one step of a set-up and show how far it is: `progress.py TITLE [--objects FOLDER --of N] -- COMMAND…`.

On a terminal that is one line that moves on; elsewhere a plain line at the start, every ten seconds and at the end.
Runs with the system's Python and its standard library alone, before anything is installed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from pathlib import Path

_PLAIN_S, _TERMINAL_S = 10.0, 0.2
_BLANK = " " * 8


def compiled(folder: Path, since: float) -> int:
    """How many object files of the kernels under a folder are newer than a time."""
    objects = folder.glob("**/_kernels.dir/**/*.o")
    return sum(path.stat().st_mtime >= since for path in objects)


def describe(folder: Path | None, total: int, begin: float) -> str:
    """How long a step has run, and how many files it has compiled."""
    elapsed = f"{time.time() - begin:.0f} s"
    if folder is None:
        return elapsed
    return f"{compiled(folder, begin)} of {total} files, {elapsed}"


def run(title: str, command: list[str], folder: Path | None, total: int) -> int:
    """Run the command; return its exit status."""
    terminal = sys.stdout.isatty()
    begin = time.time()
    print(title, end="" if terminal else "\n", flush=True)
    process = subprocess.Popen(command)
    while True:
        try:
            status = process.wait(_TERMINAL_S if terminal else _PLAIN_S)
        except subprocess.TimeoutExpired:
            state = f"{title}: {describe(folder, total, begin)}"
            print(f"\r{state}{_BLANK}" if terminal else state, end="" if terminal else "\n", flush=True)
            continue
        end = f"{title}: {'done' if status == 0 else 'failed'} in {time.time() - begin:.0f} s"
        print(f"\r{end}{_BLANK * 3}" if terminal else end, flush=True)
        return status


def main() -> int:
    """Read the command line and run what it says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("title")
    parser.add_argument("--objects", type=Path, help="folder that the kernels are built in")
    parser.add_argument("--of", type=int, default=0, help="how many files there are to compile")
    parser.add_argument("command", nargs="+")
    options = parser.parse_args()
    return run(options.title, options.command, options.objects, options.of)


if __name__ == "__main__":
    sys.exit(main())
