import pytest

from trundle.errors import UnknownNameError
from trundle.registry import Registry

REGISTRY = Registry("shape", "trundle.nothing", {"sphere": "trundle.solids:Sphere", "box": "trundle.solids:Box"})


def test_a_name_gives_the_class_behind_it():
    from trundle.solids import Sphere

    assert REGISTRY.load("sphere") is Sphere
    assert REGISTRY.names() == ["box", "sphere"]


def test_an_unknown_name_offers_the_nearest_and_lists_all():
    with pytest.raises(
        UnknownNameError, match=r"unknown shape 'spere'. Did you mean 'sphere'\? There are: box, sphere"
    ):
        REGISTRY.load("spere")
