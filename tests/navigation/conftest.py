"""Every change of a navigator's status in these tests is one of the table in `trundle.navigation.state`."""

import functools

import pytest

from trundle.navigation import Navigator
from trundle.navigation.state import ANY_STATUS_TO, TRANSITIONS


@pytest.fixture(autouse=True)
def changes_of_status(monkeypatch):
    """The changes of status that navigators make in a test; one outside of the table fails it."""
    seen, outside, updating = [], [], []
    enter, update = Navigator._enter, Navigator.update

    def note(self, state):
        change = (self.status, state.status)
        if change[0] is not change[1]:
            seen.append(change)
            asked_for = not updating and change[1] in ANY_STATUS_TO
            if not asked_for and change not in TRANSITIONS:
                outside.append(change)
        enter(self, state)

    @functools.wraps(update)
    def note_update(self, *given, **named):
        updating.append(self)
        try:
            return update(self, *given, **named)
        finally:
            updating.pop()

    monkeypatch.setattr(Navigator, "_enter", note)
    monkeypatch.setattr(Navigator, "update", note_update)
    yield seen
    assert not outside, f"changes of status that the table does not have: {outside}"
