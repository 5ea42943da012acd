import importlib.metadata

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.registry import Registry

REGISTRY: Registry[object] = Registry(
    "shape", "trundle.nothing", {"sphere": "trundle.solids:Sphere", "box": "trundle.solids:Box"}
)


def test_a_name_gives_the_class_behind_it():
    from trundle.solids import Sphere

    assert REGISTRY.load("sphere") is Sphere
    assert REGISTRY.names() == ["box", "sphere"]


def test_an_unknown_name_offers_the_nearest_and_lists_all():
    with pytest.raises(
        UnknownNameError, match=r"unknown shape 'spere'. Did you mean 'sphere'\? There are: box, sphere"
    ):
        REGISTRY.load("spere")


def test_what_is_made_gets_its_arguments_and_options():
    from trundle.solids import Sphere

    assert REGISTRY.make("sphere", 0.5) == REGISTRY.make("sphere", radius=0.5) == Sphere(0.5)
    with pytest.raises(InputError, match=r"^shape 'sphere' has no option 'size'$"):
        REGISTRY.make("sphere", size=2.0)


def test_what_is_made_already_is_taken_if_it_can_do_what_is_asked_of_it():
    class Shape:
        def area(self):
            return 1.0

    shape = Shape()
    assert REGISTRY.take(shape, "area") is shape
    assert REGISTRY.take("sphere", "area", 0.5) == REGISTRY.make("sphere", 0.5)
    for other in (None, 3, Shape, object()):
        with pytest.raises(InputError, match=r"a shape is given by its name or as an object with area\(…\), got"):
            REGISTRY.take(other, "area")
    with pytest.raises(InputError, match="size: options need a shape given by name"):
        REGISTRY.take(shape, "area", size=2.0)


def test_names_of_the_table_ask_for_no_entry_points(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda **_: pytest.fail("asked for entry points"))
    registry = Registry(
        "shape", "trundle.nothing", {"box": "trundle.solids:Box"}, removed={"cube": "was renamed; use box"}
    )
    registry.load("box")
    registry.check("box")
    assert registry.removal("box") is None


def test_checking_a_name_imports_nothing():
    registry = Registry("shape", "trundle.nothing", {"broken": "trundle.no_such_module:Shape"})
    registry.check("broken")
    with pytest.raises(UnknownNameError, match="Did you mean 'broken'"):
        registry.check("brokn")


def test_a_class_is_taken_by_module_and_name():
    from trundle.control import ProgressChecker

    name = "trundle.control:ProgressChecker"
    assert isinstance(REGISTRY.take(name, "reset", 0.5), ProgressChecker)
    with pytest.raises(InputError, match=f"shape '{name}' has no option 'size'"):
        REGISTRY.take(name, "reset", size=1.0)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("trundle.solids:solids_bounds", r"is not a class with bounds\(…\), as a shape has"),
        ("os:system", "is not a class"),
        ("trundle.solids:Nothing", "cannot be imported"),
        ("no_such_module:Shape", "cannot be imported"),
        (":Shape", "cannot be imported"),
        ("trundle.solids:", "cannot be imported"),
    ],
)
def test_nothing_but_a_class_with_the_method_is_taken_by_module_and_name(name, message):
    with pytest.raises(InputError, match=message):
        REGISTRY.take(name, "bounds")
