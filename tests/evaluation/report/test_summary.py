import json
import statistics
from dataclasses import replace

from support.evaluation_rows import make_rows
from trundle.evaluation.report.html.head import tiles
from trundle.evaluation.report.summary import count_outcomes, summarise
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.intervals import wilson
from trundle.evaluation.statistics.table import Table
from trundle.evaluation.store.row_encoding import decode_row, encode_row


def test_it_has_the_figures_of_all_rows_and_of_each_group():
    rows = list(make_rows(50, failing=(0.2, 0.0)))
    summary = json.loads(json.dumps(summarise(Table.of(rows)), allow_nan=False))
    arrived = [row for row in rows if row.outcome == "arrived"]
    low, high = wilson(len(arrived), 200)
    assert summary["episodes"] == summary["total"] == 200
    assert summary["complete"]
    assert summary["success"] == len(arrived) / 200
    assert (summary["success_low"], summary["success_high"]) == (low, high)
    assert sum(summary["outcomes"].values()) == 200
    assert abs(summary["medians"]["time_s"] - statistics.median(row.time_s for row in arrived)) < 1e-6
    assert len(summary["by_group"]) == 4
    key = "world=office robot=nova_carter planner=least_cost controller=regulated_pure_pursuit backend=kinematic"
    group = summary["by_group"][key]
    assert (group["episodes"], group["success"], group["success_high"]) == (50, 1.0, 1.0)
    assert group["labels"]["planner"] == "least_cost"


def test_an_unfinished_evaluation_says_so_and_gates_are_in_it():
    table = Table.of(make_rows(50))
    gates = [Gate.parse("success>=0.5").judge(table), Gate.parse("success>=0.999").judge(table)]
    summary = summarise(table, total=1000, gates=gates)
    assert (summary["episodes"], summary["total"], summary["complete"]) == (200, 1000, False)
    assert summary["passed"] is False
    assert [gate["passed"] for gate in summary["gates"]] == [True, False]


def test_before_the_first_episode_there_is_no_success():
    summary = summarise(Table.of([]), total=10)
    assert json.loads(json.dumps(summary, allow_nan=False))["success"] is None
    assert summary["by_group"] == {}
    assert summary["passed"] is None


def test_outcomes_are_counted_arrived_first():
    counts = count_outcomes(Table.of(make_rows(60, failing=(0.3,))))
    assert next(iter(counts)) == "arrived"
    assert list(counts.values())[1:] == sorted(list(counts.values())[1:], reverse=True)


def test_rows_without_a_path_are_counted_by_whether_the_search_was_complete():
    rows = list(make_rows(5, failing=(0.0, 0.0)))
    ends = [
        replace(row, outcome="no_path", complete=proved)
        for row, proved in zip(rows, (True, False, False), strict=False)
    ]
    table = Table.of([*ends, *rows[3:]])
    assert summarise(table)["no_path_complete"] == 1
    assert "complete search: 1 (there is no path); not complete: 2 (none found)" in tiles(table)
    assert decode_row(encode_row(ends[0]))["complete"] is True
