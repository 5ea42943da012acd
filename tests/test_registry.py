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
