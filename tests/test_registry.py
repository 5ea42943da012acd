import importlib.metadata

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.registry import Contract, PluginFunction, Registry

REGISTRY: Registry[object] = Registry(
    "shape",
    "trundle.nothing",
    {"sphere": "trundle.geometry.solids:Sphere", "box": "trundle.geometry.solids:Box"},
    contract=Contract({"contains": "point"}, function=("point", "margin"), keywords=("deadline_s",)),
)


def test_a_name_gives_the_class_behind_it():
    from trundle.geometry.solids import Sphere

    assert REGISTRY.load("sphere") is Sphere
    assert REGISTRY.names() == ["box", "sphere"]


def test_an_unknown_name_offers_the_nearest_and_lists_all():
    with pytest.raises(
        UnknownNameError, match=r"unknown shape 'spere'. Did you mean 'sphere'\? There are: box, sphere"
    ):
        REGISTRY.load("spere")


def test_what_is_made_gets_its_arguments_and_options():
    from trundle.geometry.solids import Sphere

    assert REGISTRY.make("sphere", 0.5) == REGISTRY.make("sphere", radius=0.5) == Sphere(0.5)
    with pytest.raises(InputError, match=r"^shape 'sphere' has no option 'size'$"):
        REGISTRY.make("sphere", size=2.0)


def test_names_of_the_table_ask_for_no_entry_points(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda **_: pytest.fail("asked for entry points"))
    registry = Registry("shape", "trundle.nothing", {"box": "trundle.geometry.solids:Box"})
    registry.load("box")
    registry.check("box")


def test_checking_a_name_imports_nothing():
    registry = Registry("shape", "trundle.nothing", {"broken": "trundle.no_such_module:Shape"})
    registry.check("broken")
    with pytest.raises(UnknownNameError, match="Did you mean 'broken'"):
        registry.check("brokn")


class Shape:
    """What a user may write."""

    def __init__(self, robot, *, size=1.0):
        self.robot, self.size = robot, size

    def contains(self, point):
        return True


class Placed:
    def __init__(self, a_map_by_another_name):
        self.place = a_map_by_another_name

    def contains(self, point):
        return True


class Meter:
    def __call__(self, point, margin):
        return margin


def everywhere(point, margin, deadline_s=None, *, robot=None, size=1.0):
    return (point, margin, deadline_s, robot, size)


OFFERED = {"robot": "carter", "map": "hall", "grid": "hall"}


def test_an_object_with_the_methods_is_taken_as_it_is():
    shape = Shape("any")
    assert REGISTRY.resolve(shape) is shape
    with pytest.raises(InputError, match="shape 'Shape' is an object already, and takes no option 'size'"):
        REGISTRY.resolve(shape, OFFERED, {"size": 2.0})


def test_a_class_is_made_with_what_its_parameters_name():
    made = REGISTRY.resolve(Shape, OFFERED, {"size": 2.0})
    assert (made.robot, made.size) == ("carter", 2.0)
    with pytest.raises(InputError, match=r"shape class 'Shape' has no option 'colour'; it has: size"):
        REGISTRY.resolve(Shape, OFFERED, {"colour": "red"})
    with pytest.raises(InputError, match=r"needs 'robot', and there is none here"):
        REGISTRY.resolve(Shape, {})


def test_a_parameter_that_nothing_fills_is_named_with_its_place():
    with pytest.raises(InputError, match=r"'Placed' \(.*test_registry\.py:\d+\) needs 'a_map_by_another_name'"):
        REGISTRY.resolve(Placed, OFFERED)
    assert REGISTRY.resolve(Placed, OFFERED, {"a_map_by_another_name": 3}).place == 3


@pytest.mark.parametrize("maker", [lambda robot: Shape(robot), lambda driven: Shape(driven), lambda: Shape("carter")])
def test_a_function_that_makes_one_gets_the_same_by_name_or_in_order(maker):
    assert REGISTRY.resolve(maker, OFFERED).robot == "carter"


def test_a_function_that_makes_something_else_says_so():
    with pytest.raises(InputError, match=r"is no shape \('object' was made\). A shape is a name"):
        REGISTRY.resolve(lambda: object(), OFFERED)


