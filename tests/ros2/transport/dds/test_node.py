"""Two nodes in this process, on a domain of their own."""

import threading
from functools import cache

import pytest

from ros2.transport.dds.conftest import Open, received, until
from trundle.errors import InputError, UnknownNameError
from trundle.messages import Codec, Qos
from trundle.messages.qos import LATCHED
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.transport import Transport

TEXT = "std_msgs/msg/String"
TWIST = "geometry_msgs/msg/Twist"
STAMPED = "geometry_msgs/msg/TwistStamped"
BEST_EFFORT = Qos(5, "best_effort")


@cache
def codec() -> Codec:
    return Codec("jazzy")


def text(data: str) -> bytes:
    return codec().encode(codec().make(TEXT, data=data))


def twist(x: float) -> object:
    def vector(x: float) -> object:
        return codec().make("geometry_msgs/msg/Vector3", x=x, y=0.0, z=0.0)

    return codec().make(TWIST, linear=vector(x), angular=vector(0.0))


def test_it_is_a_transport_that_states_what_is_off_and_what_is_open(open_node: Open, domain: int) -> None:
    node: Transport = open_node("robot", namespace="/fleet")
    assert (node.name, node.node, node.distro, node.lost) == ("dds", "/fleet/robot", "jazzy", "")
    assert node.rmw.startswith("cyclonedds ")
    services, ports = node.notes
    assert "--transport rclpy" in services
    assert str(7400 + 250 * domain) in ports
    assert node.definition(TEXT) == ""


