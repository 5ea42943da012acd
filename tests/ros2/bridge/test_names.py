"""Names on the network: namespaces, remaps and what ROS allows."""

import pytest

from trundle.errors import InputError
from trundle.ros2.names import Names, read_remap


@pytest.mark.parametrize(
    ("name", "full"),
    [
        ("scan", "/fleet/r1/scan"),
        ("front/scan", "/fleet/r1/front/scan"),
        ("/tf", "/tf"),
        ("~/status", "/fleet/r1/trundle/status"),
        ("{node}/status", "/fleet/r1/trundle/status"),
        ("/{ns}/scan", "/fleet/r1/scan"),
        ("rostopic://scan", "/fleet/r1/scan"),
    ],
)
def test_relative_and_private_names_get_the_namespace(name: str, full: str) -> None:
    assert Names(namespace="fleet/r1").resolve(name) == full


def test_without_a_namespace_names_are_at_the_root() -> None:
    names = Names()
    assert (names.resolve("scan"), names.resolve("~/x"), names.namespace) == ("/scan", "/trundle/x", "/")


def test_the_first_remap_that_fits_is_used_and_only_once() -> None:
    names = Names(remaps=["scan:=/front/scan", "scan:=/other", "/front/scan:=/never"])
    assert names.resolve("scan") == "/front/scan"
    assert names.resolve("/scan") == "/front/scan"
    assert names.resolve("/front/scan") == "/never"


def test_remaps_are_relative_to_the_namespace_on_both_sides() -> None:
    names = Names(namespace="/r1", remaps=["/tf:=tf", ("odom", "~/odom")])
    assert names.resolve("/tf") == "/r1/tf"
    assert names.resolve("odom") == "/r1/trundle/odom"


def test_special_remaps_set_the_namespace_and_the_node() -> None:
    names = Names(remaps=["__ns:=/r2", "__node:=sim", "scan:=~/scan"])
    assert (names.namespace, names.node) == ("/r2", "sim")
    assert names.resolve("scan") == "/r2/sim/scan"


def test_frames_get_the_prefix() -> None:
    assert Names(frame_prefix="r1/").frame("odom") == "r1/odom"


@pytest.mark.parametrize(
    "name", ["", "/", "scan/", "a//b", "1scan", "a/2b", "my scan", "scan-1", "~scan", "~", "{what}/x", "x" * 300]
)
def test_names_that_ros_does_not_allow_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"name|unknown"):
        Names().resolve(name)


@pytest.mark.parametrize("remap", ["scan", "scan:=", ":=x", "a:=b:=c"])
def test_a_remap_needs_both_sides(remap: str) -> None:
    with pytest.raises(InputError, match="FROM:=TO"):
        read_remap(remap)


def test_bad_namespaces_nodes_and_prefixes_are_refused() -> None:
    with pytest.raises(InputError, match="no name in ROS"):
        Names(namespace="r 1")
    with pytest.raises(InputError, match="name of a node"):
        Names(node="my node")
    with pytest.raises(InputError, match="prefix of frames"):
        Names(frame_prefix="/r1")
