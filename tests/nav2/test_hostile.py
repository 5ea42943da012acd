"""Parameter files with values that nobody meant: they are read, or refused with a message; nothing else happens."""

from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import AngleWarning, InputError
from trundle.mission import Scenario
from trundle.nav2 import read_nav2_params

DATA = Path(__file__).parent / "data"
NODES = {name: yaml.safe_load((DATA / f"{name}.yaml").read_text()) for name in ("jazzy", "kilted")}

VALUES = st.one_of(
    st.sampled_from(
        [None, True, "", "x", "[[", [], [1], ["a", 1], 0, -1, 1e300, -1e300, 1e-300, 10**30, 10**400, float("nan")]
    ),
    st.sampled_from(
        ["::", "a/b", "nav2_mppi_controller::MPPIController", "[[0, 0], [0, 0], [0, 0]]", "$(var x)", "../.."]
    ),
    st.floats(),
    st.integers(-(10**12), 10**12),
    st.lists(st.floats(-10.0, 10.0), max_size=7),
    st.text(max_size=8),
)


def leaves(node, path=()):
    for key, value in node.items():
        if isinstance(value, dict):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key)


LEAVES = [(name, path) for name, nodes in NODES.items() for path in leaves(nodes)]


def replaced(node, path, value):
    first, *rest = path
    return {**node, first: replaced(node[first], rest, value) if rest else value}


@pytest.mark.filterwarnings("ignore::trundle.errors.AngleWarning")
@given(where=st.sampled_from(LEAVES), value=VALUES, robot=st.sampled_from(["nova_carter", "turtlebot3_burger", None]))
def test_a_wrong_value_is_refused_or_makes_a_scenario(where, value, robot, tmp_path_factory):
    name, path = where
    file = tmp_path_factory.getbasetemp() / "hostile.yaml"
    file.write_text(yaml.safe_dump(replaced(NODES[name], path, value), allow_unicode=True), encoding="utf-8")
    try:
        settings = read_nav2_params(file, robot).settings
    except InputError as error:
        message = str(error)
    else:
        Scenario.make(**{"world": "warehouse", **settings})
        return
    assert "hostile.yaml" in message


def test_an_angle_in_degrees_is_warned_of(tmp_path):
    file = tmp_path / "params.yaml"
    file.write_text("amcl:\n  ros__parameters: {set_initial_pose: true, initial_pose: {x: 1.0, y: 2.0, yaw: 90.0}}\n")
    with pytest.warns(AngleWarning):
        read_nav2_params(file)


@pytest.mark.parametrize(
    ("path", "found"),
    [
        (
            ("local_costmap", "local_costmap", "ros__parameters", "inflation_layer", "inflation_radius"),
            "inflation_radius",
        ),
        (("local_costmap", "local_costmap", "ros__parameters", "footprint"), "footprint"),
        (("velocity_smoother", "ros__parameters", "max_velocity"), "max_velocity"),
    ],
)
@pytest.mark.parametrize("number", [10**400, 1 << 40_000], ids=["400 digits", "12,000 digits"])
def test_an_integer_that_no_float_can_hold_is_refused_with_its_line(path, found, number, tmp_path):
    text = hex(number) if number.bit_length() > 2000 else str(number)
    value = {"footprint": f"[[{text}, 0.2], [-0.3, 0.2], [0.1, -0.3]]", "max_velocity": f"[{text}, 0.0, 1.0]"}.get(
        found, text
    )
    file = tmp_path / "hostile.yaml"
    content = yaml.safe_dump(replaced(NODES["jazzy"], path, "HERE"), allow_unicode=True)
    file.write_text(content.replace("HERE", f"'{value}'" if found == "footprint" else value))
    with pytest.raises(InputError, match=rf"hostile\.yaml:\d+.*{found}"):
        read_nav2_params(file, "nova_carter")
