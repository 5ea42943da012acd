"""Fixed frames are published where nobody else publishes them."""

from __future__ import annotations

import time
from functools import cache
from types import SimpleNamespace

import pytest

from ros2.fake_transport import FakeNetwork
from trundle.geometry import Pose2D
from trundle.messages import Codec, MessageMaker, Qos
from trundle.ros2.names import Names
from trundle.ros2.static_frames import StaticFrames
from trundle.ros2.types import Types
from trundle.ros2.wire import Wire

TF, LATCHED = "tf2_msgs/msg/TFMessage", Qos(10, durability="transient_local")


@cache
def codec():
    return Codec("jazzy")


def frame(child, x=0.1, parent="base_link"):
    return MessageMaker(codec()).transform(0.0, parent, child, Pose2D(x, 0.0, 0.3), 0.2)


class Other:
    """Another node with fixed frames of its own, and what it hears."""

    def __init__(self, network):
        self.transport = network.transport("robot_state_publisher")
        self.heard = network.transport("listener").subscription("/tf_static", TF, LATCHED)

    def publish(self, *frames):
        message = MessageMaker(codec()).transforms(frames)
        self.transport.publisher("/tf_static", TF, LATCHED).write(codec().encode(message))

    def last_of_trundle(self):
        samples = self.heard.take()
        return [one.child_frame_id for one in codec().decode(TF, samples[-1].data).transforms] if samples else None


@pytest.fixture
def make():
    network, wires, said = FakeNetwork(), [], []

    def make(frames, **options):
        transport = network.transport()
        wires.append(Wire(transport, Types(codec(), transport), Names(), report=said.append))
        made = StaticFrames(wires[0], frames, **options)
        made.open()
        wires[0].start()
        return made

    yield network, make, said
    for wire in wires:
        wire.close()


def until(true):
    end = time.monotonic() + 60.0
    while not true():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_frames_that_nobody_publishes_are_published_after_the_wait(make, monkeypatch):
    network, serve, _ = make
    other = Other(network)
    now = [100.0]
    monkeypatch.setattr("trundle.ros2.static_frames.clock", SimpleNamespace(monotonic=lambda: now[0]))
    made = serve([frame("base_scan"), frame("imu_link")], patience_s=1.5)
    now[0] += 1.0
    time.sleep(0.3)
    assert made.published == ()
    now[0] += 1.0
    until(lambda: made.published)
    assert other.last_of_trundle() == ["base_scan", "imu_link"]


def test_a_frame_of_another_node_is_left_to_it(make):
    network, serve, said = make
    other = Other(network)
    other.publish(frame("base_scan", 0.12))
    made = serve([frame("base_scan"), frame("imu_link")], patience_s=0.2)
    until(lambda: made.published)
    assert made.published == ("imu_link",)
    assert any("robot_state_publisher publishes the static frames base_scan" in text for text in said)


def test_a_frame_is_withdrawn_when_another_node_comes_later(make):
    network, serve, _ = make
    other = Other(network)
    made = serve([frame("base_scan"), frame("imu_link")], patience_s=0.0)
    assert made.published == ("base_scan", "imu_link")
    other.publish(frame("base_scan", parent="other_base"))
    until(lambda: made.published == ("imu_link",))
    assert other.last_of_trundle() == ["imu_link"]


def test_a_sensor_in_two_places_is_reported(make):
    network, serve, said = make
    made = serve([frame("base_scan", 0.1)], patience_s=0.0)
    Other(network).publish(frame("base_scan", 0.5))
    until(lambda: not made.published)
    assert any("has the frame base_scan 0.40 m from where" in text for text in said)


def test_always_publishes_at_once_and_never_does_not(make):
    network, serve, _ = make
    other = Other(network)
    other.publish(frame("base_scan", 0.7))
    other.heard.take()
    assert serve([frame("base_scan")], mode="never").published == ()
    assert other.last_of_trundle() is None
    made = serve([frame("base_scan")], mode="always")
    time.sleep(0.3)
    assert made.published == ("base_scan",)
    assert other.last_of_trundle() == ["base_scan"]


def test_what_was_written_by_itself_is_not_foreign(make):
    _, serve, _ = make
    made = serve([frame("base_scan")], patience_s=0.0)
    time.sleep(0.3)
    assert made.published == ("base_scan",)
    assert made.foreign == frozenset()
