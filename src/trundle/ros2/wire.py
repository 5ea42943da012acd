"""`Wire`: topics, services and actions of the bridge in messages instead of bytes, and the thread that listens."""

from __future__ import annotations

import logging
import threading
import time as clock
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from trundle.errors import TrundleError
from trundle.messages.qos import Qos
from trundle.ros2.actions import Action, GoalAdapter
from trundle.ros2.bad_input import Warnings
from trundle.ros2.inlet import Inlet, Record
from trundle.ros2.transport.transport import Graph

if TYPE_CHECKING:
    from trundle.ros2.names import Names
    from trundle.ros2.transport.transport import Publisher, Transport
    from trundle.ros2.types import Types

_LOGGER = logging.getLogger(__name__)

ROUND_S = 0.1
"""The listening thread looks at least this often [s] at who listens, and whether the other side is there."""

QUIET_S = 0.02
"""Topics whose messages wake nobody are looked at this often [s]. A wake for each message of a robot that sends /clock
at 200 Hz, and odometry and tf at 50 Hz, is half of the listening thread's work."""

_LOOKS_S = 0.05
"""Who reads each topic is looked up this often [s]: a look after each of 300 messages a second takes 2 % of a core."""

_GRAPH_S = 0.9
"""Who is on the network is asked for this often at most, for those who look once a second [s]."""

_FLOOD_PAUSE_S = 0.02
"""How long the listening thread rests after a round with a flood, so that the run gets the processor [s]."""

_ENDS_S = 1.0
"""How long `close` waits for the listening thread [s]."""


class Outlet:
    """A topic that the bridge publishes; any thread may write to it.

    Attributes:
        topic: Its full name.
        type_name: Type of its messages.
        qos: What it is offered with.
        is_wanted: Whether a message would reach anybody: there are readers, late readers get it, or it is recorded.
    """

    def __init__(
        self, topic: str, type_name: str, qos: Qos, publisher: Publisher, encode: Callable[[Any], bytes], wire: Wire
    ) -> None:
        self.topic, self.type_name, self.qos = topic, type_name, qos
        self._publisher, self._encode, self._wire = publisher, encode, wire
        self._always = qos.durability == "transient_local" or wire.record is not None
        self.is_wanted = True

    def write(self, message: Any) -> None:
        """Publish a message, if it is wanted."""
        if self.is_wanted:
            self.write_bytes(self._encode(message))

    def write_bytes(self, data: bytes) -> None:
        """Publish the CDR bytes of a message, wanted or not."""
        wire = self._wire
        try:
            self._publisher.write(data)
        except (TrundleError, OSError) as error:
            wire.warn(f"{self.topic}: not written", f"{self.topic} cannot be written: {error}")
        if wire.record is not None:
            wire.record.add(self.topic, self.type_name, self.qos, data, wire.now())

    @property
    def readers(self) -> int:
        """Number of subscribers."""
        return self._publisher.matched

    def look(self) -> None:
        """See who reads it now."""
        self.is_wanted = self._always or self._publisher.matched > 0


