"""What a view takes from its pages: goals, keys, poses; the rest is refused."""

import json
import time
from collections.abc import Callable

import pytest

from support.page_visitor import WAIT_S, OpenPage, Visitor
from trundle.geometry import Goal, Pose2D
from trundle.serve import View


def visit(view: View) -> OpenPage:
    return Visitor.of_address(view.address).open()


def until(found: Callable[[], bool]) -> None:
    deadline = time.monotonic() + WAIT_S
    while not found():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_pose_that_is_set_on_the_page_is_taken_once(view: View) -> None:
    view.update((1.0, 2.0))
    with visit(view) as page:
        page.wait("frame")
        assert view.take_pose() is None
        for x in (3.0, 4.0):
            page.send("pose", pose=[x, 2.0, 0.5], covariance=[[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.0685]])
        page.ping()
        assert view.take_pose() == Pose2D(4.0, 2.0, 0.5)
        assert view.take_pose() is None
        assert view.goal is None


# What the loop gets --------------------------------------------------------------------------------------------------


def test_a_clicked_goal_stays_and_is_taken_once(view: View) -> None:
    assert view.goal is None
    assert view.take_goal() is None
    view.update((0.0, 0.0))
    with visit(view) as page:
        page.send("goal", pose=[1.0, 2.0, None])
        page.send("goal", pose=[3.0, 4.0, 1.5])
        page.ping()
        assert view.goal == Goal(3.0, 4.0, 1.5)
        assert view.take_goal() == Goal(3.0, 4.0, 1.5)
        assert view.take_goal() is None
        assert view.goal == Goal(3.0, 4.0, 1.5)
        view.update((0.0, 0.0))
        assert page.wait("frame", lambda message: message["goals"])["goals"] == [[3.0, 4.0, 1.5]]
        view.goal = None
        view.update((0.0, 0.0))
        page.wait("frame", lambda message: not message["goals"])
        view.goal = (1.0, 1.0)
        assert view.goal == Goal(1.0, 1.0)
        assert view.take_goal() is None  # nobody clicked it


def test_held_keys_count_as_let_go_when_the_page_tells_them_no_more(
    view: View, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trundle.serve.view.DEAD_MAN_S", 3600.0)
    with visit(view) as page:
        page.send("keys", held=["w", "ArrowUp"])
        page.ping()
        assert view.keys == {"w", "ArrowUp"}
        page.send("keys", held=[])
        page.ping()
        assert view.keys == frozenset()
        page.send("keys", held=["w"])
        page.ping()
        assert view.keys == {"w"}
        monkeypatch.setattr("trundle.serve.view.DEAD_MAN_S", 0.3)
        until(lambda: not view.keys)


def test_held_keys_count_as_let_go_when_the_connection_is_lost(view: View, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trundle.serve.view.DEAD_MAN_S", 3600.0)
    page = visit(view)
    page.send("keys", held=["w"])
    page.ping()
    assert view.keys == {"w"}
    page.close()
    until(lambda: not view.keys)


def test_only_the_page_that_drives_gives_goals_and_keys(view: View) -> None:
    with visit(view) as first, visit(view) as second:
        second.send("keys", held=["w"])
        second.send("goal", pose=[1.0, 1.0, None])
        assert "another page drives" in second.wait("error")["text"]
        second.ping()
        assert (view.goal, view.keys) == (None, frozenset())
        first.ping()


@pytest.mark.parametrize(
    "message",
    [
        {"type": "keys"},
        {"type": "keys", "held": "w"},
        {"type": "keys", "held": [""]},
        {"type": "keys", "held": ["k" * 25]},
        {"type": "keys", "held": [str(i) for i in range(17)]},
        {"type": "restart", "seed": None},
        {"type": "manual", "v": 1.0, "w": 0.0},
        {"type": "goal", "pose": [1.0]},
        {"type": "setup"},
    ],
    ids=str,
)
def test_anything_else_is_refused_with_a_reason(view: View, message: dict[str, object]) -> None:
    with visit(view) as page:
        page.socket.send(json.dumps(message))
        assert page.wait("error")["text"]
    assert (view.goal, view.keys) == (None, frozenset())
