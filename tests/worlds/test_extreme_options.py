"""Options of every generated world at their extremes: the world is made, or an error names what is wrong."""

import inspect

import pytest

from trundle.errors import InputError
from trundle.worlds import World
from trundle.worlds.world import WORLDS

EXTREMES = (1e9, 10**9, 1e-9, -1, 0, 1e300, 10**400, (1e9, 1e9), (1e-9, 1e-9), "x", True)
OPTIONS = [
    (name, option)
    for name in ("corridors", "cylinders", "lot", "maze", "office", "warehouse")
    for option in inspect.signature(WORLDS.load(name)).parameters
    if option not in ("seed", "exclude")
]


@pytest.mark.parametrize(("name", "option"), OPTIONS)
def test_extreme_options_are_refused_by_name_or_make_a_world(name, option):
    refusals = []
    for value in EXTREMES:
        try:
            World.generate(name, seed=0, **{option: value})
        except InputError as error:
            refusals.append(str(error))
    assert [text for text in refusals if option not in text and name not in text] == []
