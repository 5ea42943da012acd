"""Tests of reading ROS 2 parameter files by node."""

import pytest

from trundle.errors import InputError
from trundle.nav2.parameters import ParameterFile


def test_nested_and_dotted_names_are_the_same(write):
    file = ParameterFile(write("a:\n  ros__parameters:\n    p: {q: 1.0, r.s: 2}\n    p.t: true\n"))
    node = file.node("a")
    assert node.of_plugin("p").number("q", 0.0) == 1.0
    assert node.number("p.r.s", 0.0) == 2.0
    assert node.of_plugin("p").flag("t", False)


@pytest.mark.parametrize(
    "text",
    [
        "local_costmap:\n  local_costmap:\n    ros__parameters: {width: 3}\n",
        "local_costmap/local_costmap:\n  ros__parameters: {width: 3}\n",
        "/local_costmap/local_costmap:\n  ros__parameters: {width: 3}\n",
        "local_costmap:\n  ros__parameters: {width: 3}\n",
        "robot1:\n  local_costmap:\n    local_costmap:\n      ros__parameters: {width: 3}\n",
        "/<robot_namespace>/local_costmap/local_costmap:\n  ros__parameters: {width: 3}\n",
        "/**/local_costmap:\n  local_costmap:\n    ros__parameters: {width: 3}\n",
    ],
)
def test_a_node_is_found_in_a_namespace_and_under_its_full_name(write, text):
    assert ParameterFile(write(text)).node("local_costmap").number("width", 0.0) == 3.0


def test_wildcards_hold_for_every_node_and_the_later_one_counts(write):
    text = "/**:\n  ros__parameters: {a: 1, b: 1}\nx:\n  ros__parameters: {b: 2, c: 2}\n"
    first = ParameterFile(write(text)).node("x")
    assert [first.number(name, 0.0) for name in "abc"] == [1.0, 2.0, 2.0]
    later = ParameterFile(write("x:\n  ros__parameters: {b: 2}\n/**:\n  ros__parameters: {b: 1}\n")).node("x")
    assert later.number("b", 0.0) == 1.0


def test_a_wildcard_alone_is_no_node(write):
    file = ParameterFile(write("/**:\n  ros__parameters: {use_sim_time: true}\n"))
    assert file.node("amcl") is None
    assert [(node, parameter.name) for node, parameter in file.unread()] == [("/**", "use_sim_time")]


def test_what_was_read_is_no_longer_listed(write):
    file = ParameterFile(write("a:\n  ros__parameters: {x: 1, y: 2}\nb:\n  ros__parameters: {z: 3}\n"))
    file.node("a").number("x", 0.0)
    file.node("a").number("missing", 0.0)
    assert [(node, parameter.name, parameter.line) for node, parameter in file.unread()] == [
        ("a", "y", 2),
        ("b", "z", 4),
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: {b: 1}\n", r"nav2_params.yaml:1:5: 'b' in a is not under ros__parameters"),
        ("image: map.png\nresolution: 0.05\n", "'image' in the file is not under ros__parameters"),
        ("[1, 2]\n", "no ROS 2 parameter file"),
        ("a:\n", "no ROS 2 parameter file"),
        ("ros__parameters: {a: 1}\n", "under the name of a node"),
        ("a:\n  ros__parameters: [1]\n", "must be a mapping"),
        ("a: &x\n  ros__parameters: {a: 1}\nb: *x\n", "anchors and aliases"),
        ("a:\n  ros__parameters: {[a]: 1}\n", "a key must be a plain name"),
        ("a:\n  ros__parameters: " + "{b: " * 60 + "1" + "}" * 60 + "\n", "nested more than"),
        ("a:\n  ros__parameters: {a: '" + "x" * 300_000 + "'}\n", "larger than"),
        ("a:\n  ros__parameters: {a: [1, 2}\n", "not valid YAML"),
        (
            "r1:\n  a:\n    ros__parameters: {x: 1}\nr2:\n  a:\n    ros__parameters: {x: 2}\n",
            "for several robots, /r1 and /r2",
        ),
    ],
)
def test_files_that_cannot_be_used_are_refused(write, text, message):
    with pytest.raises(InputError, match=message):
        ParameterFile(write(text)).node("a")


@pytest.mark.parametrize(
    ("text", "value", "lines", "counts"),
    [
        ("a:\n  ros__parameters:\n    x: 1.5\n    x: 2.5\n", 2.5, (3, 4), 4),
        ("a:\n  ros__parameters:\n    p: {x: 1}\n    p.x: 2\n", 2, (3, 4), 4),
        ("a:\n  ros__parameters: {x: 1}\na:\n  ros__parameters: {x: 2, y: 3}\n", 2, (2, 4), 4),
        ("a:\n  ros__parameters:\n    x: 1\n    x: 0.5\n", 1, (3, 4), 3),  # the integer is looked for first
        ("a:\n  ros__parameters:\n    x: 'no'\n    x: true\n", True, (3, 4), 4),
        ("a:\n  ros__parameters:\n    x: [1, 2]\n    x: 3\n    x: [4]\n", 3, (4, 5), 4),
    ],
)
def test_what_is_given_twice_counts_as_in_ros(write, text, value, lines, counts):
    file = ParameterFile(write(text))
    name = "p.x" if "p.x" in text else "x"
    found = file.node("a").find(name)
    assert (found.value, type(found.value), found.line) == (value, type(value), counts)
    last = file.repeated[-1]
    assert (last.node, last.first, last.second, last.counts) == ("a", *lines, found)
    assert file.nodes() == ["a"]


@pytest.mark.parametrize("value", [".nan", ".inf", "abc", "true", "[1]", "''", "null"])
def test_a_number_must_be_one_and_the_message_names_file_line_node_and_parameter(write, value):
    node = ParameterFile(write(f"a:\n  ros__parameters:\n    p.q: {value}\n")).node("a")
    with pytest.raises(InputError, match=r"nav2_params.yaml:3:5: a: p.q must be a finite number, got "):
        node.number("p.q", 0.0)


def test_other_types_are_checked_too(write):
    node = ParameterFile(write("a:\n  ros__parameters: {t: 1.5, l: [1, x], n: [1, .nan, 3]}\n")).node("a")
    for read, message in (
        (lambda: node.integer("t", 0), "must be an integer"),
        (lambda: node.flag("t", False), "must be true or false"),
        (lambda: node.text("t", ""), "must be text"),
        (lambda: node.texts("l", ()), "must be a list of names"),
        (lambda: node.numbers("n", (), lengths=(3, 6)), "must be a list of 3 or 6 finite numbers"),
        (lambda: node.number("t", 0.0, least=2.0), "must be at least 2, got 1.5"),
        (lambda: node.number("t", 0.0, most=1.0), "must be at most 1, got 1.5"),
    ):
        with pytest.raises(InputError, match=message):
            read()
