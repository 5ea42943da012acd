import json
from dataclasses import replace

import pytest

from support.evaluation_rows import make_rows
from trundle.errors import InputError
from trundle.evaluation.report.text import comparison_lines, verdict
from trundle.evaluation.statistics.comparison import compare, compare_within
from trundle.evaluation.statistics.paired_tests import mcnemar_exact
from trundle.evaluation.statistics.table import Table


def rows(missions=60, planner="jps", failing=0.0, name="a", **options):
    made = make_rows(missions, planners=(planner,), failing=(failing,), **options)
    return [replace(row, id=f"{name}{row.id[1:]}") for row in made]


def test_missions_that_only_one_arrives_on_are_named_and_make_it_worse():
    first, second = rows(failing=0.0), rows(failing=0.15, name="b")
    comparison = compare(Table.of(first), Table.of(second), ("runs/a", "runs/b"))
    (pair,) = comparison.pairs
    failed = [row for row in second if row.outcome != "arrived"]
    assert [mission.second for mission in pair.newly_failing] == [row.id for row in failed]
    assert [mission.outcome for mission in pair.newly_failing] == [row.outcome for row in failed]
    assert pair.newly_passing == ()
    assert pair.change("success").p == pytest.approx(mcnemar_exact(len(failed), 0))
    assert comparison.worse
    back = compare(Table.of(second), Table.of(first))
    assert not back.worse
    assert len(back.pairs[0].newly_passing) == len(failed)
    assert back.pairs[0].change("success").direction == "better"
    assert back.pairs[0].newly_passing[0].outcome == failed[0].outcome


def test_an_evaluation_compared_with_itself_did_not_change():
    table = Table.of(rows(failing=0.1))
    comparison = compare(table, table)
    assert not comparison.worse
    assert (comparison.only_first, comparison.only_second) == (0, 0)
    changes = [change for change in comparison.pairs[0].changes if change.difference.n]
    assert len(changes) == 10
    assert all(change.difference.value == 0.0 and not change.clear for change in changes)


def test_figures_of_sensing_are_compared_where_some_episode_has_them():
    first, second = rows(), rows(name="b")
    plain = compare(Table.of(first), Table.of(second))
    assert plain.pairs[0].change("position_error_m").difference.n == 0
    lost = [replace(row, position_error_m=0.3, standing_contacts=0) for row in second]
    sensed = compare(
        Table.of([replace(row, position_error_m=0.1, standing_contacts=0) for row in first]), Table.of(lost)
    )
    change = sensed.pairs[0].change("position_error_m")
    assert change.difference.value == pytest.approx(0.2, abs=1e-6)
    assert change.direction == "worse"
    assert not change.worse  # for information
    assert sensed.pairs[0].change("standing_contacts").difference.n == 0
    assert sensed.count == plain.count + 1
    text = "\n".join(comparison_lines(sensed))
    assert "error of the estimate" in text
    assert "while it stood" not in text


@pytest.mark.parametrize(("slower", "worse"), [(3.0, True), (0.05, False)])
def test_times_are_compared_where_both_arrive_and_less_than_1_percent_is_not_worse(slower, worse):
    first, second = rows(), rows(name="b", slower_s=(slower,))
    second[:5] = [replace(row, outcome="stuck", time_s=900.0, spl=0.0) for row in second[:5]]
    comparison = compare(Table.of(first), Table.of(second))
    change = comparison.pairs[0].change("time_s")
    assert change.difference.value == pytest.approx(slower, abs=1e-6)
    assert change.difference.n == comparison.pairs[0].both == 115
    assert change.clear
    assert change.worse == worse


def test_clock_times_never_make_it_worse():
    second = [replace(row, planning_ms=row.planning_ms * 50.0) for row in rows(name="b")]
    comparison = compare(Table.of(rows()), Table.of(second))
    assert comparison.pairs[0].change("planning_ms").direction == "worse"
    assert not comparison.worse


def test_episodes_without_a_partner_are_counted():
    first, second = rows(missions=40), rows(missions=30, name="b")
    second[0] = replace(second[0], mission="")
    comparison = compare(Table.of(first), Table.of(second))
    assert comparison.pairs[0].missions == 59
    assert (comparison.only_first, comparison.only_second) == (21, 1)
    assert "21 episodes of A left out: their missions are not in the other" in comparison_lines(comparison)


