from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import pytest

from ros2.fake_transport import FakeNetwork, FakeTransport
from trundle.messages import Codec, Qos
from trundle.mission import End, Episode, Scenario
from trundle.ros2.bridge import Bridge
from trundle.ros2.names import Names
from trundle.ros2.types import Types

LATCHED = Qos(100, durability="transient_local")
QUICK_S = 120.0


@cache
def _codec(learns: bool) -> Codec:
    """One for all tests, and one for those that learn types: each takes a while to load."""
    return Codec("jazzy")


class Peer:
    """A node on the other side, which reads everything and sends what it is told."""

    def __init__(self, network: FakeNetwork, types: Types) -> None:
        self.network, self.types = network, types
        self.transport: FakeTransport = network.transport("peer")
        self._readers: dict[str, Any] = {}
        self._writers: dict[tuple[str, str], Any] = {}
        self._kept: dict[str, list[Any]] = {}

    def read(self, topic: str, type_name: str, qos: Qos | None = None) -> None:
        asked = Qos(100, "best_effort") if qos is None else qos
        self._readers[topic] = self.transport.subscription(topic, type_name, asked), type_name

    def got(self, topic: str) -> list[Any]:
        """All messages of a topic so far."""
        reader, type_name = self._readers[topic]
        kept = self._kept.setdefault(topic, [])
        kept += [self.types.decode(type_name, sample.data) for sample in reader.take()]
        return kept

    def send(self, topic: str, message: Any, *, writer: str = "") -> None:
        key = topic, message.__msgtype__ + writer
        if key not in self._writers:
            self._writers[key] = self.transport.publisher(topic, message.__msgtype__, Qos())
        self._writers[key].write(self.types.encode(message))

    def send_bytes(self, topic: str, type_name: str, data: bytes) -> None:
        self.transport.publisher(topic, type_name, Qos()).write(data)

    def leave(self) -> None:
        self.transport.close()

    def twist(self, v: float = 0.0, w: float = 0.0, **others: float) -> Any:
        make = self.types.make
        return make(
            "geometry_msgs/msg/Twist",
            linear=make("geometry_msgs/msg/Vector3", x=v, y=others.get("y", 0.0)),
            angular=make("geometry_msgs/msg/Vector3", z=w),
        )

    def stamped_twist(self, v: float, *, stamp: float = 0.0, frame: str = "") -> Any:
        make = self.types.make
        seconds = int(stamp // 1)
        time_ = make("builtin_interfaces/msg/Time", sec=seconds, nanosec=round((stamp - seconds) * 1e9))
        header = make("std_msgs/msg/Header", stamp=time_, frame_id=frame)
        return make("geometry_msgs/msg/TwistStamped", header=header, twist=self.twist(v))


class Served:
    """A bridge that runs in a thread."""

    def __init__(self, bridge: Bridge, said: list[str]) -> None:
        self.bridge, self.said = bridge, said
        self.episode: Episode | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> None:
        self._thread.start()

    def _run(self) -> None:
        self.episode = self.bridge.run()

    def end(self) -> Episode:
        if self._thread.is_alive():
            self.bridge.context.driver.steering.put(End("the test is over"))
            self._thread.join(QUICK_S)
        assert self.episode is not None
        return self.episode

    def close(self) -> None:
        if self._thread.ident is not None:
            self.end()
        self.bridge.close()

    @property
    def counts(self) -> dict[str, int]:
        return self.bridge.wire.warnings.counts


def wait_for(true: Callable[[], Any]) -> Any:
    """Wait until something is true, and return it."""
    until = time.monotonic() + QUICK_S
    while not (found := true()):
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.002)
    return found


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def types(network: FakeNetwork) -> Types:
    return Types(_codec(False), FakeTransport(network, "/types", network.transport("unused").settings, True))


@pytest.fixture
def peer(network: FakeNetwork, types: Types) -> Peer:
    return Peer(network, types)


@pytest.fixture
def serve(network: FakeNetwork) -> Iterator[Callable[..., Served]]:
    """Makes bridges; they are closed after the test."""
    made: list[Served] = []

    def serve(*, start: bool = True, scenario: dict[str, Any] | None = None, **options: Any) -> Served:
        said: list[str] = []
        transport = network.transport(options.pop("node", "trundle"), has_services=options.pop("has_services", True))
        transport.definitions = options.pop("definitions", {})
        names = options.pop("names", Names())
        settings = {"world": {"name": "lot"}, "robot": "nova_carter", "backend": "kinematic"}
        bridge = Bridge(
            Scenario.make(**settings | (scenario or {})),
            transport,
            Types(_codec(bool(transport.definitions)), transport),
            names,
            **{"speed": math.inf, "report": said.append, **options},
        )
        served = Served(bridge, said)
        made.append(served)
        if start:
            served.start()
        return served

    yield serve
    for served in made:
        served.close()
