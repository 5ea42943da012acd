"""`junit.xml`: what CI shows. A group is a suite of tests and a mission is a test."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

import numpy as np

from trundle.evaluation.report.text import cause, replay_command, short_id
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.gates import GateResult
from trundle.evaluation.statistics.table import MOST_FAILED, Group, Table, group_rows

MOST_CASES = MOST_FAILED
"""Readers of CI give up on more."""
_BROKEN = frozenset({"crashed", "hung", "out_of_memory", "error"})
"""Outcomes of episodes that did not end by themselves: errors, where the others are failures."""
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_junit(table: Table, folder: str, *, name: str, gates: Sequence[GateResult] = ()) -> str:
    """Return the text of `junit.xml`.

    At most 10,000 missions are listed, the failed ones first; every suite says how many there are in all. What is
    required makes a suite of its own.

    Args:
        table: The rows.
        folder: The folder of the evaluation, for the commands.
        name: Name of the evaluation.
        gates: The results of what is required.
    """
    failed = {row.id: row for row in table.failed}
    arrived = table.arrived
    by_index = np.argsort(table.index, kind="stable")
    ordered = np.concatenate([by_index[~arrived[by_index]], by_index[arrived[by_index]]])[:MOST_CASES]
    listed = np.zeros(len(table), dtype=bool)
    listed[ordered] = True
    root = ElementTree.Element("testsuites", name=_text(name))
    if gates:
        root.append(_gate_suite(gates))
    for group in group_rows(table):
        root.append(_suite(table, group, listed, failed, folder))
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    root.set("time", f"{sum(float(suite.get('time', '0')) for suite in root):.3f}")
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _gate_suite(gates: Sequence[GateResult]) -> ElementTree.Element:
    missed = sum(not gate.passed for gate in gates)
    suite = ElementTree.Element("testsuite", name="requirements", tests=str(len(gates)), failures=str(missed))
    suite.set("errors", "0")
    suite.set("time", "0")
    for gate in gates:
        case = ElementTree.SubElement(suite, "testcase", classname="requirements", name=_text(gate.gate), time="0")
        if not gate.passed:
            ElementTree.SubElement(case, "failure", message=_text(gate.text), type=gate.state)
    return suite


def _suite(
    table: Table, group: Group, listed: np.ndarray, failed: Mapping[str, Row], folder: str
) -> ElementTree.Element:
    arrived = table.arrived
    rows = group.rows[listed[group.rows]]
    rows = rows[np.lexsort((table.index[rows], arrived[rows]))]
    suite = ElementTree.Element("testsuite", name=_text(group.name), tests=str(len(rows)))
    properties = ElementTree.SubElement(suite, "properties")
    for label, value in group.labels.items():
        if value:
            ElementTree.SubElement(properties, "property", name=label, value=_text(value))
    counts = {"failure": 0, "error": 0}
    seconds = 0.0
    for row in rows.tolist():
        wall = float(np.nan_to_num(table.numbers["wall_s"][row]))
        seconds += wall
        episode = table.id_of(row)
        case = ElementTree.SubElement(suite, "testcase", classname=_text(group.name), time=f"{wall:.3f}")
        case.set("name", f"seed {int(table.seed[row])} · {short_id(episode)}")
        if not arrived[row]:
            counts[_add_failure(case, failed[episode], folder)] += 1
    suite.set("failures", str(counts["failure"]))
    suite.set("errors", str(counts["error"]))
    suite.set("time", f"{seconds:.3f}")
    if len(rows) < len(group.rows):
        note = f"{len(rows)} of the {len(group.rows)} missions are listed, failed ones first"
        ElementTree.SubElement(suite, "system-out").text = note
    return suite


def _add_failure(case: ElementTree.Element, row: Row, folder: str) -> str:
    """Add why a mission failed to its element; return the kind of what was added."""
    kind = "error" if row.outcome in _BROKEN else "failure"
    element = ElementTree.SubElement(case, kind, message=_text(cause(row)), type=_text(row.outcome))
    element.text = _text(f"{row.error or row.message}\nRun it again: {replay_command(folder, row.id)}")
    return kind


def _text(text: str) -> str:
    """Return the text without the characters that XML cannot hold."""
    return _NOT_XML.sub("\ufffd", text)
