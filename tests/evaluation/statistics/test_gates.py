from dataclasses import replace

import numpy as np
import pytest

from support.evaluation_rows import make_rows
from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.statistics.figures import write_share
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.intervals import wilson
from trundle.evaluation.statistics.table import Table


def table(missions: int, failing: float = 0.0, **options) -> Table:
    return Table.of(make_rows(missions, worlds=("office",), planners=("astar",), failing=(failing,), **options))


def test_the_low_end_of_the_interval_is_compared_and_not_the_share():
    assert not Gate.parse("success>=0.99").judge(table(380)).passed
    judged = Gate.parse("success>=0.99").judge(table(381))
    assert judged.passed
    low, _ = wilson(381, 381)
    assert judged.text.startswith(f"100 % of 381 arrived; the low end of the 95 % interval is {write_share(low, 381)}")


def test_an_undecided_gate_has_not_passed_and_says_how_many_more_episodes_decide():
    result = Gate.parse("success >= 99%").judge(table(100))
    assert (result.state, result.passed, result.more_needed) == ("undecided", False, 281)
    assert result.text.endswith("about 281 more episodes would decide")


def test_a_share_clearly_below_the_bound_has_failed():
    result = Gate.parse("success>=0.99").judge(table(200, failing=0.2))
    assert result.state == "failed"
    assert result.more_needed == 0


def test_before_the_first_episode_it_is_undecided():
    result = Gate.parse("success>=0.99").judge(Table.of([]))
    assert (result.state, result.more_needed) == ("undecided", 381)


def test_at_most_compares_the_high_end():
    few = table(100, failing=0.05)
    _, high = wilson(int(few.arrived.sum()), 100)
    assert Gate.parse(f"success<={high + 0.001}").judge(few).passed
    assert not Gate.parse(f"success<={high - 0.001}").judge(few).passed


def test_no_contact_is_asked_of_every_episode_and_comes_with_its_bound():
    clean = Gate.parse("contacts<=0").judge(table(381))
    assert clean.passed
    assert "at most 1 % of missions do not" in clean.text
    assert Gate.parse("contacts<=0").judge(table(200, failing=0.2)).state == "failed"


@pytest.mark.parametrize("figure", ["standing_contacts", "unseen_contacts"])
def test_no_contact_of_any_kind_can_be_asked_of_every_episode(figure):
    rows = list(make_rows(100, worlds=("office",), planners=("astar",)))
    clean = [replace(row, **{figure: 0}) for row in rows]
    assert Gate.parse(f"{figure}<=0").judge(Table.of(clean)).passed
    assert Gate.parse(f"{figure}<=0").judge(Table.of([replace(clean[0], **{figure: 1}), *clean[1:]])).state == "failed"
    assert Gate.parse(f"{figure}<=0").judge(Table.of(rows)).state == "undecided"  # rows of an older evaluation


def test_the_error_of_the_estimate_and_stops_of_the_monitor_can_be_required():
    rows = make_rows(200, worlds=("office",), planners=("astar",))
    sensed = [replace(row, position_error_m=0.2 + 0.001 * (row.index % 7), monitor_stops=row.index % 3) for row in rows]
    table = Table.of(sensed)
    assert Gate.parse("position_error_m<=0.3").judge(table).passed
    assert Gate.parse("position_error_m<=0.1").judge(table).state == "failed"
    assert "stops by the collision monitor" in Gate.parse("monitor_stops<=5").judge(table).text


@pytest.mark.parametrize(
    ("figure", "sign", "shift"), [("spl", ">=", -1.0), ("time_s", "<=", 1.0), ("planning_ms", "<=", 1.0)]
)
def test_means_are_judged_by_the_end_of_their_interval(figure, sign, shift):
    rows = table(300, failing=0.1)
    values = rows.numbers[figure]
    if figure == "time_s":
        values = values[rows.arrived]
    mean, error = float(values.mean()), float(values.std() / np.sqrt(len(values)))
    for errors, state in ((3.0, "passed"), (0.5, "undecided"), (-4.0, "failed")):
        result = Gate.parse(f"{figure}{sign}{mean + shift * errors * error:.6f}").judge(rows)
        assert result.state == state, errors
        assert (result.more_needed > 0) == (state == "undecided")


def test_a_gate_may_be_for_episodes_with_some_labels():
    both = Table.of(make_rows(400, planners=("jps", "astar"), failing=(0.2, 0.0)))
    assert not Gate.parse("success>=0.99").judge(both).passed
    assert Gate.parse("success[planner=astar]>=0.99").judge(both).passed
    assert "of 400 arrived" in Gate.parse("success[planner=astar, world=office]>=0.99").judge(both).text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("succes>=0.99", "Did you mean 'success'"),
        ("success[planer=auto]>=0.99", "Did you mean 'planner'"),
        ("success>0.99", "cannot read the requirement"),
        ("success", "cannot read the requirement"),
        ("success>=high", "'high' is not a number"),
        ("success>=nan", "'nan' is not a number"),
        ("success>=99", "99 % is 0.99"),
        ("success[planner]>=0.9", "write planner=NAME"),
    ],
)
def test_a_requirement_with_a_typo_is_refused_with_what_was_meant(text, message):
    with pytest.raises(InputError, match=message):
        Gate.parse(text)


def test_a_label_that_does_not_occur_is_refused_with_the_nearest():
    gate = Gate.parse("success[planner=asta]>=0.9")
    with pytest.raises(UnknownNameError, match="Did you mean 'astar'"):
        gate.check_labels({"planner": ["astar", "jps"]})


@pytest.mark.parametrize("text", ["success[planner=jps]>=0.9", "contacts[planner=jps]<=0", "spl[planner=jps]>=0.9"])
def test_a_gate_for_episodes_that_are_still_to_come_is_undecided(text):
    result = Gate.parse(text).judge(table(30))
    assert (result.state, result.passed) == ("undecided", False)
    assert result.more_needed > 0


def test_a_gate_is_written_as_it_is_read():
    for text in ("success>=0.99", "time_s<=40", "success[planner=auto,world=office]>=0.5"):
        assert str(Gate.parse(text)) == text
        assert Gate.parse(str(Gate.parse(text))) == Gate.parse(text)
