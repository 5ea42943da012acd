"""Names that stand for no planner and no method are answered with what there is."""

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.planning import create_planner


def test_an_unknown_name_is_answered_with_the_nearest_one():
    with pytest.raises(UnknownNameError, match="Did you mean 'astar'") as caught:
        create_planner("astr")
    assert caught.value.hint is None


def test_the_method_of_astar_is_checked():
    with pytest.raises(InputError, match="is one of"):
        create_planner("astar", method="jsp")
