"""`RosProcess`: the child that runs in the user's ROS; `Link`: the connection to it, until it is lost or closed."""

from __future__ import annotations

import contextlib
import itertools
import json
import logging
import os
import socket
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from trundle.errors import InputError, TransportError
from trundle.guard.process import kill_group, signal_name, start_process
from trundle.ros2.transport.rclpy import child

_logger = logging.getLogger(__name__)

_LONGEST_LINE = 4096
_LEAVE_S, _TERM_S, _KILL_S = 1.3, 0.3, 2.0
"""How long it gets to leave after its socket is closed, after SIGTERM, and after SIGKILL."""


class RosProcess:
    """A separate program that relays between a socket and ROS.

    It leaves when its socket is closed, and when the process that started it is gone.

    Args:
        python: The Python to run it with.
        environ: Its environment.
        options: Options of the program: "node", "namespace" and "range".

    Raises:
        TransportError: If it cannot be started.

    Attributes:
        socket: Our end of the socket.
    """

    def __init__(self, python: str, environ: Mapping[str, str], options: Mapping[str, str]) -> None:
        self.socket, theirs = socket.socketpair()
        self._lines: deque[str] = deque(maxlen=20)
        self._started: subprocess.Popen[bytes] | OSError | None = None
        self._has_started, self._has_ended = threading.Event(), threading.Event()
        command = [python, child.__file__, str(theirs.fileno()), str(os.getpid()), json.dumps(dict(options))]
        # Linux takes a child for orphaned once the thread that started it ends: it gets one that lives as long.
        keeper = threading.Thread(target=self._keep, args=(command, dict(environ), theirs), name="ros2 child")
        keeper.daemon = True
        keeper.start()
        self._has_started.wait()
        if not isinstance(self._started, subprocess.Popen):
            self.socket.close()
            reason = self._started.strerror if self._started is not None else "no thread could start it"
            raise TransportError(f"{python} cannot be started: {reason}")
        self._process = self._started

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    def describe_end(self, timeout_s: float) -> str:
        """Return how it ended and what it wrote last, if it ends within this time."""
        if not self._has_ended.wait(timeout_s):
            return "it closed its socket"
        status = self._process.returncode
        how = f"{signal_name(-status)} killed it" if status < 0 else f"it ended with code {status}"
        return f"{how}: {self._lines[-1]}" if self._lines else how

    def close(self) -> None:
        """End the child: by closing its socket, then by SIGTERM, then by SIGKILL."""
        with contextlib.suppress(OSError):
            self.socket.shutdown(socket.SHUT_RDWR)
        if not self._has_ended.wait(_LEAVE_S):
            self._process.terminate()
            if not self._has_ended.wait(_TERM_S):
                kill_group(self._process)
                self._has_ended.wait(_KILL_S)
        self.socket.close()

    def _keep(self, command: list[str], environ: dict[str, str], theirs: socket.socket) -> None:
        try:
            with theirs:
                self._started = process = start_process(
                    command,
                    environ=environ,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    pass_fds=(theirs.fileno(),),
                )
        except OSError as error:
            self._started = error
            return
        finally:
            self._has_started.set()
        with process:
            output = process.stdout
            while output is not None and (line := output.readline(_LONGEST_LINE)):
                text = line.decode(errors="replace").strip()
                if text:
                    self._lines.append(text)
                    _logger.info("ROS: %s", text)
        self._has_ended.set()


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
        """Call a function of the child, and wait for its answer.

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
