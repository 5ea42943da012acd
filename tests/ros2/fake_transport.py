"""A network in memory, for tests of what is above the transport: topics, services and actions, no ROS, no sockets.

    network = FakeNetwork()
    ours, theirs = network.transport("trundle"), network.transport("rviz")
    scans = theirs.subscription("/scan", "sensor_msgs/msg/LaserScan", Qos())

As on a real network, services and goals that arrive wait for `ours.dispatch()`, so `network.call` and
`network.send_goal` return at once with something that has its answer later.
"""

from __future__ import annotations

import threading
import uuid
from collections import deque
from dataclasses import dataclass, field

from trundle.errors import InputError
from trundle.messages import Distro, Qos
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.transport import ActionHandler, Endpoint, Graph, Handler, Offer, Sample, Transport

QUEUE = 100


@dataclass
class FakeCall:
    """A request under way: `response` is None until it is answered."""

    request: bytes
    response: bytes | None = None


@dataclass
class FakeGoal:
    """A goal as its client sees it, and at the same time the handle of its server.

    `status` is "sent", "rejected", "executing", "canceling", "succeeded", "aborted" or "canceled".
    """

    data: bytes
    id: bytes = field(default_factory=lambda: uuid.uuid4().bytes)
    status: str = "sent"
    cancel_requested: bool = False
    feedback: list[bytes] = field(default_factory=list)
    result: bytes | None = None
    cancels_refused: int = 0

    def publish_feedback(self, data: bytes) -> None:
        assert self.result is None, "feedback after the end"
        self.feedback.append(data)

    def succeed(self, result: bytes) -> None:
        self._end("succeeded", result)

    def abort(self, result: bytes) -> None:
        self._end("aborted", result)

    def canceled(self, result: bytes) -> None:
        assert self.cancel_requested, "canceled without a request"
        self._end("canceled", result)

    def _end(self, status: str, result: bytes) -> None:
        assert self.result is None, f"a goal that ended as {self.status} ends again as {status}"
        self.status, self.result = status, result


class FakeNetwork:
    """Joins the transports made by `transport`."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.transports: list[FakeTransport] = []
        self.sent: dict[str, list[bytes]] = {}
        """All that was written, by topic."""

    def transport(
        self, node: str = "trundle", *, distro: Distro = "jazzy", has_services: bool = True, domain: int = 0
    ) -> FakeTransport:
        made = FakeTransport(self, f"/{node}", Settings(distro=distro, domain=domain), has_services)
        self.transports.append(made)
        return made

    def publishers(self, topic: str, type_name: str) -> list[FakePublisher]:
        return [one for transport in self.transports for one in transport.publishers if one.is_for(topic, type_name)]

    def subscriptions(self, topic: str, type_name: str) -> list[FakeSubscription]:
        return [one for transport in self.transports for one in transport.subscriptions if one.is_for(topic, type_name)]

    def most_waiting(self, sender: FakeTransport, node: str) -> int:
        """How many messages of a transport wait in that subscription of a node where most of them do."""
        ours = {one.source for one in tuple(sender.publishers)}
        readers = [one for other in tuple(self.transports) if other.node == node for one in other.subscriptions]
        return max((one.count_waiting(ours) for one in readers), default=0)

    def call(self, name: str, request: bytes) -> FakeCall:
        """Send a request to the node that serves it."""
        call = FakeCall(request)
        self._server("services", name).arrive((name, call))
        return call

    def send_goal(self, name: str, data: bytes) -> FakeGoal:
        """Send a goal to the node that serves the action."""
        goal = FakeGoal(data)
        self._server("actions", name).arrive((name, goal))
        return goal

    def cancel(self, name: str, goal: FakeGoal) -> None:
        """Ask for a goal's cancellation."""
        self._server("actions", name).arrive((name, goal))

    def _server(self, kind: str, name: str) -> FakeTransport:
        for transport in self.transports:
            if name in getattr(transport, kind):
                return transport
        raise LookupError(f"no node serves {name}")


