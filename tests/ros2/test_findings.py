from typing import Any

import pytest

from trundle.messages.codec import Codec
from trundle.messages.qos import CLOCK, LATCHED, SENSOR, Qos
from trundle.ros2 import findings
from trundle.ros2.findings import ClockSeen, Finding
from trundle.ros2.transport.transport import Endpoint, Graph, Offer

SCAN, TWIST, STAMPED = "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
MOVING = ClockSeen(301, 10.0, 13.0, 3.0)


def pub(topic: str, type_name: str, node: str, qos: Qos | None = None, **other: Any) -> Endpoint:
    return Endpoint("publisher", topic, type_name, other.get("type_hash", ""), qos or Qos(), node, "", False)


def sub(topic: str, type_name: str, node: str, qos: Qos | None = None, **other: Any) -> Endpoint:
    return Endpoint("subscription", topic, type_name, other.get("type_hash", ""), qos or Qos(), node, "", False)


def graph(*endpoints: Endpoint, offers: tuple[Offer, ...] = ()) -> Graph:
    return Graph(tuple(sorted({one.node for one in endpoints if one.node})), endpoints, offers)


def only(found: Any) -> Finding:
    (finding,) = list(found)
    return finding


def test_an_empty_network_is_a_note_that_says_what_to_try():
    found = only(findings.find_nodes(Graph()))
    assert (found.status, found.detail) == ("note", "no other node is seen")
    assert "ROS_DOMAIN_ID" in found.advice
    assert "--range subnet" in found.advice


def test_nodes_are_listed_without_our_own_and_the_tools():
    ours = Endpoint("publisher", "/check", SCAN, "", Qos(), "/trundle_check", "", True)
    seen = graph(ours, sub("/scan", SCAN, "/amcl"), sub("/scan", SCAN, "/_ros2cli_42"))
    assert only(findings.find_nodes(seen)).detail == "1: /amcl"


def test_nodes_that_wait_for_a_clock_are_a_problem():
    found = only(findings.find_clock(graph(sub("/clock", CLOCK_TYPE, "/amcl", CLOCK)), ClockSeen(0, 0.0, 0.0, 0.0)))
    assert found.status == "problem"
    assert "/amcl wait for it" in found.detail


def test_no_clock_and_nobody_who_waits_is_real_time():
    assert only(findings.find_clock(graph(sub("/scan", SCAN, "/amcl")), ClockSeen(0, 0.0, 0.0, 0.0))).status == "ok"


def test_a_moving_clock_has_its_rate_and_its_factor():
    seen = graph(pub("/clock", CLOCK_TYPE, "/sim"), sub("/clock", CLOCK_TYPE, "/amcl"), sub("/scan", SCAN, "/rviz"))
    clock, followed, not_followed = findings.find_clock(seen, MOVING)
    assert (clock.status, clock.detail) == ("ok", "/clock of /sim: 100 Hz, 1.00 x real time")
    assert followed.detail == "followed by /amcl"
    assert not_followed.status == "note"
    assert "/rviz" in not_followed.detail


@pytest.mark.parametrize(
    ("seen", "status", "text"),
    [
        (ClockSeen(0, 0.0, 0.0, 0.0), "problem", "no message came"),
        (ClockSeen(40, 7.0, 7.0, 3.0), "problem", "does not move (at 7.00 s)"),
        (ClockSeen(40, 7.0, 0.5, 3.0, went_back=True), "note", "went back to 0.50 s"),
        (ClockSeen(0, 0.0, 0.0, 0.0, unreadable=4), "problem", "4 messages on /clock of /sim are not"),
    ],
)
def test_a_clock_that_does_not_run_is_reported(seen, status, text):
    found = only(findings.find_clock(graph(pub("/clock", CLOCK_TYPE, "/sim")), seen))
    assert found.status == status
    assert text in found.detail
    assert found.advice


def test_two_clocks_are_a_problem_if_both_are_heard():
    seen = graph(pub("/clock", CLOCK_TYPE, "/sim"), pub("/clock", CLOCK_TYPE, "/gazebo"))
    found = next(findings.find_clock(seen, ClockSeen(301, 10.0, 13.0, 3.0, went_back=True, sources=2)))
    assert found.status == "problem"
    assert "2 of the 2 publishers of /gazebo, /sim" in found.detail


def test_a_silent_bridge_of_another_simulator_is_no_second_clock():
    seen = graph(pub("/clock", CLOCK_TYPE, "/trundle"), pub("/clock", CLOCK_TYPE, "/ros_gz_bridge"))
    found = next(findings.find_clock(seen, MOVING))
    assert (found.status, "of which 1 is silent" in found.detail) == ("ok", True)


