"""`RclpyTransport`: the user's own ROS, by way of a child process that runs in it."""

from __future__ import annotations

import itertools
import json
import logging
import os
import threading
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from trundle.errors import InputError, TransportError, TrundleError
from trundle.messages import DISTROS, Distro, Qos
from trundle.ros2.transport.domain import NEAREST, Settings
from trundle.ros2.transport.rclpy import child
from trundle.ros2.transport.rclpy.endpoints import RelayedPublisher, RelayedSubscription, Requests
from trundle.ros2.transport.rclpy.find import candidates, describe
from trundle.ros2.transport.rclpy.link import Link
from trundle.ros2.transport.transport import ActionHandler, Endpoint, Graph, Handler, Offer

_logger = logging.getLogger(__name__)

RETRY_S = (1.0, 2.0, 5.0, 10.0, 30.0)
"""How long to wait before each try to start a lost child again; the last goes on."""


def open_rclpy(
    settings: Settings,
    *,
    node: str = "trundle",
    namespace: str = "",
    python: str | None = None,
    retry_s: Sequence[float] = RETRY_S,
) -> RclpyTransport:
    """Join the network with the user's own ROS.

    Args:
        settings: Domain and range; the distribution is that of this ROS.
        node: Name of our node.
        namespace: Its namespace ("/robot"); "" or "/" for none.
        python: The Python that imports rclpy; otherwise it is looked for, see `find.candidates`.
        retry_s: When to start a lost child again, see `RclpyTransport`.

    Raises:
        TransportError: If no Python can be used; the message has the reason for each.
        InputError: If the distribution was given, and the ROS found is of another one.
    """
    tried: list[tuple[str, str]] = []
    for candidate in candidates(python):
        try:
            return RclpyTransport(candidate, settings, node, namespace, retry_s=retry_s)
        except TransportError as error:
            tried.append((candidate, str(error)))
    raise TransportError(describe(tried))


