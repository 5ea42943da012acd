"""Directives: which are refused, by themselves or by a run, many at once, and the files that record them."""

import json
import math
import threading

import pytest

from support.sessions import drive
from trundle.errors import InputError
from trundle.mission import (
    DropBox,
    End,
    GivenDirective,
    Manual,
    Pause,
    Release,
    Restart,
    Session,
    SetGoal,
    Speed,
    Steering,
    StepOnce,
    load_directives,
    save_directives,
)
from trundle.navigation import CommandScript, Waypoint
from trundle.navigation.behaviors import Wait

GOAL = (3.0, 4.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Pause("yes"), "paused must be true or false"),
        (lambda: Speed(0.05), "a factor from 0.1 to 50, or infinity, got 0.05"),
        (lambda: Speed(math.nan), "a factor from 0.1 to 50"),
        (lambda: Speed("fast"), "the speed of a run must be a number"),
        (lambda: SetGoal((1.0,)), "a pose is"),
        (lambda: SetGoal("here"), "a goal must be a sequence"),
        (lambda: SetGoal((1.0, math.nan)), "finite numbers"),
        (lambda: SetGoal((1.0, 2.0), append="no"), "append must be true or false"),
        (lambda: SetGoal(Waypoint(1.0, 2.0, tasks=[Wait(1.0)])), "has no tasks"),
        (lambda: Manual(math.inf, 0.0), "v of a manual command must be a number from"),
        (lambda: Manual(0.0, "left"), "w of a manual command must be a number from"),
        (lambda: DropBox(0.0, None), "y of a box must be a number"),
        (lambda: DropBox(0.0, 0.0, 0.0, (1.0, 1.0)), "three numbers"),
        (lambda: DropBox(0.0, 0.0, 0.0, (1.0, 1.0, 0.0)), "a side of a box must be a number from 0.01 to 20 m"),
        (lambda: Restart(-1), "seed"),
        (lambda: Restart("later"), "seed"),
        (lambda: End(""), "a text of 1 to 1000 characters"),
        (lambda: End(3), "a text of 1 to 1000 characters"),
        (lambda: Steering().put("pause"), "a directive must be of type"),
        (lambda: Steering().put(Pause(), by=3), "who gives a directive is a text"),
    ],
)
def test_a_bad_directive_is_one_clear_error(make, message):
    with pytest.raises(InputError) as failed:
        make()
    assert message in str(failed.value)
    assert "\n" not in str(failed.value)


def refusal(session, steering, directive):
    said = []
    steering.put(directive, refused=said.append)
    session.step()
    (text,) = said
    return text


def test_what_only_the_run_can_refuse_leaves_it_as_it_was(make_sim, sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    drive(session, 3)
    assert "would overlap the robot" in refusal(session, steering, DropBox(start.x, start.y))
    assert "outside" in refusal(session, steering, SetGoal((40.0, 1.0)))
    assert session.outcome is None
    other = Session(make_sim(), navigator, start, GOAL, steering=steering)
    assert "cannot put anything into its world" in refusal(other, steering, DropBox(6.0, 3.0))
    script = Session(sim, CommandScript([(0.1, 0.0, 5.0)]), start, steering=steering)
    assert "drives without goals" in refusal(script, steering, SetGoal(GOAL))


def test_directives_from_eight_threads_are_all_applied(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    each = 50

    def give(who):
        for number in range(each):
            steering.put(Speed(1.0 + number), by=f"thread {who}")

    threads = [threading.Thread(target=give, args=(who,)) for who in range(8)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        session.step()
    for thread in threads:
        thread.join()
    session.step()
    assert len(session.directives) == 8 * each
    for who in range(8):
        mine = [given.directive.factor for given in session.directives if given.by == f"thread {who}"]
        assert mine == [1.0 + number for number in range(each)]


# Records --------------------------------------------------------------------------------------------------------------


def test_every_directive_is_read_as_it_was_written(tmp_path):
    kinds = [Pause(False), StepOnce(), Speed(math.inf), Speed(0.1), SetGoal((1.0, 2.0)), Manual(0.1, -2.0), Release()]
    kinds += [SetGoal((1, 2, 0.5), append=True), DropBox(1.0, 2.0, 0.1, (1.0, 2.0, 0.5)), Restart("next"), Restart(4)]
    kinds += [End("지도 끝")]
    given = tuple(GivenDirective(k, 0.05 * k, kind, "ann" * (k % 2)) for k, kind in enumerate(kinds))
    save_directives(tmp_path / "directives.json", given)
    assert load_directives(tmp_path / "directives.json") == given


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (3, "it must be an object"),
        ({"index": 0, "time": 0.0}, "it lacks directive"),
        ({"index": -1, "time": 0.0, "directive": "pause"}, "index must be an integer from 0"),
        ({"index": 0, "time": -1.0, "directive": "pause"}, "time must be a number of 0 or more s"),
        ({"index": 0, "time": 0.0, "directive": "paus"}, "Did you mean 'pause'"),
        ({"index": 0, "time": 0.0, "directive": "speed", "factor": 0.0}, "a factor from 0.1 to 50"),
        ({"index": 0, "time": 0.0, "directive": "speed"}, "the directive 'speed' needs factor"),
        ({"index": 0, "time": 0.0, "directive": "goal", "gaol": [1, 2]}, "Did you mean 'goal'"),
        ({"index": 0, "time": 0.0, "directive": "goal", "goal": [1]}, "a pose is (x, y) or (x, y, yaw)"),
        ({"index": 0, "time": 0.0, "directive": "end", "by": 3}, "by must be a text"),
    ],
)
def test_a_damaged_record_of_directives_is_one_clear_error(entry, message, tmp_path):
    file = tmp_path / "directives.json"
    file.write_text(json.dumps({"directives": [{"index": 0, "time": 0.0, "directive": "release"}, entry]}))
    with pytest.raises(InputError) as failed:
        load_directives(file)
    assert str(failed.value).startswith(f"{file}: directive 2: ")
    assert message in str(failed.value)
    assert "\n" not in str(failed.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [("[]", "which is a JSON object"), ("{}", "no list 'directives'"), ("{", "directives.json:1:2")],
)
def test_a_file_without_directives_is_one_clear_error(text, message, tmp_path):
    file = tmp_path / "directives.json"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        load_directives(file)
    file.unlink()
    with pytest.raises(InputError, match="cannot read"):
        load_directives(file)
