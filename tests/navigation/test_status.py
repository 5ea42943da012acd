"""The table of statuses and what changes them; and the seams that a navigator and its parts keep."""

import re
from pathlib import Path

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, grid_of, room
from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.behaviors import Spin
from trundle.navigation.state import ANY_STATUS_TO, FINAL, TRANSITIONS

ROOT = Path(__file__).parents[2]
S = NavigationStatus


def rows_of_the_docs():
    text = (ROOT / "docs/architecture.md").read_text().partition("## What a navigator is doing")[2]
    text = text.partition("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return [row for row in rows[2:] if len(row) == 3]


def test_the_docs_have_the_same_table():
    any_to = [["any", f"`{after}`", event] for after, event in ANY_STATUS_TO.items()]
    others = [[f"`{before}`", f"`{after}`", event] for (before, after), event in TRANSITIONS.items()]
    assert rows_of_the_docs() == any_to + others


def test_only_a_request_ends_a_status_that_is_final():
    assert not [change for change in TRANSITIONS if change[0] in FINAL | {S.IDLE}]


def test_changes_are_noted_with_where_they_lead(changes_of_status):
    navigator = Navigator(grid_of(room(block("closed", 5.0, 0.1, 5.4, 5.9))), ROBOT)
    navigator.set_goal(GOAL)
    navigator.update(START)
    navigator.run(Spin(0.2))
    navigator.cancel()
    assert changes_of_status == [
        (S.IDLE, S.DRIVING),
        (S.DRIVING, S.NO_PATH),
        (S.NO_PATH, S.BEHAVING),
        (S.BEHAVING, S.IDLE),
    ]


def test_a_drive_changes_in_one_place_alone():
    writes = [
        f"{path.name}: {line.strip()}"
        for path in (ROOT / "src/trundle/navigation").rglob("*.py")
        if not path.name.startswith(("agent", "explorer", "policy"))
        for line in path.read_text().splitlines()
        if re.search(r"\.(_state|status|message|standing_reasons|replans) \+?= ", line)
    ]
    assert writes == ["navigator_requests.py: self._state = state"]


@pytest.mark.parametrize("name", ["status", "message", "error", "target", "replans", "standing_reasons", "costmap"])
def test_what_a_navigator_says_cannot_be_assigned(name):
    navigator = Navigator(grid_of(room()), ROBOT)
    with pytest.raises((AttributeError, InputError)):
        setattr(navigator, name, None)


@pytest.mark.parametrize("name", ["planner", "controller", "smoother"])
def test_what_cannot_take_the_place_of_a_part_is_refused_at_once(name):
    navigator = Navigator(grid_of(room()), ROBOT)
    with pytest.raises(InputError, match=name):
        setattr(navigator, name, object())


def test_a_planner_may_be_replaced_by_one_that_returns_poses():
    class Straight:
        def plan(self, costmap, start, goal):
            return np.array([start.as_tuple(), goal.as_tuple()])

    navigator = Navigator(grid_of(room()), ROBOT)
    navigator.planner = Straight()
    navigator.set_goal(GOAL)
    assert navigator.update(START).v > 0.0
    assert len(navigator.path.poses) == 2


def test_a_controller_may_be_replaced_by_one_that_only_follows():
    class Creeping:
        def set_path(self, path):
            pass

        def compute_velocity(self, pose, twist, costmap, dt):
            return Twist2D(0.1, 0.0)

    navigator = Navigator(grid_of(room()), ROBOT, settings=NavigatorSettings(control_frequency=10.0))
    navigator.controller = Creeping()
    navigator.set_goal(GOAL)
    assert navigator.update(START) == Twist2D(0.1, 0.0)
    assert navigator.report(rollouts=True).rollouts is None


def test_no_capability_is_asked_for_by_its_name():
    found = [
        f"{path.name}: {match.group(0)}"
        for path in (ROOT / "src/trundle/navigation").rglob("*.py")
        for match in re.finditer(
            r"(getattr|hasattr)\([^()]*, \"\w+\"|isinstance\([^()]*, Navigator\)", path.read_text()
        )
    ]
    assert found == []
