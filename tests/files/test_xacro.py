"""Plain xacro in a URDF."""

import itertools
import random
from pathlib import Path

import pytest

from trundle.errors import RobotError
from trundle.files.xacro import expand_xacro
from trundle.files.xml_elements import parse_xml


def expand(body, path="bot.urdf.xacro"):
    text = f'<robot name="bot" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>'
    root = parse_xml(path, text.encode(), error=RobotError)
    expand_xacro(Path(path), root, error=RobotError)
    return root


def value(expression, definitions=""):
    return expand(f'{definitions}<box size="{expression}"/>').find("box").get("size")


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("${1 + 2 * 3}", 7.0),
        ("${-(0.5 - 1) / 2}", 0.25),
        ("${2 ** 3}", 8.0),
        ("${7 // 2 + 7 % 2}", 4.0),
        ("${pi / 2}", 1.5707963267948966),
        ("${math.pi}", 3.141592653589793),
        ("${sin(radians(90)) + max(1, 2)}", 3.0),
        ("${sqrt(hypot(3, 4) + 4)}", 3.0),
    ],
)
def test_arithmetic_is_computed(expression, expected):
    assert float(value(expression)) == pytest.approx(expected)


def test_properties_and_arguments_stand_for_their_values():
    definitions = (
        '<xacro:property name="radius" value="${width / 2}"/><xacro:property name="width" value="0.3"/>'
        '<xacro:arg name="prefix" default="front_"/><xacro:property name="color" value="red"/>'
    )
    root = expand(f'{definitions}<link name="$(arg prefix)wheel" c="${{color}}" r="${{radius}} 0 ${{-width}}"/>')
    link = root.find("link")
    assert link.attrib == {"name": "front_wheel", "c": "red", "r": "0.15 0 -0.3"}
    assert [child.tag for child in root] == ["link"]


def test_a_doubled_dollar_is_a_dollar():
    assert value("$${x}") == "${x}"


def test_a_file_without_xacro_stays_as_it_is():
    assert value("0.1 0.2 0.3") == "0.1 0.2 0.3"


@pytest.mark.parametrize(
    "body",
    [
        '<xacro:macro name="wheel" params="side"><link name="a"/></xacro:macro>',
        '<xacro:include filename="other.xacro"/>',
        '<xacro:if value="1"><link name="a"/></xacro:if>',
        '<xacro:wheel side="left"/>',
        '<xacro:arg name="prefix"/>',
        '<mesh filename="$(find bot)/hull.stl"/>',
        '<xacro:property name="a" value="1"/><box size="${b}"/>',
        "<box size=\"${__import__('os').getcwd()}\"/>",
        '<box size="${[1 for i in range(9)]}"/>',
        '<box size="${1 if 2 > 1 else 3}"/>',
        '<box size="${1 / 0}"/>',
        '<box size="${9 ** 9 ** 9}"/>',
        '<box size="${1 +}"/>',
        '<xacro:property name="a" value="' + "9" * 900 + '"/><box size="${a * a * a * a * a * a}"/>',
    ],
)
def test_more_than_plain_xacro_says_which_command_expands_it(body):
    with pytest.raises(RobotError, match=r"bot\.urdf\.xacro:1: .*ros2 run xacro xacro bot\.urdf\.xacro > bot_expanded"):
        expand(body)


@pytest.mark.parametrize(
    "definitions",
    [
        '<xacro:property name="a" value="${a}"/>',
        '<xacro:property name="a" value="${b + 1}"/><xacro:property name="b" value="${a}"/>',
        "".join(
            f'<xacro:property name="{name}" value="${{{below}}}${{{below}}}"/>'
            for name, below in itertools.pairwise("abcdefghijkl")
        )
        + '<xacro:property name="l" value="xxxxxxxx"/>',
    ],
)
def test_definitions_without_an_end_are_refused(definitions):
    with pytest.raises(RobotError, match=r"refers to itself|longer than"):
        value("${a}", definitions)


def test_doubling_numbers_end_at_once():
    names = [f"n{i}" for i in range(40)]
    chain = "".join(
        f'<xacro:property name="{name}" value="${{{below} + {below}}}"/>' for name, below in itertools.pairwise(names)
    )
    assert float(value("${n0}", chain + '<xacro:property name="n39" value="1"/>')) == 2.0**39


def test_any_expression_ends_in_a_value_or_in_one_error():
    rng = random.Random(0)
    pieces = [
        "1",
        "a",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "**",
        "%",
        "sin",
        ",",
        ".",
        "'x'",
        "[",
        "]",
        "if",
        "9e99",
        " ",
        "pi",
    ]
    computed = 0
    for _ in range(2_000):
        expression = "".join(rng.choices(pieces, k=rng.randint(1, 6)))
        try:
            value(f"${{{expression}}}", '<xacro:property name="a" value="0.5"/>')
        except RobotError:
            continue
        computed += 1
    assert computed > 50
