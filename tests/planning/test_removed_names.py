"""Names and options of earlier versions are answered with what became of them."""

import pickle

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.planning import create_planner, planner_names
from trundle.planning.grid.removed import refuse_removed

REMOVED = {
    "jps": "was removed; use astar with method='jps'",
    "jps_plus": "was removed; use astar with method='jps'",
    "theta_star": "was removed; use any_angle",
    "blog": "was renamed; use manhattan_astar",
}


@pytest.mark.parametrize(("name", "what"), REMOVED.items())
def test_a_removed_planner_is_one_error_that_says_what_to_use(name, what):
    assert name not in planner_names()
    with pytest.raises(UnknownNameError, match=f"^planner '{name}' {what}") as caught:
        create_planner(name)
    assert caught.value.hint.startswith(what)
    assert pickle.loads(pickle.dumps(caught.value)).hint == caught.value.hint


def test_an_unknown_name_has_no_hint():
    with pytest.raises(UnknownNameError, match="Did you mean 'astar'") as caught:
        create_planner("astr")
    assert caught.value.hint is None


@pytest.mark.parametrize(("method", "words"), [("jps_plus", "'jps_plus' was removed; use 'jps'"), ("jsp", "is one of")])
def test_the_method_of_astar_is_checked(method, words):
    with pytest.raises(InputError, match=words):
        create_planner("astar", method=method)


def test_a_removed_keyword_is_refused_and_others_are_handed_on():
    @refuse_removed(colour="use `hue`")
    def paint(*, hue="red"):
        return hue

    assert (paint(), paint(hue="blue")) == ("red", "blue")
    with pytest.raises(InputError, match=r"^option 'colour' was removed; use `hue`$"):
        paint(colour="blue")
    with pytest.raises(TypeError, match="size"):
        paint(size=3)