def test_a_function_of_the_arguments_does_the_work_and_gets_what_it_names():
    made = REGISTRY.resolve(everywhere, OFFERED, {"size": 3.0})
    assert isinstance(made, PluginFunction)
    assert made.name == "everywhere"
    assert made("p", 0.1, deadline_s=5.0, other=1) == ("p", 0.1, 5.0, "carter", 3.0)
    plain = REGISTRY.resolve(lambda point, margin: margin, OFFERED)
    assert plain("p", 0.2, deadline_s=5.0) == 0.2
    with pytest.raises(InputError, match="has no option 'colour'; it has: size"):
        REGISTRY.resolve(everywhere, OFFERED, {"colour": "red"})
    with pytest.raises(InputError, match="needs 'scale', which nothing gives"):
        REGISTRY.resolve(lambda point, margin, *, scale: margin, OFFERED)


def test_an_object_or_a_class_that_can_be_called_like_the_function_does_the_work():
    assert REGISTRY.resolve(Meter())("p", 0.3) == 0.3
    assert REGISTRY.resolve(Meter)("p", 0.3) == 0.3


@pytest.mark.parametrize("given", [None, 3, object(), [1.0]])
def test_anything_else_is_refused_with_what_would_do(given):
    with pytest.raises(InputError, match=r"is no shape. A shape is a name, .*or a function \(point, margin\)"):
        REGISTRY.resolve(given, OFFERED)


# By module and by file ------------------------------------------------------------------------------------------------

SOURCE = """
from trundle.errors import InputError

class Disc:
    def __init__(self, robot, radius=1.0):
        self.radius = radius

    def contains(self, point):
        return True

class Half:
    pass

def anywhere(point, margin):
    return margin

def make():
    raise RuntimeError("called")

disc = Disc(None, 7.0)
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my_shapes.py").write_text(SOURCE)
    return tmp_path / "my_shapes.py"


def test_a_class_a_function_and_an_object_are_named_by_their_file(file):
    assert REGISTRY.resolve("my_shapes.py:Disc", OFFERED, {"radius": 2.0}).radius == 2.0
    assert REGISTRY.resolve(f"{file}:disc", OFFERED).radius == 7.0
    assert REGISTRY.resolve("my_shapes.py:anywhere", OFFERED)("p", 0.4) == 0.4
    assert REGISTRY.load("my_shapes.py:Disc") is REGISTRY.load(f"{file}:Disc")
    REGISTRY.check("my_shapes.py:Disc")


def test_a_file_imports_what_lies_beside_it(file):
    (file.parent / "beside_my_shapes.py").write_text("RADIUS = 4.0\n")
    file.with_name("with_import.py").write_text("from beside_my_shapes import RADIUS\n" + SOURCE)
    assert REGISTRY.resolve("with_import.py:disc").radius == 7.0


def test_they_are_named_by_their_module(file, monkeypatch):
    monkeypatch.syspath_prepend(file.parent)
    assert REGISTRY.resolve("my_shapes:Disc", OFFERED).radius == 1.0
    assert REGISTRY.resolve("my_shapes:anywhere", OFFERED)("p", 0.5) == 0.5


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "trundle.geometry.solids:solids_bounds",
            r"is no shape. A shape is a name, an object with contains\(point\), a class",
        ),
        ("os:system", "is no shape"),
        ("subprocess:Popen", "is no shape"),
        ("trundle.geometry.solids:Nothing", "trundle.geometry.solids has no 'Nothing'"),
        ("trundle.geometry.solids:Sphre", "Did you mean 'Sphere'"),
        ("no_such_module:Shape", "there is no module 'no_such_module'; install its package, or give its file"),
        ("my_shapes_2:Shape", "there is no module 'my_shapes_2'; write my_shapes_2.py:Shape"),
        (":Shape", "write module:name or file.py:name"),
        ("trundle.geometry.solids:", "write module:name or file.py:name"),
        ("no_such.py:Shape", "there is no file no_such.py"),
        ("my_shapes.py:Half", r"has no contains\(point\)|is no shape"),
        ("my_shapes.py:make", "is no shape"),
        ("broken.py:Shape", r"ZeroDivisionError: division by zero \(.*broken.py:2\)"),
        ("unreadable.py:Shape", r"SyntaxError: .*unreadable.py, line 1"),
        ("needy.py:Shape", "No module named 'not_installed_at_all'"),
    ],
)
def test_a_name_that_stands_for_nothing_of_the_kind_says_why_and_calls_nothing(file, name, message):
    (file.parent / "my_shapes_2.py").write_text(SOURCE)
    (file.parent / "broken.py").write_text("\n1 / 0\n")
    (file.parent / "unreadable.py").write_text("class:\n")
    (file.parent / "needy.py").write_text("import not_installed_at_all\n")
    with pytest.raises(InputError, match=message):
        REGISTRY.resolve(name, OFFERED)
