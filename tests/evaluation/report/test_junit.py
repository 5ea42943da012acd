from dataclasses import replace
from xml.etree import ElementTree

from support.evaluation_rows import make_rows
from trundle.evaluation.report import junit
from trundle.evaluation.report.junit import write_junit
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.table import Table


def parse(rows, **options):
    return ElementTree.fromstring(write_junit(Table.of(rows), "runs/a", name="nightly", **options).encode())


def test_a_group_is_a_suite_and_a_mission_is_a_case():
    rows = list(make_rows(20, failing=(0.3, 0.0)))
    root = parse(rows)
    failed = [row for row in rows if row.outcome != "arrived"]
    assert root.get("name") == "nightly"
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("80", str(len(failed)), "0")
    assert [suite.get("name") for suite in root] == [
        "office · jps", "office · least_cost", "warehouse · jps", "warehouse · least_cost",
    ]  # fmt: skip
    for suite in root:
        assert int(suite.get("tests")) == len(suite.findall("testcase")) == 20
        assert int(suite.get("failures")) == len(suite.findall("testcase/failure"))
    texts = [failure.text for failure in root.iter("failure")]
    assert all(any(f"trundle run --from runs/a:{row.id[:12]}" in text for text in texts) for row in failed)


def test_failed_missions_come_first():
    for suite in parse(make_rows(20, failing=(0.3,))):
        cases = suite.findall("testcase")
        states = [case.find("failure") is None for case in cases]
        assert states == sorted(states)


def test_episodes_that_did_not_end_by_themselves_are_errors():
    rows = list(make_rows(3))
    rows[0] = replace(rows[0], outcome="hung", error="no end after 60 s, at mine.py:3 in plan", wall_s=None)
    root = parse(rows)
    (error,) = root.iter("error")
    assert error.get("type") == "hung"
    assert "mine.py:3" in error.get("message")
    assert root.get("errors") == "1"


def test_what_is_required_is_a_suite_of_its_own():
    rows = list(make_rows(20))
    gates = [Gate.parse(text).judge(Table.of(rows)) for text in ("success>=0.1", "success>=0.999")]
    suite = parse(rows, gates=gates)[0]
    assert (suite.get("name"), suite.get("tests"), suite.get("failures")) == ("requirements", "2", "1")


def test_the_cap_keeps_failed_missions_and_is_stated(monkeypatch):
    monkeypatch.setattr(junit, "MOST_CASES", 30)
    rows = list(make_rows(20, failing=(0.0, 0.5)))
    root = parse(rows)
    failed = sum(row.outcome != "arrived" for row in rows)
    assert (root.get("tests"), root.get("failures")) == ("30", str(failed))
    assert "of the 20 missions are listed, failed ones first" in root[0].find("system-out").text


def test_characters_that_xml_cannot_hold_are_replaced():
    rows = [
        replace(row, outcome="error", planner="<w> & \x07", error="\x1b[31m<&>") for row in make_rows(1, planners="a")
    ]
    root = parse(rows)
    assert "<w> & \ufffd" in root.find("testsuite/properties/property[@name='planner']").get("value")
    assert next(root.iter("error")).text.startswith("\ufffd[31m<&>")