class Wire:
    """What the bridge publishes, reads and serves, over a transport.

    Publishing is for any thread. Handlers of topics, services and actions run in one thread of the wire, between
    `start` and `close`, also while the run is paused; they must not block for long.

    Args:
        transport: What carries the bytes.
        types: The messages.
        names: Makes full names of those that are given.
        record: Keeps what goes over the wire. If None, nothing is kept.
        report: Gets warnings. If None, the log does.

    Attributes:
        now: Simulated time [s] on the network's clock, for the stamps of the record.
        warnings: What was dropped.
        outlets, inlets: What is published and read.
        services, actions: Full names and types of what is served.
        missing: Names of services and actions that the transport cannot serve.
    """

    def __init__(
        self,
        transport: Transport,
        types: Types,
        names: Names,
        *,
        record: Record | None = None,
        report: Callable[[str], None] | None = None,
    ) -> None:
        self.transport, self.types, self.names, self.record = transport, types, names, record
        self.now: Callable[[], float] = lambda: 0.0
        self.warnings = Warnings(report)
        self.outlets: list[Outlet] = []
        self.inlets: list[Inlet] = []
        self.services: list[tuple[str, str]] = []
        self.actions: list[tuple[str, str]] = []
        self.missing: list[str] = []
        self._round_s = ROUND_S
        self._looked, self._graph_s = 0.0, -_GRAPH_S
        self._graph = Graph()
        self._rounds: list[Callable[[], None]] = []
        self._lost: list[Callable[[str], None]] = []
        self._was_lost = ""
        self._ends = threading.Event()
        self._thread: threading.Thread | None = None

    # Opening --------------------------------------------------------------------------------------------------------

    def outlet(self, topic: str, type_name: str, qos: Qos) -> Outlet:
        """Publish a topic; asked for again, it is the same outlet.

        Raises:
            InputError: If ROS does not allow the name.
        """
        full = self.names.resolve(topic)
        for outlet in self.outlets:
            if (outlet.topic, outlet.type_name) == (full, type_name):
                return outlet
        publisher = self.transport.publisher(full, type_name, qos)
        made = Outlet(full, type_name, qos, publisher, self.types.encode, self)
        self.outlets.append(made)
        return made

    def listen(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        handler: Callable[[Any, str], None],
        *,
        is_recorded: bool = True,
        newest: bool = False,
        wakes: bool = True,
    ) -> Inlet:
        """Read a topic.

        Args:
            topic: Its name.
            type_name: Type of its messages.
            qos: What is asked for.
            handler: Gets each message and who sent it ("" where that is not known). What it raises of `TrundleError`
                is reported once for each kind.
            is_recorded: Whether its messages are recorded; not those of a topic that is published here as well, which
                come back.
            newest: Whether only the newest message counts, however many come.
            wakes: Whether a message is handled at once. Otherwise it is handled before the next one of a topic that
                wakes, and within `QUIET_S`, twice that through rclpy.
        """
        full = self.names.resolve(topic)
        subscription = self.transport.subscription(full, type_name, qos, wakes=wakes)
        if not wakes:
            self._round_s = QUIET_S
        inlet = Inlet(full, type_name, qos, subscription, handler, is_recorded=is_recorded, newest=newest)
        self.inlets.append(inlet)
        return inlet

    def serve(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> bool:
        """Serve a service.

        Args:
            name: Its name.
            type_name: Such as "std_srvs/srv/Trigger".
            handler: Makes the response of a request. Where it raises a `TrundleError`, the answer is an empty response.

        Returns:
            Whether the transport can serve it.
        """
        full = self.names.resolve(name)
        if not self._can_serve(full, f"{type_name}_Request"):
            return False
        types = self.types

        def answer(data: bytes) -> bytes:
            try:
                return types.encode(handler(types.decode(f"{type_name}_Request", data)))
            except TrundleError as error:
                self.warn(f"{full}: failed", f"a request of {full} failed: {error}")
            except Exception:  # a request from outside never ends the bridge
                _LOGGER.exception("a request of %s could not be handled", full)
                self.warn(f"{full}: failed", f"a request of {full} could not be handled")
            return types.encode(types.make(f"{type_name}_Response"))

        self.transport.service(full, type_name, answer)
        self.services.append((full, type_name))
        return True

    def act(self, name: str, type_name: str, action: Action) -> bool:
        """Serve an action, and return whether the transport can.

        Args:
            name: Its name.
            type_name: Such as "nav2_msgs/action/Spin".
            action: Gets its goals.
        """
        full = self.names.resolve(name)
        if not self._can_serve(full, f"{type_name}_Goal"):
            return False
        self.transport.action(full, type_name, GoalAdapter(type_name, action, self.types, self.warn))
        self.actions.append((full, type_name))
        return True

    def _can_serve(self, full: str, part: str) -> bool:
        """Return whether transport and other side can serve this; if not, the name is added to `missing`."""
        if self.transport.has_services and self.types.knows(part):
            return True
        self.missing.append(full)
        return False

    def every_round(self, call: Callable[[], None]) -> None:
        """Call this in the listening thread after everything that arrived, and at least ten times a second."""
        self._rounds.append(call)

    def on_lost(self, call: Callable[[str], None]) -> None:
        """Call this in the listening thread with the reason when the transport is lost, and with "" when it is back."""
        self._lost.append(call)

    # Running --------------------------------------------------------------------------------------------------------

    def start(self) -> None:
        """Begin to listen."""
        for outlet in self.outlets:
            outlet.look()
        thread = threading.Thread(target=self._listen, name="trundle-ros2", daemon=True)
        thread.start()
        self._thread = thread  # set once it runs: Ctrl-C may come in between

    def close(self) -> None:
        """Stop listening and close the transport; closing twice does nothing."""
        self._ends.set()
        thread, self._thread = self._thread, None
        if thread is not None:
            self.transport.wake()
            thread.join(_ENDS_S)
        self.transport.close()

    @property
    def is_closing(self) -> bool:
        """Whether the wire is being closed: who waits in its thread leaves."""
        return self._ends.is_set()

    def wake(self) -> None:
        """Let the listening thread do a round now."""
        self.transport.wake()

    def warn(self, kind: str, text: str | Callable[[], str]) -> None:
        """Count something that is dropped; the first one of each kind is reported, with the text or what makes it."""
        self.warnings.warn(kind, text)

    def take_topics(self) -> bool:
        """Handle the messages that arrived, and return whether a topic is flooded.

        It is also for handlers that wait in the wire's thread.
        """
        floods = [inlet.take(self) for inlet in tuple(self.inlets)]
        return any(floods)

    def do_round(self) -> None:
        """Handle what arrived but requests, and do what is due; for handlers that wait in the wire's thread, too."""
        self.take_topics()
        self._look_for_loss()
        for call in tuple(self._rounds):
            call()

    def look_around(self) -> Graph:
        """Return who is on the network, as of a second ago at most; for the listening thread.

        Raises:
            TransportError: If the other side is gone.
        """
        now = clock.monotonic()
        if now - self._graph_s >= _GRAPH_S:
            self._graph, self._graph_s = self.transport.graph(), now
        return self._graph

    def describe_source(self, source: str) -> str:
        """Return who a message comes from, in words."""
        if not source:
            return "a publisher"
        try:
            endpoints = self.transport.graph().endpoints
        except TrundleError:  # the other side is gone
            endpoints = ()
        node = next((one.node for one in endpoints if one.source == source), "")
        return f"the node {node}" if node else f"the publisher {source}"

    def _listen(self) -> None:
        while not self._ends.is_set():
            try:
                self._listen_once()
            except Exception:  # what the transport meets never ends the thread
                _LOGGER.exception("listening failed, and goes on")
                self._ends.wait(ROUND_S)

    def _listen_once(self) -> None:
        self.transport.wait(self._round_s)
        if self._ends.is_set():
            return
        floods = self.take_topics()
        self.transport.dispatch()
        self._look_for_loss()
        now = clock.monotonic()
        if now - self._looked >= _LOOKS_S:
            self._looked = now
            for outlet in tuple(self.outlets):
                outlet.look()
        for call in tuple(self._rounds):
            call()
        if floods:
            self._ends.wait(_FLOOD_PAUSE_S)

    def _look_for_loss(self) -> None:
        lost = self.transport.lost
        if lost == self._was_lost:
            return
        self._was_lost = lost
        self.warnings.note(f"the other side is lost: {lost}" if lost else "the other side is back")
        for call in tuple(self._lost):
            call(lost)
