"""The states of Nav2's nodes, as a lifecycle manager changes them."""

from __future__ import annotations

from trundle.ros2.navigator_role.lifecycle import NODES

CONFIGURE, CLEANUP, ACTIVATE, DEACTIVATE = 1, 2, 3, 4
GET, CHANGE = "lifecycle_msgs/srv/GetState", "lifecycle_msgs/srv/ChangeState"


def change(client, node, number=0, label=""):
    transition = client.types.make("lifecycle_msgs/msg/Transition", id=number, label=label)
    return client.call(f"/{node}/change_state", CHANGE, transition=transition).success


def state(client, node):
    return client.call(f"/{node}/get_state", GET).current_state.label


def test_a_manager_brings_all_nodes_up(serve, client):
    serve()
    for number, after in ((CONFIGURE, "inactive"), (ACTIVATE, "active")):
        for node in NODES:
            assert change(client, node, number)
            assert state(client, node) == after
    assert client.go(2.5, 1.5).status == "executing"


def test_goals_are_refused_while_one_node_is_not_active(serve, client):
    serve()
    running = client.go(2.5, 3.0)
    assert change(client, "controller_server", DEACTIVATE)
    assert running.wait().error_msg == "controller_server is inactive: a lifecycle manager made it so"
    assert state(client, "planner_server") == "active"
    assert client.go(2.5, 1.5).status == "rejected"
    assert not client.call("/lifecycle_manager_navigation/is_active", "std_srvs/srv/Trigger").success
    assert change(client, "controller_server", label="activate")
    assert client.go(2.5, 1.5).status == "executing"


def test_transitions_that_nav2_does_not_have_fail(serve, client):
    serve()
    assert not change(client, "amcl", ACTIVATE)  # it is active
    assert not change(client, "amcl", 99)
    assert change(client, "amcl", DEACTIVATE)
    assert change(client, "amcl", CLEANUP)
    assert not change(client, "amcl", ACTIVATE)
    assert state(client, "amcl") == "unconfigured"


def test_resetting_takes_two_transitions_in_reverse_order(serve, client):
    serve()
    for number, after in ((DEACTIVATE, "inactive"), (CLEANUP, "unconfigured")):
        for node in reversed(NODES):
            assert change(client, node, number)
            assert state(client, node) == after
