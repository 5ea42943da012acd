import contextlib
import copy
import importlib
import pickle
import pkgutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

import trundle
from trundle.errors import (
    BlockedPoseError,
    InputError,
    MissingExtraError,
    NoPathError,
    OutsideMapError,
    PlanningError,
    PlanningStoppedError,
    TrundleError,
    UnknownNameError,
)
from trundle.ros2.bad_input import BadInputError

PLACE = {"pose": (1.0, 2.0, 0.5), "cell": (3, 4)}
MADE = {
    UnknownNameError: lambda: UnknownNameError("planner", "a_star", ["astar", "auto"]),
    MissingExtraError: lambda: MissingExtraError("reading meshes", "trimesh", 'pip install "trundle[mesh]"'),
    PlanningError: lambda: PlanningError("no path", **PLACE),
    OutsideMapError: lambda: OutsideMapError("outside", **PLACE),
    BlockedPoseError: lambda: BlockedPoseError("blocked", **PLACE, nearest_free_m=0.7),
    NoPathError: lambda: NoPathError("no path", **PLACE),
    PlanningStoppedError: lambda: PlanningStoppedError("stopped", **PLACE, status="cancelled"),
    BadInputError: lambda: BadInputError("not finite", "a number of its pose is not finite"),
}


class PluginError(InputError):
    """As another package may write one: made from other arguments than its message, with extra attributes."""

    def __init__(self, first: int, *, second: str) -> None:
        super().__init__(f"{first} and {second}")
        self.first, self.second = first, second


def every_error():
    for module in pkgutil.walk_packages(trundle.__path__, "trundle."):
        if not module.name.endswith("__main__"):
            # What runs inside Isaac Sim alone, and what needs an extra.
            with contextlib.suppress(ModuleNotFoundError, MissingExtraError):
                importlib.import_module(module.name)
    kinds, waiting = set(), [TrundleError]
    while waiting:
        kind = waiting.pop()
        kinds.add(kind)
        waiting += kind.__subclasses__()
    return sorted((kind for kind in kinds if kind.__module__.startswith("trundle.")), key=lambda kind: kind.__name__)


def assert_same(one, other):
    assert type(one) is type(other)
    assert (str(one), repr(one), one.args) == (str(other), repr(other), other.args)
    assert vars(one) == vars(other)


@pytest.mark.parametrize("kind", every_error(), ids=lambda kind: kind.__name__)
def test_every_error_survives_pickle_and_copy_with_its_attributes(kind):
    error = MADE.get(kind, lambda: kind("what is wrong"))()
    error.add_note("a note")
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert_same(error, pickle.loads(pickle.dumps(error, protocol)))
    assert_same(error, copy.copy(error))
    assert_same(error, copy.deepcopy(error))


def test_the_attributes_that_the_docs_name_are_those_that_were_given():
    unknown = pickle.loads(pickle.dumps(MADE[UnknownNameError]()))
    assert (unknown.kind, unknown.name, unknown.choices) == ("planner", "a_star", ("astar", "auto"))
    hinted = UnknownNameError("planner", "a_star", ["astar"], hint="was renamed; use astar")
    assert str(hinted) == "planner 'a_star' was renamed; use astar"
    assert pickle.loads(pickle.dumps(hinted)).hint == "was renamed; use astar"
    missing = pickle.loads(pickle.dumps(MADE[MissingExtraError]()))
    assert (missing.purpose, missing.package, missing.install) == (
        "reading meshes",
        "trimesh",
        'pip install "trundle[mesh]"',
    )
    assert missing.msg == str(missing)
    blocked = pickle.loads(pickle.dumps(MADE[BlockedPoseError]()))
    assert (blocked.pose, blocked.cell, blocked.nearest_free_m) == (*PLACE.values(), 0.7)
    assert pickle.loads(pickle.dumps(MADE[PlanningStoppedError]())).status == "cancelled"


def test_an_error_of_another_package_needs_nothing_for_that():
    error = PluginError(7, second="eight")
    assert_same(error, pickle.loads(pickle.dumps(error)))
    assert_same(error, copy.deepcopy(error))


def test_an_error_raised_in_another_process_is_caught_as_what_it_is():
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool,
        pytest.raises(UnknownNameError, match="Did you mean 'astar'") as raised,
    ):
        pool.submit(trundle.planning.create_planner, "a_star").result()
    assert raised.value.name == "a_star"
    assert "auto" in raised.value.choices