def test_what_differs_is_what_is_compared():
    comparison = compare(Table.of(rows(planner="jps")), Table.of(rows(planner="astar", name="b")))
    assert [(pair.first, pair.second) for pair in comparison.pairs] == [("jps", "astar")]


def test_of_several_planners_those_of_the_same_name_are_paired():
    first = make_rows(30, planners=("jps", "astar"))
    second = make_rows(30, planners=("astar", "jps", "auto"))
    comparison = compare(Table.of(first), Table.of(second))
    assert [(pair.first, pair.second) for pair in comparison.pairs] == [("jps", "jps"), ("astar", "astar")]
    assert comparison.only_second == 60


def test_settings_of_both_that_do_not_match_are_refused():
    first, second = (Table.of(make_rows(5, planners=names)) for names in (("jps", "astar"), ("auto", "theta")))
    with pytest.raises(InputError, match="not clear what to compare: jps, astar in the first evaluation, auto, theta"):
        compare(first, second)


def test_evaluations_of_other_missions_are_refused_with_what_differs():
    with pytest.raises(InputError, match="The worlds are cellar and office, warehouse"):
        compare(Table.of(rows(worlds=("cellar",))), Table.of(rows()))
    with pytest.raises(InputError, match="b has no episode yet"):
        compare(Table.of(rows()), Table.of([]))


def test_a_changed_robot_is_compared_by_starts_and_goals_and_this_is_said():
    second = [replace(row, mission=f"{row.index:x}", time_s=row.time_s + 3.0) for row in rows(name="b")]
    second[0] = replace(second[0], goal_x=40.0)
    comparison = compare(Table.of(rows()), Table.of(second))
    assert comparison.pairs[0].missions == 119
    assert comparison.pairs[0].change("time_s").difference.value == pytest.approx(3.0)
    assert comparison.as_dict()["paired_by"] == "ends"
    assert "No mission is the same in both" in "\n".join(comparison_lines(comparison))
    assert max(map(len, comparison_lines(comparison))) <= 80
    assert compare(Table.of(rows()), Table.of(rows(name="b"))).as_dict()["paired_by"] == "mission"


def test_settings_of_one_evaluation_are_compared_with_each_other():
    comparison = compare_within(Table.of(make_rows(40, planners=("a", "b", "c"), failing=(0.3, 0.0, 0.0))))
    assert [(pair.first, pair.second) for pair in comparison.pairs] == [("a", "b"), ("a", "c"), ("b", "c")]
    assert comparison.pairs[0].newly_passing[0].outcome != "arrived"
    many = compare_within(Table.of(make_rows(5, planners="abcde")))
    assert [pair.first for pair in many.pairs] == ["a"] * 4
    assert compare_within(Table.of(rows())) is None


def test_holms_correction_is_for_all_figures_of_all_pairs():
    comparison = compare_within(Table.of(make_rows(40, planners=("a", "b", "c"), failing=(0.1, 0.0, 0.0))))
    smallest = min((c for pair in comparison.pairs for c in pair.changes), key=lambda change: change.p)
    assert smallest.adjusted_p == pytest.approx(min(1.0, smallest.p * comparison.count))
    assert comparison.count == 30


def test_the_text_fits_80_columns_and_has_the_commands():
    comparison = compare(Table.of(rows()), Table.of(rows(failing=0.2, name="b")), ("runs/a", "runs/my b"))
    lines = comparison_lines(comparison)
    assert max(map(len, lines)) <= 80
    assert lines[-1] == verdict(comparison) == "B is worse: success, SPL"
    turned = comparison.pairs[0].newly_failing[0]
    assert f"  trundle run --from 'runs/my b:{turned.second[:12]}'  office: {turned.outcome}" in lines
    assert any("where both" in line for line in lines)
    assert any("Holm" in line for line in lines)


def test_it_is_json():
    comparison = compare(Table.of(rows(1)), Table.of(rows(1, name="b")))
    values = json.loads(json.dumps(comparison.as_dict(), allow_nan=False))
    assert values["worse"] is False
    assert values["pairs"][0]["missions"] == 2
