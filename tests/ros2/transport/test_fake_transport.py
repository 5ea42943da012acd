"""The network in memory behaves as its users' tests rely on."""

from ros2.fake_transport import FakeNetwork
from trundle.messages import Qos

LATCHED = Qos(1, durability="transient_local")


def test_a_message_reaches_readers_of_its_type_with_a_compatible_qos() -> None:
    network = FakeNetwork()
    ours, theirs = network.transport("trundle"), network.transport("rviz")
    same = theirs.subscription("/scan", "a/msg/A", Qos(reliability="best_effort"))
    other = theirs.subscription("/scan", "a/msg/B", Qos())
    publisher = ours.publisher("/scan", "a/msg/A", Qos())
    publisher.write(b"1")
    (sample,) = same.take()
    assert (sample.data, sample.source) == (b"1", publisher.source)
    assert other.take() == []
    assert (publisher.matched, same.matched, other.matched) == (1, 1, 0)
    assert theirs.wait(0)
    assert not theirs.wait(0)


def test_a_late_joiner_gets_what_is_latched() -> None:
    network = FakeNetwork()
    publisher = network.transport().publisher("/map", "a/msg/A", LATCHED)
    publisher.write(b"old")
    publisher.write(b"new")
    late = network.transport("late")
    assert [one.data for one in late.subscription("/map", "a/msg/A", LATCHED).take()] == [b"new"]
    assert late.subscription("/map", "a/msg/A", Qos()).take() == []


def test_calls_and_goals_are_answered_by_dispatch() -> None:
    network = FakeNetwork()
    ours = network.transport()
    goals = []

    class Serve:
        def accepts(self, data: bytes) -> bool:
            return data != b"bad"

        def accepted(self, goal) -> None:
            goals.append(goal)

        def cancel(self, goal) -> bool:
            return True

    ours.service("/add", "a/srv/Add", lambda request: request * 2)
    ours.action("/go", "a/action/Go", Serve())
    call, good, bad = network.call("/add", b"x"), network.send_goal("/go", b"g"), network.send_goal("/go", b"bad")
    assert call.response is None
    ours.dispatch()
    assert (call.response, good.status, bad.status) == (b"xx", "executing", "rejected")
    network.cancel("/go", good)
    ours.dispatch()
    assert goals[0].cancel_requested
    goals[0].publish_feedback(b"f")
    goals[0].canceled(b"r")
    assert (good.status, good.feedback, good.result) == ("canceled", [b"f"], b"r")
    assert {offer.kind for offer in ours.graph().offers} == {"service server", "action server"}
