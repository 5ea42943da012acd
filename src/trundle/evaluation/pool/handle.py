"""The pool's view of one worker."""

from __future__ import annotations

import contextlib
import enum
import os
import pickle
import socket
from collections.abc import Mapping
from typing import Any

from trundle.errors import InputError
from trundle.evaluation.pool import framing

_TAIL_BYTES = 4096
_DUMP_BYTES = 1 << 18
"""How much is kept: the end of what a worker prints, which has the reason, and the beginning of a dump, which has the
innermost frames."""
_CHUNK = 1 << 16
_MOST_JOB_BYTES = 4000
"""Less than any socket keeps, so that sending never waits."""


class State(enum.Enum):
    """The state of a worker."""

    STARTING = enum.auto()
    IDLE = enum.auto()
    BUSY = enum.auto()
    LATE = enum.auto()
    """It is past its deadline: it is asked where it is, and then killed."""
    LOST = enum.auto()
    """The worker has closed its socket."""
    KILLED = enum.auto()


class Handle:
    """One worker.

    Attributes:
        number: Its number in the pool; no two workers have the same.
        sock: Socket to the worker, which does not block.
        output: Pipe with what it prints.
        dump: Pipe with what faulthandler writes.
        state: Its state.
        job: The job that it has, if any, as the pool keeps it.
        has_served: Whether it has done a job.
        main_thread: Its identifier, once the worker is ready.
        base_bytes: Its resident memory when it was first looked at.
        tail: End of what it printed during this job.
        dumped: What faulthandler wrote.
    """

    def __init__(self, number: int, sock: socket.socket, output: int, dump: int) -> None:
        self.number = number
        self.sock = sock
        self.output = output
        self.dump = dump
        self.state = State.STARTING
        self.job: Any = None
        self.has_served = False
        self.main_thread = 0
        self.base_bytes: int | None = None
        self.tail = b""
        self.dumped = b""
        self._inbox = framing.Inbox(sock)
        self._note: bytes | None = None
        sock.setblocking(False)
        os.set_blocking(output, False)
        os.set_blocking(dump, False)

    def send(self, job: Any) -> None:
        """Send it a job; it must have none.

        Raises:
            InputError: If the job is too large.
        """
        content = framing.pack(framing.JOB, pickle.dumps(job))
        if len(content) > _MOST_JOB_BYTES:
            raise InputError(
                f"a job takes {len(content):,} bytes when it is pickled; it may take {_MOST_JOB_BYTES:,}: put what is "
                "large into the task"
            )
        if self.tail:
            self.read_output()
        self._note, self.tail, self.dumped = None, b"", b""
        with contextlib.suppress(OSError):  # it has ended, as will be found
            self.sock.sendall(content)

    def receive(self) -> tuple[list[tuple[bytes, bytes]], int | None]:
        """Read some bytes. Of notes the last is kept.

        Returns:
            The other messages that are complete now, and how many bytes there were; None at the end of the stream.
        """
        size = self._inbox.take()
        messages: list[tuple[bytes, bytes]] = []
        for kind, content in self._inbox.messages():
            if kind == framing.NOTE:
                self._note = content
            else:
                messages.append((kind, content))
        return messages, size

    def noted(self) -> Mapping[str, Any] | None:
        """Return the last note; None if there is none, or if it cannot be read here."""
        if self._note is None:
            return None
        try:
            return pickle.loads(self._note)
        except Exception:  # noqa: BLE001 - classes may refuse in any way
            return None

    def read_output(self) -> bool:
        """Keep the end of what it has printed; False at the end of the stream."""
        part, is_open = _read_available(self.output)
        self.tail = (self.tail + part)[-_TAIL_BYTES:]
        return is_open

    def read_dump(self) -> bool:
        """Keep what faulthandler has written; False at the end of the stream."""
        part, is_open = _read_available(self.dump)
        self.dumped = (self.dumped + part)[:_DUMP_BYTES]
        return is_open

    def describe_output(self) -> str:
        """Return the end of what it printed, as text."""
        return self.tail.decode(errors="replace")

    def describe_dump(self) -> str:
        """Return what faulthandler wrote, as text."""
        return self.dumped.decode(errors="replace")

    def close(self) -> None:
        """Close socket and pipes."""
        self.sock.close()
        os.close(self.output)
        os.close(self.dump)


def _read_available(number: int) -> tuple[bytes, bool]:
    """Read what has arrived on a pipe, and whether there may be more.

    One that never stops printing is left for the next time.
    """
    parts: list[bytes] = []
    for _ in range(16):
        try:
            part = os.read(number, _CHUNK)
        except BlockingIOError:
            break
        parts.append(part)
        if len(part) < _CHUNK:
            return b"".join(parts), bool(part)
    return b"".join(parts), True
