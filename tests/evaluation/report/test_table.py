import shlex
from dataclasses import replace

from support.evaluation_rows import make_rows
from trundle.evaluation.report.text import table_lines


def test_each_failed_row_has_its_cause_and_the_command_that_runs_it_again():
    rows = list(make_rows(20, failing=(0.3, 0.0)))
    lines = table_lines(rows, "runs/nightly")
    assert max(map(len, lines)) <= 80
    failed = [row for row in rows if row.outcome != "arrived"]
    assert [line.strip() for line in lines if "--from" in line] == [
        f"trundle run --from runs/nightly:{row.id[:12]}" for row in failed
    ]
    at = next(number for number, line in enumerate(lines) if failed[0].id[:12] in line)
    assert failed[0].message in lines[at + 1]
    assert lines[0].split()[:2] == ["id", "outcome"]


def test_columns_name_what_differs_and_long_labels_are_cut():
    rows = [replace(row, planner=row.planner + "_with_many_options" * 4) for row in make_rows(2)]
    lines = table_lines(rows, "out")
    assert "world · planner" in lines[0]
    assert max(map(len, lines)) <= 80
    assert "…" in lines[1]


def test_an_episode_that_crashed_has_no_figures_but_its_place():
    (row,) = make_rows(1, worlds=("office",), planners=("mine",))
    crashed = replace(row, outcome="crashed", error="segmentation fault at mine.py:12 in plan", time_s=None)
    lines = table_lines([crashed], "a folder")
    assert "–" in lines[1]
    assert "mine.py:12 in plan" in lines[2]
    assert shlex.split(lines[3])[-1] == f"a folder:{row.id[:12]}"


def test_nothing_in_a_row_steers_the_terminal():
    rows = [replace(row, outcome="error", error="\x1b[2Jgone\nand\r\x9b3m more") for row in make_rows(1)]
    assert all(line.isprintable() for line in table_lines(rows, "out"))


def test_without_a_row_it_says_so():
    assert table_lines([], "out") == ["no such episode"]