def test_a_scan_that_nobody_publishes_is_a_problem_and_a_similar_one_is_offered():
    seen = graph(sub("/scan", SCAN, "/amcl", SENSOR), pub("/front/scan", SCAN, "/trundle", SENSOR))
    problem, unread = findings.find_unmatched(seen)
    assert (problem.about, problem.status) == ("/scan", "problem")
    assert "--remap front/scan:=/scan" in problem.advice
    assert (unread.status, unread.detail) == ("note", "published, and not read by anybody: /front/scan")


def test_topics_that_just_wait_are_a_note_and_those_of_every_node_are_not_mentioned():
    seen = graph(
        sub("/goal_pose", "geometry_msgs/msg/PoseStamped", "/bt_navigator"),
        pub("/rosout", "rcl_interfaces/msg/Log", "/bt_navigator"),
        sub("/clock", CLOCK_TYPE, "/bt_navigator"),
    )
    found = only(findings.find_unmatched(seen))
    assert (found.status, found.detail) == ("note", "read, and not published by anybody: /goal_pose")


def test_commands_that_nobody_reads_are_a_problem():
    found = only(findings.find_unmatched(graph(pub("/cmd_vel", TWIST, "/controller_server"))))
    assert found.status == "problem"
    assert "no robot gets these commands" in found.detail


def test_commands_from_two_nodes_are_a_note():
    seen = graph(pub("/cmd_vel", TWIST, "/a"), pub("/cmd_vel", TWIST, "/b"), sub("/cmd_vel", TWIST, "/trundle"))
    assert "/a, /b" in only(findings.find_commands(seen)).detail


@pytest.mark.parametrize(
    ("offered", "wanted", "text"),
    [
        (SENSOR, Qos(10), "it asks for reliable, and best effort is offered"),
        (Qos(1), LATCHED, "it asks for transient local, and volatile is offered"),
    ],
)
def test_qos_that_does_not_match_is_a_problem(offered, wanted, text):
    found = only(findings.find_qos(graph(pub("/map", SCAN, "/sim", offered), sub("/map", SCAN, "/rviz", wanted))))
    assert found.status == "problem"
    assert text in found.detail
    assert found.advice


def test_qos_that_matches_is_not_mentioned():
    for offered, wanted in ((Qos(10), SENSOR), (LATCHED, Qos(1)), (LATCHED, LATCHED), (SENSOR, SENSOR)):
        assert not list(
            findings.find_qos(graph(pub("/map", SCAN, "/sim", offered), sub("/map", SCAN, "/rviz", wanted)))
        )


def test_types_that_differ_on_one_topic_are_a_problem():
    found = only(
        findings.find_types(graph(pub("/cmd_vel", STAMPED, "/nav"), sub("/cmd_vel", TWIST, "/robot")), "humble")
    )
    assert found.status == "problem"
    assert "enable_stamped_cmd_vel" in found.advice


def test_a_robot_that_takes_both_types_of_commands_is_fine():
    seen = graph(
        pub("/cmd_vel", TWIST, "/nav"), sub("/cmd_vel", TWIST, "/trundle"), sub("/cmd_vel", STAMPED, "/trundle")
    )
    assert not list(findings.find_types(seen, "humble"))


RANGE = "sensor_msgs/msg/Range"
"""A type that changed between Humble and Jazzy."""


def test_hashes_tell_the_other_distribution():
    seen = graph(pub("/sonar", RANGE, "/old", type_hash=Codec("humble").type_hash(RANGE)))
    found = only(findings.find_types(seen, "jazzy"))
    assert found.status == "problem"
    assert found.detail == "/sonar: the other side has the types of humble, and here they are jazzy's"
    assert found.advice == "Give --distro humble"


def test_a_hash_of_no_distribution_is_a_problem():
    seen = graph(pub("/sonar", RANGE, "/odd", type_hash="RIHS01_" + 64 * "0"))
    found = only(findings.find_types(seen, "jazzy"))
    assert "no distribution that is known" in found.detail
    assert "--distro" not in found.advice


def test_the_hashes_of_the_distribution_are_not_mentioned():
    seen = graph(pub("/sonar", RANGE, "/new", type_hash=Codec("kilted").type_hash(RANGE)))
    assert not list(findings.find_types(seen, "kilted"))


def test_types_without_hashes_may_be_humbles():
    seen = graph(pub("/scan", SCAN, "/old"))
    found = only(findings.find_types(seen, "jazzy"))
    assert (found.status, "--distro humble" in found.advice) == ("note", True)
    assert not list(findings.find_types(seen, "humble"))


def test_a_client_that_nobody_answers_is_a_problem():
    client = Offer("action client", "/navigate_to_pose", "nav2_msgs/action/NavigateToPose", "/rviz", False)
    server = Offer("action server", "/navigate_to_pose", "nav2_msgs/action/NavigateToPose", "/bt_navigator", False)
    found = only(findings.find_unanswered(graph(offers=(client,))))
    assert found.status == "problem"
    assert "/rviz wants the action" in found.detail
    assert not list(findings.find_unanswered(graph(offers=(client, server))))
