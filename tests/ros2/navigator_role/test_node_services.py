"""/rosout, diagnostics and parameters of the node."""

from __future__ import annotations

from ros2.navigator_role.conftest import LATCHED, wait_for
from trundle.messages import Qos

PACKAGE = "rcl_interfaces/srv"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


def names_of(client, *prefixes):
    return list(client.call("/trundle/list_parameters", f"{PACKAGE}/ListParameters", prefixes=prefixes).result.names)


def test_parameters_can_be_listed_and_read(serve, client):
    serve()
    names = names_of(client)
    assert {"use_sim_time", "planner", "controller", "frames.base", "limits.linear_speed"} <= set(names)
    assert names_of(client, "frames") == ["frames.base", "frames.map", "frames.odom"]
    asked = ["use_sim_time", "robot", "limits.linear_speed", "seed", "unknown"]
    values = client.call("/trundle/get_parameters", f"{PACKAGE}/GetParameters", names=asked).values
    assert [one.type for one in values] == [1, 4, 3, 2, 0]
    assert values[0].bool_value
    assert values[1].string_value == "nova_carter"
    types = client.call("/trundle/get_parameter_types", f"{PACKAGE}/GetParameterTypes", names=asked).types
    assert list(types) == [1, 4, 3, 2, 0]
    described = client.call("/trundle/describe_parameters", f"{PACKAGE}/DescribeParameters", names=["robot"])
    assert described.descriptors[0].read_only


def test_parameters_cannot_be_set(serve, client):
    serve()
    parameter = client.types.make("rcl_interfaces/msg/Parameter", name="robot")
    (result,) = client.call("/trundle/set_parameters", f"{PACKAGE}/SetParameters", parameters=[parameter]).results
    assert not result.successful
    assert "command line" in result.reason


def test_reports_are_on_rosout(serve, client):
    served = serve()
    client.read("/rosout", "rcl_interfaces/msg/Log", LATCHED)
    client.publish("/goal_pose", client.pose(2.0, 2.0, frame="moon"))
    wait_for(lambda: served.counts)
    message = wait_for(lambda: client.got("/rosout"))[0]
    assert (message.level, message.name) == (30, "trundle")
    assert "'moon'" in message.msg


def test_diagnostics_say_what_the_navigator_does(serve, client):
    client.read("/diagnostics", DIAGNOSTICS, Qos())
    serve()
    goal = client.go(2.5, 1.5)
    goal.wait()
    wait_for(lambda: any(one.status[0].message == "arrived" for one in client.got("/diagnostics")))
    said = [(one.status[0].name, one.status[0].level) for one in client.got("/diagnostics")]
    assert set(said) == {("trundle: navigation", 0)}