def test_a_message_wakes_its_reader_and_names_its_source(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    subscription, publisher = theirs.subscription("/t", TEXT, Qos()), ours.publisher("/t", TEXT, Qos())
    until(lambda: publisher.matched == 1 and subscription.matched == 1, "a match")
    assert subscription.take() == []
    publisher.write(text("hello"))
    (sample,) = received(theirs, subscription, 1)
    assert sample.data == text("hello")
    (endpoint,) = theirs.graph().publishers("/t")
    assert (sample.source, endpoint.ours, endpoint.node) == (endpoint.source, False, "/trundle")


def test_a_node_does_not_hear_itself(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    publisher, own = ours.publisher("/tf", TEXT, Qos()), ours.subscription("/tf", TEXT, Qos())
    subscription = theirs.subscription("/tf", TEXT, Qos())
    until(lambda: subscription.matched == 1 and publisher.matched == 1, "a match")
    publisher.write(text("x"))
    assert [one.data for one in received(theirs, subscription, 1)] == [text("x")]
    assert (publisher.matched, own.matched, own.take()) == (1, 0, [])
    until(lambda: len(theirs.endpoints("/tf")) == 3 and len(ours.endpoints("/tf")) == 3, "all to be seen")
    (writer,) = (one for one in theirs.endpoints("/tf") if one.kind == "publisher")
    assert (writer.node, writer.ours) == ("/trundle", False)
    assert {(one.node, one.ours) for one in ours.endpoints("/tf")} == {("/trundle", True), ("/theirs", False)}
    assert ours.endpoints("/other") == ()


def test_a_late_joiner_gets_the_last_latched_message_alone(open_node: Open) -> None:
    publisher = open_node().publisher("/map", TEXT, LATCHED)
    for word in ("old", "newer", "newest"):
        publisher.write(text(word))
    late = open_node("late")
    volatile = late.subscription("/map", TEXT, Qos())
    subscription = late.subscription("/map", TEXT, LATCHED)
    assert [one.data for one in received(late, subscription, 1)] == [text("newest")]
    until(lambda: volatile.matched == 1, "a match")
    assert volatile.take() == []


def test_a_subscription_that_asks_for_more_than_is_offered_gets_nothing(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    publisher = ours.publisher("/scan", TEXT, BEST_EFFORT)
    reliable = theirs.subscription("/scan", TEXT, Qos())
    latched = theirs.subscription("/scan", TEXT, Qos(1, "best_effort", "transient_local"))
    same = theirs.subscription("/scan", TEXT, BEST_EFFORT)
    until(lambda: publisher.matched == 1, "a match")
    publisher.write(text("x"))
    assert [one.data for one in received(theirs, same, 1)] == [text("x")]
    assert (reliable.matched, latched.matched, reliable.take(), latched.take()) == (0, 0, [], [])


def test_two_types_on_one_topic_are_two_streams(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    plain, stamped = (ours.subscription("/cmd_vel", name, Qos()) for name in (TWIST, STAMPED))
    publishers = [theirs.publisher("/cmd_vel", name, Qos()) for name in (TWIST, STAMPED)]
    until(lambda: all(one.matched == 1 for one in publishers), "a match")
    header = codec().make(
        "std_msgs/msg/Header", stamp=codec().make("builtin_interfaces/msg/Time", sec=1, nanosec=2), frame_id=""
    )
    messages = [codec().encode(twist(0.5)), codec().encode(codec().make(STAMPED, header=header, twist=twist(0.7)))]
    for publisher, data in zip(publishers, messages, strict=True):
        publisher.write(data)
    assert [one.data for one in received(ours, plain, 1)] == messages[:1]
    assert [one.data for one in received(ours, stamped, 1)] == messages[1:]
    assert theirs.graph().topics()["/cmd_vel"] == (TWIST, STAMPED)


def test_a_flood_is_bounded_and_counted(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    subscription = ours.subscription("/t", TEXT, Qos(3))
    publisher = theirs.publisher("/t", TEXT, Qos(3))
    until(lambda: publisher.matched == 1, "a match")
    for number in range(2000):
        publisher.write(text(str(number)))
    until(lambda: ours.wait(0.0), "messages")
    taken = subscription.take()
    assert len(taken) == 3
    assert 0 < subscription.dropped <= 1997
    assert taken[-1].data == text("1999")


def test_bytes_that_are_not_of_the_type_are_refused_here_and_not_delivered(open_node: Open) -> None:
    ours = open_node()
    publisher = ours.publisher("/t", TEXT, Qos())
    for garbage in (text("hello")[:-3], b"", b"\0\1\0\0\xff\xff\xff\xff", b"garbage"):
        with pytest.raises(InputError, match="/t is not a std_msgs/msg/String"):
            publisher.write(garbage)
    with pytest.raises(UnknownNameError, match="no_msgs"):
        ours.publisher("/t", "no_msgs/msg/Such", Qos())
    with pytest.raises(InputError, match="topic"):
        ours.subscription("t", TEXT, Qos())


def test_services_and_actions_are_never_offered(open_node: Open) -> None:
    node = open_node()
    assert not node.has_services
    with pytest.raises(InputError, match="--transport rclpy"):
        node.service("/add", "std_srvs/srv/Trigger", lambda request: request)
    with pytest.raises(InputError, match="--transport rclpy"):
        node.action("/go", "nav2_msgs/action/Spin", None)  # pyright: ignore[reportArgumentType]
    node.dispatch()
    assert node.graph().offers == ()


def test_a_wait_ends_by_wake_and_by_close(open_node: Open) -> None:
    node = open_node()
    results = []
    for end in (node.wake, node.close):
        started = threading.Event()

        def wait(started: threading.Event = started) -> None:
            started.set()
            results.append(node.wait(60.0))

        thread = threading.Thread(target=wait)
        thread.start()
        started.wait()
        end()
        thread.join(20.0)
        assert not thread.is_alive()
    assert results == [True, False]
    assert not node.wait(60.0)


def test_the_graph_has_nodes_topics_and_quality_of_service(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs", namespace="/ns")
    ours.publisher("/map", TEXT, LATCHED)
    theirs.subscription("/map", TEXT, BEST_EFFORT)
    until(lambda: len(ours.graph().endpoints) == 2 and len(ours.graph().nodes) == 2, "both nodes")
    graph = ours.graph()
    assert graph.nodes == ("/ns/theirs", "/trundle")
    (publisher,), (subscription,) = graph.publishers("/map"), graph.subscriptions("/map")
    assert (publisher.node, publisher.ours, publisher.type_hash) == ("/trundle", True, codec().type_hash(TEXT))
    assert publisher.qos == LATCHED
    assert (subscription.node, subscription.ours) == ("/ns/theirs", False)
    assert (subscription.qos.reliability, subscription.qos.durability) == ("best_effort", "volatile")
    theirs.close()
    until(lambda: ours.graph().nodes == ("/trundle",), "theirs to leave")
    assert ours.graph().subscriptions("/map") == ()


def test_the_graph_is_read_only_where_it_has_changed(open_node: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    ours, theirs = open_node(), open_node("theirs")
    ours.publisher("/map", TEXT, LATCHED)
    until(lambda: len(ours.graph().nodes) == 2 and len(ours.graph().endpoints) == 1, "both nodes")
    reads: list[str] = []
    for kind, reader in ours._discovery._builtin.items():
        read = reader.read
        monkeypatch.setattr(
            reader, "read", lambda *of, kind=kind, read=read, **how: (reads.append(kind), read(*of, **how))[1]
        )

    def reads_nothing() -> bool:
        reads.clear()
        assert len(ours.graph().endpoints) == 1
        return not reads

    until(reads_nothing, "all to be read that came late")
    theirs.subscription("/map", TEXT, BEST_EFFORT)
    until(lambda: len(ours.graph().endpoints) == 2, "their subscription")
    assert set(reads) == {"subscription"}


def test_after_close_nothing_is_sent_and_nothing_fails(open_node: Open) -> None:
    node = open_node()
    publisher, subscription = node.publisher("/t", TEXT, Qos()), node.subscription("/t", TEXT, Qos())
    node.close()
    node.close()
    publisher.write(text("x"))
    assert (publisher.matched, subscription.matched, subscription.take(), publisher.dropped) == (0, 0, [], 0)
    assert node.graph().nodes == ()
    node.wake()


def test_opening_and_closing_leaves_no_threads(domain: int) -> None:
    from pathlib import Path

    def tasks() -> int:
        return len(list(Path("/proc/self/task").iterdir()))

    if not Path("/proc/self/task").exists():
        pytest.skip("no /proc here")
    before = tasks()
    for _ in range(3):
        node = DdsTransport(Settings(domain=domain))
        node.subscription("/t", TEXT, Qos())
        node.close()
    until(lambda: tasks() <= before, "threads to end")


def test_writing_is_safe_from_several_threads(open_node: Open) -> None:
    ours, theirs = open_node(), open_node("theirs")
    publisher, subscription = ours.publisher("/t", TEXT, Qos(1000)), theirs.subscription("/t", TEXT, Qos(1000))
    until(lambda: publisher.matched == 1, "a match")

    def write(name: str) -> None:
        for number in range(100):
            publisher.write(text(f"{name} {number}"))

    threads = [threading.Thread(target=write, args=(name,)) for name in "abc"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    words = [codec().decode(TEXT, one.data).data.split() for one in received(theirs, subscription, 300)]
    for name in "abc":
        assert [int(number) for who, number in words if who == name] == list(range(100))


def test_a_domain_is_shared_within_a_process_unless_its_range_differs(open_node: Open, domain: int) -> None:
    open_node()
    with pytest.raises(InputError, match="another range"):
        DdsTransport(Settings(domain=domain, range="subnet"))
    again = DdsTransport(Settings(domain=domain))
    again.close()
    assert open_node("third").node == "/third"


def test_a_faulty_configuration_of_the_user_is_reported(domain: int) -> None:
    settings = Settings(
        domain=domain, range="subnet", cyclonedds_uri="<CycloneDDS><Domain><Nonsense/></Domain></CycloneDDS>"
    )
    with pytest.raises(InputError, match="CYCLONEDDS_URI"):
        DdsTransport(settings)
