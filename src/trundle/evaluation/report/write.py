"""`write_reports`: report.html, junit.xml and summary.json of an evaluation."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from trundle.evaluation.report.html.page import render_page
from trundle.evaluation.report.html.places import Maps
from trundle.evaluation.report.junit import write_junit
from trundle.evaluation.report.summary import summarise
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.table import Table
from trundle.evaluation.store.manifest import Stopped
from trundle.files.writing import write_text

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
        shown: The folder as the commands in the reports are to name it; none means as it is given.
        name: Of the evaluation; none means the folder's.
        total: How many episodes there are to be; none means those that there are.
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