class RclpyTransport:
    """A node of the user's own ROS, on any RMW and with the user's types: topics, services and actions.

    What is offered, asked for or served raises InputError if this ROS does not have the type or refuses the name, and
    TransportError if the child is gone.

    Args:
        python: The Python that imports rclpy.
        settings: Domain and range.
        node: Name of our node.
        namespace: Its namespace.
        retry_s: How long to wait before each try to start the child again once it is lost. If empty, it is left to
            `restart`.

    Raises:
        TransportError: If this Python cannot be used.
        InputError: If the distribution was given, and its ROS is of another one.

    Attributes:
        settings: What was joined, with the distribution of this ROS.
        notes: What the user should know of it.
        python: The Python in use.
    """

    name = "rclpy"
    has_services = True

    def __init__(
        self, python: str, settings: Settings, node: str, namespace: str, *, retry_s: Sequence[float] = RETRY_S
    ) -> None:
        self.python = python
        self.node = full_name(node, namespace)
        self._options = {"node": node, "namespace": namespace or "/", "range": settings.range}
        self._environ = {**os.environ, **settings.environment()}
        self._numbers = itertools.count(1)
        self._made: list[tuple[str, dict[str, object]]] = []
        self._publishers: dict[int, RelayedPublisher] = {}
        self._subscriptions: dict[int, RelayedSubscription] = {}
        self._requests = Requests()
        self._arrived = threading.Event()
        self._outage = ""
        self._retry_s = tuple(retry_s)
        self._lock, self._restarts = threading.Lock(), threading.Lock()
        self._has_lost, self._is_closed = threading.Event(), threading.Event()
        self._link = self._open_link()
        self._link.wait_until_ready()
        self.settings, self.notes = self._adopt(settings)
        if retry_s:
            threading.Thread(target=self._reconnect, name="ros2 reconnect", daemon=True).start()

    @property
    def distro(self) -> Distro:
        """The distribution of this ROS, or the nearest that trundle knows."""
        return self.settings.distro

    @property
    def rmw(self) -> str:
        """The middleware in use."""
        return self._link.hello["rmw"]

    @property
    def pid(self) -> int:
        """Process id of the child."""
        return self._link.pid

    @property
    def lost(self) -> str:
        """Why nothing is sent or received any more; "" while all is well."""
        return self._outage or (
            self._link.lost and f"the ROS side of the bridge ({self.python}) is gone: {self._link.lost}"
        )

    def publisher(self, topic: str, type_name: str, qos: Qos) -> RelayedPublisher:
        """Offer a topic; see `Transport`."""
        number = next(self._numbers)
        self._publishers[number] = publisher = RelayedPublisher(number, qos, self._link.outbox)
        self._make("publisher", number, topic=topic, type=type_name, qos=asdict(qos))
        return publisher

    def subscription(self, topic: str, type_name: str, qos: Qos, *, wakes: bool = True) -> RelayedSubscription:
        """Subscribe to a topic; see `Transport`."""
        number = next(self._numbers)
        self._subscriptions[number] = subscription = RelayedSubscription(qos, wakes=wakes)
        self._make("subscription", number, topic=topic, type=type_name, qos=asdict(qos), wakes=wakes)
        return subscription

    def service(self, name: str, type_name: str, handler: Handler) -> None:
        """Serve a service; see `Transport`."""
        number = next(self._numbers)
        self._requests.services[number] = handler
        self._make("service", number, name=name, type=type_name)

    def action(self, name: str, type_name: str, handler: ActionHandler) -> None:
        """Serve an action; see `Transport`."""
        number = next(self._numbers)
        self._requests.actions[number] = handler
        self._make("action", number, name=name, type=type_name)

    def definition(self, type_name: str) -> str:
        """Return the text of a type and of all in it, as this ROS has it; "" if it does not have it.

        Raises:
            TransportError: If the child is gone.
        """
        try:
            return self._link.call("definition", type=type_name)
        except InputError:
            return ""

    def graph(self) -> Graph:
        """Return who is on the network now.

        Raises:
            TransportError: If the child is gone.
        """
        return read_graph(self._link.call("graph"))

    def endpoints(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the publishers and subscriptions that a topic has now.

        Raises:
            TransportError: If the child is gone.
        """
        report = self._link.call("endpoints", topic=topic)
        return tuple(_endpoint(entry, report) for entry in report["endpoints"])

    def wait(self, timeout_s: float) -> bool:
        """Wait until something arrived, `wake` was called or the child is gone; False if not in time."""
        has_arrived = self._arrived.wait(timeout_s)
        self._arrived.clear()
        return has_arrived

    def wake(self) -> None:
        """End the `wait` of another thread."""
        self._arrived.set()

    def dispatch(self) -> None:
        """Run the handlers of the requests and goals that arrived, in this thread."""
        self._requests.dispatch(self._link.outbox)

    def restart(self) -> None:
        """Start the child again, with all topics, services and actions; late subscribers get what they would have.

        A child that is lost is started again without this, unless `retry_s` is empty. Goals that were under way are
        over.

        Raises:
            TransportError: If it cannot be started, or the transport was closed.
            InputError: If it refuses what it did not refuse before.
        """
        with self._restarts:
            with self._lock:
                if self._is_closed.is_set():
                    raise TransportError("this transport was closed; open another one")
                self._outage = self.lost or "the ROS side of the bridge is started again"
                self._link.close()
                self._requests.forget()
                for end in (*self._publishers.values(), *self._subscriptions.values()):
                    end.matched = 0
                self._link = link = self._open_link()
            try:
                link.wait_until_ready()
                for do, arguments in self._made:
                    link.call(do, **arguments)
            except TrundleError:
                link.close()
                raise
            for publisher in self._publishers.values():
                publisher.attach(link.outbox)
            self._outage = ""

    def close(self) -> None:
        """Leave the network and end the child; a second call does nothing."""
        with self._lock:
            if self._is_closed.is_set():
                return
            self._is_closed.set()
            self._has_lost.set()
        self._link.close()
        # Whoever is starting the child again may still be at it when the program ends: it holds this, and no more.
        self._requests = Requests()

    def _open_link(self) -> Link:
        return Link(self.python, self._environ, self._options, self._receive, self._on_lost)

    def _on_lost(self) -> None:
        self._has_lost.set()
        self._arrived.set()

    def _reconnect(self) -> None:
        while True:
            self._has_lost.wait()
            self._has_lost.clear()
            for delay in itertools.chain(self._retry_s, itertools.repeat(self._retry_s[-1])):
                if self._is_closed.wait(delay):
                    return
                try:
                    self.restart()
                    break
                except TrundleError as error:
                    _logger.warning("the ROS side of the bridge could not be started again: %s", error)

    def _adopt(self, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
        found = self._link.hello["distro"]
        distro = next((name for name in DISTROS if name == found), NEAREST.get(found))
        if "distro" in settings.given and distro not in (None, settings.distro):
            self.close()
            raise InputError(
                f"the ROS of {self.python} is {found}, not {settings.distro}: leave --distro out, or source the other"
            )
        notes = [*settings.notes]
        if distro != found:
            taken = distro or settings.distro
            notes.append(f"the ROS of {self.python} is {found or 'of an unknown distribution'}: treated as {taken}")
        return replace(settings, distro=distro or settings.distro), tuple(notes)

    def _make(self, do: str, number: int, **arguments: object) -> None:
        """Make something in the child that is registered here already: its first frame may come before its answer."""
        arguments["number"] = number
        self._link.call(do, **arguments)
        self._made.append((do, arguments))

    def _receive(self, kind: int, number: int, payload: bytes) -> None:
        if kind == child.SAMPLE:
            subscription = self._subscriptions[number]
            subscription.add(payload)
            if subscription.wakes:
                self._arrived.set()
        elif kind == child.COUNTS:
            self._count(json.loads(payload))
        elif kind == child.NOTE:
            _logger.warning("%s", payload.decode(errors="replace"))
        elif kind in (child.REQUEST, child.GOAL, child.STARTED, child.CANCEL):
            self._requests.waiting.append((kind, number, payload))
            self._arrived.set()
        else:
            raise child.BrokenStreamError(f"a frame of kind {kind}, which is not known")

    def _count(self, counts: dict[str, dict[str, Any]]) -> None:
        for number, matched in counts["subscriptions"].items():
            self._subscriptions[int(number)].matched = int(matched)
        for number, dropped in counts["dropped"].items():
            self._subscriptions[int(number)].dropped_by_child = int(dropped)
        for number, matched in counts["publishers"].items():
            self._publishers[int(number)].matched = int(matched)


def read_graph(report: Mapping[str, Any]) -> Graph:
    """Read the graph of a child's report, without what ROS's own tools hide: names with a part that begins with "_"."""
    ours = {full_name(*node) for node in report["ours"]}
    endpoints = [_endpoint(entry, report) for entry in report["endpoints"] if not _is_hidden(entry["topic"])]
    offers = [_offer(entry, ours) for entry in report["offers"] if not _is_hidden(entry["name"])]
    nodes = sorted({full_name(*node) for node in report["nodes"]})
    return Graph(tuple(node for node in nodes if not _is_hidden(node)), tuple(endpoints), tuple(offers))


def full_name(name: str, namespace: str) -> str:
    """Return a node's name with its namespace ("/robot/amcl"); "" if it is not known, as of a program without ROS."""
    if not name or name.startswith(("_NODE_NAME_UNKNOWN_", "_CREATED_BY_BARE_DDS_APP_")):
        return ""
    return f"{namespace.rstrip('/')}/{name}"


def _is_hidden(name: str) -> bool:
    return any(part.startswith("_") for part in name.split("/"))


def _endpoint(entry: Mapping[str, Any], report: Mapping[str, Any]) -> Endpoint:
    node, participants = full_name(entry["node"], entry["namespace"]), report.get("participants")
    is_namesake = participants and entry["gid"][: child.PARTICIPANT] not in participants
    best_effort, latched = entry["reliability"] == "best_effort", entry["durability"] == "transient_local"
    return Endpoint(
        kind=entry["kind"],
        topic=entry["topic"],
        type_name=entry["type"],
        type_hash=entry["hash"] if entry["hash"].startswith("RIHS") else "",
        qos=Qos(
            int(entry["depth"]),
            "best_effort" if best_effort else "reliable",
            "transient_local" if latched else "volatile",
        ),
        node=node,
        source=entry["gid"] if entry["kind"] == "publisher" else "",
        ours=not is_namesake and node in {full_name(*one) for one in report["ours"]},
    )


def _offer(entry: Mapping[str, Any], ours: set[str]) -> Offer:
    node = full_name(entry["node"], entry["namespace"])
    return Offer(entry["kind"], entry["name"], entry["type"], node, node in ours)