class FakeTransport:
    """A node of a `FakeNetwork`."""

    name = "rclpy"
    rmw = "rmw_in_memory"
    notes: tuple[str, ...] = ()

    def __init__(self, network: FakeNetwork, node: str, settings: Settings, has_services: bool) -> None:
        self.network, self.node, self.settings, self.has_services = network, node, settings, has_services
        self.distro = settings.distro
        self.lost = ""
        self.closed = False
        self.publishers: list[FakePublisher] = []
        self.subscriptions: list[FakeSubscription] = []
        self.services: dict[str, tuple[str, Handler]] = {}
        self.actions: dict[str, tuple[str, ActionHandler]] = {}
        self.definitions: dict[str, str] = {}
        """What `definition` gives, for tests of types that differ."""
        self._arrived: deque[tuple[str, FakeCall | FakeGoal]] = deque()
        self._event = threading.Event()

    def publisher(self, topic: str, type_name: str, qos: Qos) -> FakePublisher:
        made = FakePublisher(self, topic, type_name, qos)
        with self.network.lock:
            self.publishers.append(made)
        return made

    def subscription(self, topic: str, type_name: str, qos: Qos, *, wakes: bool = True) -> FakeSubscription:
        made = FakeSubscription(self, topic, type_name, qos, wakes)
        with self.network.lock:
            self.subscriptions.append(made)
            for publisher in self.network.publishers(topic, type_name):
                if _compatible(publisher.qos, qos) and qos.durability == "transient_local":
                    made.arrive(publisher.kept, publisher.source)
        return made

    def service(self, name: str, type_name: str, handler: Handler) -> None:
        self._check_services(name)
        self.services[name] = type_name, handler

    def action(self, name: str, type_name: str, handler: ActionHandler) -> None:
        self._check_services(name)
        self.actions[name] = type_name, handler

    def definition(self, type_name: str) -> str:
        return self.definitions.get(type_name, "")

    def graph(self) -> Graph:
        with self.network.lock:
            everyone = list(self.network.transports)
            endpoints = [one.endpoint(self) for node in everyone for one in (*node.publishers, *node.subscriptions)]
            offers = [
                Offer(kind, name, type_name, node.node, node is self)
                for node in everyone
                for kind, offered in (("service server", node.services), ("action server", node.actions))
                for name, (type_name, _) in offered.items()
            ]
        return Graph(tuple(sorted(node.node for node in everyone)), tuple(endpoints), tuple(offers))

    def endpoints(self, topic: str) -> tuple[Endpoint, ...]:
        return tuple(one for one in self.graph().endpoints if one.topic == topic)

    def wait(self, timeout_s: float) -> bool:
        arrived = self._event.wait(timeout_s)
        self._event.clear()
        return arrived

    def wake(self) -> None:
        self._event.set()

    def arrive(self, item: tuple[str, FakeCall | FakeGoal]) -> None:
        self._arrived.append(item)
        self.wake()

    def dispatch(self) -> None:
        while self._arrived:
            name, item = self._arrived.popleft()
            if isinstance(item, FakeCall):
                item.response = self.services[name][1](item.request)
            elif item.status == "sent":
                self._start(self.actions[name][1], item)
            elif item.result is None:
                self._cancel(self.actions[name][1], item)

    def close(self) -> None:
        self.closed = True
        with self.network.lock:
            if self in self.network.transports:
                self.network.transports.remove(self)
        self.wake()

    def _start(self, handler: ActionHandler, goal: FakeGoal) -> None:
        if not handler.accepts(goal.data):
            goal.status = "rejected"
            return
        goal.status = "executing"
        handler.accepted(goal)

    def _cancel(self, handler: ActionHandler, goal: FakeGoal) -> None:
        if not handler.cancel(goal):
            goal.cancels_refused += 1
            return
        goal.cancel_requested = True
        if goal.result is None:
            goal.status = "canceling"

    def _check_services(self, name: str) -> None:
        if not self.has_services:
            raise InputError(f"{name} cannot be served: this transport has no services")


class _End:
    kind = ""

    def __init__(self, transport: FakeTransport, topic: str, type_name: str, qos: Qos) -> None:
        self.transport, self.topic, self.type_name, self.qos = transport, topic, type_name, qos
        self.source = uuid.uuid4().hex

    def is_for(self, topic: str, type_name: str) -> bool:
        return self.topic == topic and self.type_name == type_name

    def endpoint(self, viewer: FakeTransport) -> Endpoint:
        node = self.transport
        return Endpoint(self.kind, self.topic, self.type_name, "", self.qos, node.node, self.source, node is viewer)


class FakePublisher(_End):
    kind = "publisher"

    def __init__(self, transport: FakeTransport, topic: str, type_name: str, qos: Qos) -> None:
        super().__init__(transport, topic, type_name, qos)
        self.kept: deque[bytes] = deque(maxlen=qos.depth if qos.durability == "transient_local" else 0)

    @property
    def matched(self) -> int:
        return sum(one.transport is not self.transport for one in self._readers())

    def write(self, data: bytes) -> None:
        with self.transport.network.lock:
            self.transport.network.sent.setdefault(self.topic, []).append(data)
            self.kept.append(data)
            readers = self._readers()
        for reader in readers:
            reader.arrive([data], self.source)

    def _readers(self) -> list[FakeSubscription]:
        with self.transport.network.lock:
            found = self.transport.network.subscriptions(self.topic, self.type_name)
            return [one for one in found if _compatible(self.qos, one.qos)]


class FakeSubscription(_End):
    kind = "subscription"

    def __init__(self, transport: FakeTransport, topic: str, type_name: str, qos: Qos, wakes: bool) -> None:
        super().__init__(transport, topic, type_name, qos)
        self._wakes = wakes
        self.dropped = 0
        self._samples: deque[Sample] = deque(maxlen=QUEUE)

    @property
    def matched(self) -> int:
        writers = self.transport.network.publishers(self.topic, self.type_name)
        return sum(_compatible(one.qos, self.qos) for one in writers)

    def count_waiting(self, sources: set[str]) -> int:
        """How many messages of these publishers have arrived and were not taken."""
        return sum(sample.source in sources for sample in self._samples.copy())

    def arrive(self, messages: list[bytes] | deque[bytes], source: str) -> None:
        for data in messages:
            self.dropped += len(self._samples) == QUEUE
            self._samples.append(Sample(data, source))
        if self._wakes:
            self.transport.wake()

    def take(self) -> list[Sample]:
        taken = []
        while self._samples:
            taken.append(self._samples.popleft())
        return taken


def _compatible(offered: Qos, asked: Qos) -> bool:
    return not (
        (asked.reliability == "reliable" and offered.reliability == "best_effort")
        or (asked.durability == "transient_local" and offered.durability == "volatile")
    )


def _is_a_transport(fake: FakeTransport) -> Transport:
    """Type checkers hold the fake to the seam here."""
    return fake
