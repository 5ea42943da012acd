"""Fuzz everything that loads files: a mutated file ends in a success or a TrundleError, nothing else.

    PYTHONPATH=tests python -m fuzz.fuzz_loaders                             200 files of each format
    PYTHONPATH=tests python -m fuzz.fuzz_loaders --count 5000 --jobs 16      what a release is checked with
    PYTHONPATH=tests python -m fuzz.fuzz_loaders --count 300 --cli --jobs 16 by the command line
    PYTHONPATH=tests python -m fuzz.fuzz_loaders usd sdf --seed 3 --seconds 600

Foreign files are read as users read them, by the guarded child; one child stays for many files. A finding does not end
it: its file is kept in --keep, and at the end each kind of finding is printed once, with the files that show it. A file
that takes more than ten seconds or two gigabytes is a finding too, and so is one at which the process crashes or that
takes it a minute: another process goes on with the next file.
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import faulthandler
import logging
import multiprocessing
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from fuzz.loaders import LOADERS, PREFIX, Reader

LONGEST = 60.0
"""A file that takes longer [s] ends the process that reads it."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A file that ended in something else than a success or a TrundleError.

    Attributes:
        form: Of the file.
        number: Of the file.
        text: The traceback, or what happened.
    """

    form: str
    number: int
    text: str

    @property
    def place(self) -> tuple[str, ...]:
        """The format and the innermost frames, which tell one fault from another."""
        frames = re.findall(r'File "(.*?)", line (\d+), in (.*)', self.text)[-3:]
        return (self.form, *(":".join(frame) for frame in frames)) if frames else (self.form, self.text)


def play(
    form: str,
    numbers: range,
    seed: int,
    until: float,
    keep: str | None = None,
    progress: str | None = None,
    *,
    cli: bool = False,
) -> tuple[collections.Counter[str], list[Finding]]:
    """Read some files of a format; return how they ended, and the findings.

    Args:
        form: The format.
        numbers: Of the files.
        seed: Of the files.
        until: When to end, by time.monotonic() [s].
        keep: A folder for files that were found.
        progress: A file that gets the number of each file before it is read; this process is then a separate one
            that ends where a file takes too long and prints nothing of what trundle logs.
        cli: Whether to read them by the command line.
    """
    if progress is not None:
        logging.getLogger("trundle").addHandler(logging.NullHandler())
        logging.getLogger("trundle").propagate = False
    ends: collections.Counter[str] = collections.Counter()
    findings: list[Finding] = []
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader(Path(folder), form, cli=cli)
        try:
            for number in numbers:
                if time.monotonic() > until:
                    break
                if progress is not None:
                    Path(progress).write_text(str(number))
                    faulthandler.dump_traceback_later(LONGEST, exit=True)
                ended, file = reader.read(number, seed)
                if ended not in ("read", "refused"):
                    findings.append(Finding(form, number, ended))
                    if keep is not None:
                        Path(keep).mkdir(parents=True, exist_ok=True)
                        shutil.copy(file, Path(keep) / f"{form}-{seed}-{number}-{file.name.removeprefix(PREFIX)}")
                    ended = "found"
                ends[ended] += 1
        finally:
            reader.close()
            faulthandler.cancel_dump_traceback_later()
    return ends, findings


def play_apart(
    form: str, numbers: range, seed: int, until: float, keep: str | None, *, read: Callable[..., Any] = play
) -> tuple[collections.Counter[str], list[Finding]]:
    """As `play`, in a separate process; where that ends early, the file is a finding and the next file follows."""
    ends: collections.Counter[str] = collections.Counter()
    findings: list[Finding] = []
    with tempfile.TemporaryDirectory() as folder:
        progress = Path(folder) / "number"
        while numbers:
            try:
                with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                    ended, found = pool.submit(read, form, numbers, seed, until, keep, str(progress)).result()
                return ends + ended, findings + found
            except BrokenProcessPool:
                number = int(progress.read_text())
                ends["found"] += 1
                findings.append(Finding(form, number, f"the process crashed, or took longer than {LONGEST:g} s"))
                numbers = range(number + numbers.step, numbers.stop, numbers.step)
    return ends, findings


def report(findings: list[Finding], seed: int) -> list[str]:
    """Each kind of finding once, with its files."""
    kinds: dict[tuple[str, ...], list[Finding]] = {}
    for finding in sorted(findings, key=lambda finding: (finding.form, finding.number)):
        kinds.setdefault(finding.place, []).append(finding)
    return [
        f"{same[0].form} --seed {seed}, {len(same)} files: "
        + ", ".join(str(finding.number) for finding in same[:10])
        + f"{', …' if len(same) > 10 else ''}\n{same[0].text}"
        for same in kinds.values()
    ]


def main() -> int:
    """Fuzz some formats; 1 where something was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("formats", nargs="*", help=f"of {', '.join(LOADERS)}; none means all")
    parser.add_argument("--count", type=int, default=200, help="files of each format")
    parser.add_argument("--seconds", type=float, default=3600.0, help="for everything")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--cli", action="store_true", help="by the command line, each file in a process")
    parser.add_argument("--keep", help="a folder for files that were found")
    options = parser.parse_args()
    options.formats = options.formats or list(LOADERS)
    unknown = [form for form in options.formats if form not in LOADERS]
    if unknown:
        parser.error(f"there is no format {unknown[0]!r}; there are: {', '.join(LOADERS)}")
    until = time.monotonic() + options.seconds
    slices = [
        (form, range(begin, options.count, options.jobs))
        for form in options.formats
        for begin in range(min(options.jobs, options.count))
    ]
    totals: dict[str, collections.Counter[str]] = {form: collections.Counter() for form in options.formats}
    findings: list[Finding] = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        jobs = {
            pool.submit(
                play_apart, form, numbers, options.seed, until, options.keep, read=partial(play, cli=options.cli)
            ): form
            for form, numbers in slices
        }
        for job in concurrent.futures.as_completed(jobs):
            ends, found = job.result()
            totals[jobs[job]] += ends
            findings += found
    for form, ends in totals.items():
        print(
            f"{form:<9} {ends.total():>6} files: {ends['read']} read, {ends['refused']} refused, {ends['found']} found"
        )
    for kind in report(findings, options.seed):
        print(kind, file=sys.stderr)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
