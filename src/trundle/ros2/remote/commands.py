"""`CommandOutput`: the commands to the robot, and who else commands it."""

from __future__ import annotations

import math
import threading
import time as clock
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from trundle.errors import TrundleError
from trundle.geometry import Twist2D
from trundle.messages import MessageMaker
from trundle.messages.qos import Qos
from trundle.ros2.remote.guard import Reasons
from trundle.ros2.wire import Outlet, Wire

if TYPE_CHECKING:
    from trundle.ros2.types import Types

STAND = Twist2D()
COMMANDS = Qos(10)
_TWIST, _STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"

LOOKS_S = 1.0
"""Who reads the commands is looked up this often [s]."""

STOPS_S = 1.0
"""A robot that stands gets commands to stand for so long [s]; then it is left alone, so that others can drive it."""

OTHERS_S = 1.0
"""Who else commands the robot has it until this long after the last command [s]."""

LATE_S = 0.4
"""Where the navigator gives no command for so long [s], the robot is stopped."""


class Sources:
    """Says which publishers are our own.

    Args:
        wire: The network.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self._known: dict[str, bool] = {}
        self._nameless: set[str] = set()

    def is_ours(self, source: str) -> bool | None:
        """Return whether a publisher is ours; None where the transport does not know."""
        if not source:
            return None
        if source not in self._known:
            if len(self._known) > 1000:
                self._known.clear()
                self._nameless.clear()
            graph = self._wire.look_around if source in self._nameless else self._wire.transport.graph
            try:
                endpoints = graph().endpoints
            except TrundleError:
                return None
            found = next((one for one in endpoints if one.source == source), None)
            if found is None:
                return None
            if not (
                found.ours or found.node
            ):  # ROS hears of a node after its publishers; programs without ROS have none
                self._nameless.add(source)
                return None
            self._known[source] = found.ours
        return self._known[source]


class CommandOutput:
    """Sends commands as Twist or as TwistStamped, whichever the robot reads, and hears who else sends some.

    Args:
        wire: The network.
        types: The messages.
        topic: The topic.
        frame: Frame of the robot's base.
        now: Time on the network [s].
        sources: Which publishers are ours.

    Attributes:
        sent: The last command.
        written: When one was last sent [s of real time].
        moving_since: Since when it is a motion [s of real time]; None while the robot stands.
        messages: How many were sent.
        readers: The nodes that read them, besides ours.
    """

    def __init__(
        self,
        wire: Wire,
        types: Types,
        topic: str,
        frame: str,
        now: Callable[[], float],
        sources: Sources,
    ) -> None:
        self._make = make = MessageMaker(types.codec)
        self._wire, self._frame, self._now, self._sources = wire, frame, now, sources
        self._topic = wire.names.resolve(topic)
        self._outlets: dict[str, Outlet] = {kind: wire.outlet(topic, kind, COMMANDS) for kind in (_TWIST, _STAMPED)}
        for kind in self._outlets:
            # Our own commands come back, twenty a second; the other type has those of others alone.
            wire.listen(topic, kind, COMMANDS, self._hear, wakes=kind != make.command_type)
        self._lock = threading.RLock()
        self._kind = make.command_type
        self._looked = -LOOKS_S
        self._recent: deque[Twist2D] = deque(maxlen=64)
        self._others: dict[str, tuple[float, str]] = {}
        self._given = clock.monotonic()
        self._stood_since: float | None = -math.inf  # it was never driven: it is left alone
        self._ended = False
        self.sent, self.written = STAND, -math.inf
        self.moving_since: float | None = None
        self.messages = 0
        self.readers: tuple[str, ...] = ()
        wire.every_round(self._look)

    def send(self, command: Twist2D, *, wakes: bool = False) -> None:
        """Send a command; a robot that has stood for a second is left alone, unless it is to be woken."""
        now = clock.monotonic()
        with self._lock:
            if self._ended:
                return
            self._given = now
            if command != STAND:
                self._stood_since = None
            elif self._stood_since is None:
                self._stood_since = now
            if self._is_left_alone(now) and not wakes:
                self._note(command, now)
                return
            self._write(command, now)

    def stop(self) -> None:
        """Stop the robot for good: three commands, as one may be lost."""
        with self._lock:
            was_moving, self._ended = self.moving_since is not None or self._is_stopping(), True
            if not was_moving:
                return
        for _ in range(3):
            with self._lock:
                self._write(STAND, clock.monotonic())
            clock.sleep(0.02)

    def others(self, now: float) -> Reasons:
        """Return who else commands the robot; a rule of the guard."""
        with self._lock:
            self._others = {source: seen for source, seen in self._others.items() if now - seen[0] < OTHERS_S}
            names = [who for _, who in self._others.values()]
        if not names:
            return {}
        return {"two sources": f"{' and '.join(names)} commands the robot on {self._topic}, too"}

    def _is_stopping(self) -> bool:
        return self._stood_since is not None and clock.monotonic() - self._stood_since < STOPS_S

    def _is_left_alone(self, now: float) -> bool:
        return self._stood_since is not None and now - self._stood_since > STOPS_S

    def _note(self, command: Twist2D, now: float) -> None:
        self.sent = command
        if command == STAND:
            self.moving_since = None
        elif self.moving_since is None:
            self.moving_since = now

    def _write(self, command: Twist2D, now: float) -> None:
        self._note(command, now)
        self._recent.append(command)
        self.written = now
        self.messages += 1
        twist = self._make.twist(command)
        kind = self._kind
        if kind == _TWIST:
            self._outlets[kind].write(twist)
        else:
            header = self._make.header(self._now(), self._frame)
            self._outlets[kind].write(self._make.codec.make(_STAMPED, header=header, twist=twist))

    # The listening thread -------------------------------------------------------------------------------------------

    def _hear(self, message: Any, source: str) -> None:
        """Note a command of another publisher; zeros move nothing, and do not count."""
        twist = message.twist if message.__msgtype__ == _STAMPED else message
        heard = Twist2D(float(twist.linear.x), float(twist.angular.z))
        ours = self._sources.is_ours(source)
        if heard == STAND or ours:
            return
        who = self._wire.describe_source(source)
        with self._lock:
            if ours is None and heard in self._recent:
                return
            self._others[source] = clock.monotonic(), who

    def _look(self) -> None:
        """See who reads the commands; stop the robot where the navigator takes too long."""
        now = clock.monotonic()
        if now - self._looked >= LOOKS_S:
            self._looked = now
            try:
                ends = self._wire.transport.endpoints(self._topic)
            except TrundleError:
                ends = ()
            found = [one for one in ends if one.kind == "subscription"]
            read = {one.type_name for one in found if not one.ours} & self._outlets.keys()
            self.readers = tuple(sorted({one.node or one.source for one in found if not one.ours}))
            # A robot that reads both types would take each command twice.
            usual = self._make.command_type
            self._kind = usual if usual in read or not read else next(iter(read))
        with self._lock:
            if self.moving_since is None or self._ended or now - self._given < LATE_S:
                return
            self._write(STAND, now)
        self._wire.warn("stands: late command", f"the robot is stopped: the navigator gave no command for {LATE_S:g} s")
