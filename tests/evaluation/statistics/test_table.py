import numpy as np
import pytest

from support.evaluation_rows import make_rows
from trundle.errors import InputError
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.table import Table, group_rows, iterate_groups


def test_columns_hold_what_the_rows_hold():
    rows = list(make_rows(30, vary=True))
    table = Table.of(iter(rows))
    assert len(table) == len(rows)
    assert table.numbers["time_s"].tolist() == [row.time_s for row in rows]
    assert [table.named["planner"].of(row) for row in range(len(rows))] == [row.planner for row in rows]
    assert [table.id_of(row) for row in range(len(rows))] == [row.id for row in rows]
    assert table.vary["friction"].tolist() == [row.vary["friction"] for row in rows]
    assert table.arrived.tolist() == [row.outcome == "arrived" for row in rows]
    assert [row.id for row in table.failed] == [row.id for row in rows if row.outcome != "arrived"]


def test_what_a_row_lacks_is_nan():
    row = Row(
        id="a", mission="b", index=0, world="w", robot="r", planner="p", controller="c", backend="k", seed=-1,
        outcome="crashed", error="segmentation fault",
    )  # fmt: skip
    table = Table.of([row])
    assert np.isnan(table.numbers["time_s"][0])
    assert table.failed == (row,)
    assert table.labels_of(0)["settings"] == ""


def test_groups_are_named_after_the_labels_in_which_they_differ():
    table = Table.of(make_rows(5))
    groups = group_rows(table)
    assert [group.name for group in groups] == [
        "office · jps", "office · least_cost", "warehouse · jps", "warehouse · least_cost",
    ]  # fmt: skip
    assert [n for _, _, n in iterate_groups(groups, table)] == [5, 5, 5, 5]
    (single,) = group_rows(Table.of(make_rows(5, worlds=("office",), planners=("astar",))))
    assert single.name == "office · astar"
    assert group_rows(Table.of([])) == []


def test_worlds_that_share_a_label_are_told_apart_by_their_maps():
    rows = list(make_rows(2))
    assert len(set(Table.of(rows).clusters.tolist())) == 2


def test_an_episode_that_occurs_twice_is_refused():
    rows = list(make_rows(2))
    with pytest.raises(InputError, match=f"episode {rows[1].id} occurs twice"):
        Table.of([*rows, rows[1]])
