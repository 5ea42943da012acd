"""`Link`: the connection to the child, from its start until it is lost or closed."""

from __future__ import annotations

import itertools
import json
import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from trundle.errors import InputError, TransportError
from trundle.ros2.transport.rclpy import child
from trundle.ros2.transport.rclpy.process import RosProcess

_logger = logging.getLogger(__name__)

_START_S = 30.0
_ANSWER_S = 10.0
_END_S = 0.5
_JOIN_S = 2.0
"""How long `close` waits for the link's thread [s]: where Ctrl-C has left a lock held, it ends with the program."""


@dataclass(slots=True)
class _Call:
    done: threading.Event = field(default_factory=threading.Event)
    answer: Mapping[str, Any] = field(default_factory=dict[str, Any])


class Link:
    """A child that is connected; once lost, it stays lost.

    Args:
        python: The Python of ROS.
        environ: The child's environment.
        options: The child's: "node", "namespace" and "range".
        receive: Called with every other frame (kind, number, payload), in the link's thread.
        on_lost: Called in that thread once `lost` is set.

    Raises:
        TransportError: If the child cannot be started.

    Attributes:
        outbox: What is sent to the child.
        hello: What the child says of its ROS: "distro" and "rmw".
        lost: Why it is gone; "" while it works.
    """

    def __init__(
        self,
        python: str,
        environ: Mapping[str, str],
        options: Mapping[str, str],
        receive: Callable[[int, int, bytes], None],
        on_lost: Callable[[], None],
    ) -> None:
        self.lost = ""
        self.hello: Mapping[str, str] = {}
        self._receive, self._on_lost = receive, on_lost
        self._is_closing = False
        self._said_hello = threading.Event()
        self._numbers = itertools.count(1)
        self._calls: dict[int, _Call] = {}
        self._process = RosProcess(python, environ, options)
        self.outbox = child.Outbox(self._process.socket)
        self._reader = threading.Thread(target=self._read, name="ros2 link", daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """Process id of the child."""
        return self._process.pid

    def wait_until_ready(self) -> None:
        """Wait for the child's ROS.

        Raises:
            TransportError: If the child cannot use ROS, or the link is closed meanwhile; it is closed then.
        """
        has_answered = self._said_hello.wait(_START_S)
        if not has_answered or not self.hello:
            self.close()
            raise TransportError(self.lost if has_answered else f"it did not start within {_START_S:.0f} s")

    def call(self, do: str, **arguments: object) -> Any:
        """Have the child do something, and wait for its answer.

        Raises:
            InputError: If this ROS cannot do it; the message is the child's.
            TransportError: If the child is gone or does not answer.
        """
        number, call = next(self._numbers), _Call()
        self._calls[number] = call
        try:
            self.outbox.put(child.CALL, number, json.dumps({"do": do, **arguments}).encode())
            if not self.lost and not call.done.wait(_ANSWER_S):
                raise TransportError(f"the ROS side of the bridge did not answer within {_ANSWER_S:.0f} s")
        finally:
            del self._calls[number]
        if "error" in call.answer:
            raise InputError(call.answer["error"])
        if "value" not in call.answer:
            raise TransportError(self.lost)
        return call.answer["value"]

    def close(self) -> None:
        """Send what waits, and end the child."""
        self._is_closing = True
        self.outbox.flush(0.2)
        self.outbox.close()
        self._process.close()
        self._reader.join(_JOIN_S)

    def _read(self) -> None:
        problem = ""
        try:
            for kind, number, payload in child.read_frames(self._process.socket):
                if kind == child.HELLO:
                    self.hello = json.loads(payload)
                    self._said_hello.set()
                elif kind == child.REFUSED:
                    problem = payload.decode(errors="replace")
                    break
                elif kind == child.REPLY:
                    call = self._calls.get(number)
                    if call is not None:
                        call.answer = json.loads(payload)
                        call.done.set()
                else:
                    self._receive(kind, number, payload)
        except Exception as error:  # noqa: BLE001 - whatever a frame that is not of the protocol makes it stumble over
            if not self._is_closing:
                problem = f"what it sent cannot be read: {error}"
        self._end(problem)

    def _end(self, problem: str) -> None:
        self.outbox.close()
        if self._is_closing:
            self.lost = "it was closed"
        else:
            self.lost = problem or self._process.describe_end(_END_S)
        for call in list(self._calls.values()):
            call.done.set()
        self._said_hello.set()
        if not self._is_closing:
            self._on_lost()
            self._process.close()
