"""`RosProcess`: the child that runs in the user's ROS, from its start to its end."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import socket
import subprocess
import threading
from collections import deque
from collections.abc import Mapping

from trundle.errors import TransportError
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
        options: Of the program: "node", "namespace" and "range".

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
        """How it ended and what it wrote last, if it ends within this time."""
        if not self._has_ended.wait(timeout_s):
            return "it closed its socket"
        status = self._process.returncode
        how = f"{signal_name(-status)} killed it" if status < 0 else f"it ended with code {status}"
        return f"{how}: {self._lines[-1]}" if self._lines else how

    def close(self) -> None:
        """Have it leave: by closing its socket, then by SIGTERM, then by SIGKILL."""
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
