"""Writing report.html, junit.xml and summary.json: at once, in a separate process, or from time to time meanwhile."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from trundle.errors import OutputError
from trundle.evaluation.report.html.page import render_page
from trundle.evaluation.report.html.places import Maps
from trundle.evaluation.report.junit import write_junit
from trundle.evaluation.report.summary import summarise
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.table import Table
from trundle.evaluation.store.folder import Stopped
from trundle.files.writing import write_text
from trundle.guard.process import start_process

HTML, JUNIT, SUMMARY = "report.html", "junit.xml", "summary.json"


def write_reports(
    folder: str | os.PathLike[str],
    rows: Iterable[Row] | Table,
    *,
    shown: str | None = None,
    name: str | None = None,
    total: int | None = None,
    require: Sequence[Gate] = (),
    maps: Maps = lambda _: None,
    facts: Mapping[str, str] | None = None,
    stopped: Stopped | None = None,
) -> dict[str, Any]:
    """Write the reports into the folder of an evaluation; each replaces its file as a whole.

    Args:
        folder: The folder.
        rows: The rows so far, in the order of the suite.
        shown: The folder as the commands in the reports are to name it; by default as it is given.
        name: Name of the evaluation; by default that of the folder.
        total: How many episodes there are to be; by default those that have a row.
        require: What is required.
        maps: Gives the map of a world by the key in a row's `place`; None where it is not known.
        facts: What else is to be said at the top of the page: versions, the command, when it was run.
        stopped: Why not all episodes have a row, where that is known.

    Returns:
        What summary.json has; `passed` is the verdict.

    Raises:
        UnknownNameError: If all episodes are done, and a requirement names a label that none has.
        OutputError: If a file cannot be written.
    """
    path, shown = Path(folder), shown or os.fspath(folder)
    table = rows if isinstance(rows, Table) else Table.of(rows)
    if total is None or len(table) >= total:
        for gate in require:
            gate.check_labels({label: table.named[label].names for label in gate.labels})
    gates = [gate.judge(table) for gate in require]
    name = path.resolve().name if name is None else name
    summary = summarise(table, total=total, gates=gates, stopped=stopped)
    page = render_page(
        table, name=name, folder=shown, total=total, gates=gates, maps=maps, facts=facts, stopped=stopped
    )
    write_text(path / HTML, page)
    write_text(path / JUNIT, write_junit(table, shown, name=name, gates=gates))
    write_text(path / SUMMARY, json.dumps(summary, indent=2, allow_nan=False, ensure_ascii=False) + "\n")
    return summary


_PROGRAM = """
import json, os, signal, sys
signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
os.nice(int(sys.argv[3]))
from trundle.errors import TrundleError
from trundle.evaluation import Evaluation
try:
    Evaluation(sys.argv[1]).write_report(json.loads(sys.argv[2]), apart=False)
except TrundleError as error:
    sys.exit(str(error))
"""

Writer = subprocess.Popen[bytes]
"""A process that writes a report."""


def start_writer(folder: str) -> Writer:
    """Start a process that writes the reports of a folder once; what it has to say is dropped."""
    return start_process(_command(folder, None, nice=10))


def write_apart(folder: str, require: Sequence[str] | None) -> None:
    """Write the reports of a folder, and wait for them.

    Args:
        folder: The folder, or the URI of one in an object store.
        require: The requirements to judge by; by default those of the suite.

    Raises:
        OutputError: If they cannot be written.
    """
    command = _command(folder, require, nice=0)
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False
    )
    if done.returncode != 0:
        reason = done.stderr.decode(errors="replace").strip() or f"its process ended with {done.returncode}"
        raise OutputError(f"the report of {folder} could not be written: {reason}")


def _command(folder: str, require: Sequence[str] | None, *, nice: int) -> list[str]:
    return [sys.executable, "-c", _PROGRAM, folder, json.dumps(require), str(nice)]


FIRST_S = 30.0
"""When the first report is started, after the evaluation [s]."""

_REST = 20.0
"""The pause after a report in times that it took, which bounds what reports cost to 5 % of one CPU."""

_END_S = 0.5

_KILLED_S = 10.0
"""A killed process is gone at once, but where nothing of it gets the processor: a report is not worth a longer wait."""


class InterimReports:
    """Writes the reports of an evaluation from time to time, in a separate process: results do not wait for it.

    A report that cannot be written is left out; the one at the end says why.

    Args:
        folder: The folder, or the URI of one in an object store.
        start: Starts what writes them.
        clock: Gives the time [s].
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        start: Callable[[str], Writer] = start_writer,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder = os.fspath(folder)
        self._start = start
        self._clock = clock
        self._writer: Writer | None = None
        self._began = 0.0
        self._next = clock() + FIRST_S

    def look(self) -> None:
        """Start a report if it is time for one; call this often."""
        now = self._clock()
        if self._writer is not None:
            if self._writer.poll() is None:
                return
            self._writer = None
            self._next = now + _REST * (now - self._began)
        if now < self._next:
            return
        self._began = now
        try:
            self._writer = self._start(self._folder)
        except OSError:
            self._next = now + FIRST_S

    def close(self) -> None:
        """End the report that is being written."""
        writer, self._writer = self._writer, None
        if writer is None or writer.poll() is not None:
            return
        writer.terminate()
        try:
            writer.wait(_END_S)
        except subprocess.TimeoutExpired:
            writer.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                writer.wait(_KILLED_S)
