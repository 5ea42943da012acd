"""Messages between a pool and a worker: a kind of one byte, the length, and the content."""

from __future__ import annotations

import socket
import struct
from collections.abc import Iterator

JOB, READY, UNREADY, NOTE, VALUE, FAULT = b"J", b"R", b"U", b"N", b"V", b"F"

MOST_BYTES = 64 << 20
"""The longest message: a worker that wants to send more gets an error instead."""

_HEAD = struct.Struct("!cI")
_CHUNK = 1 << 16


def pack(kind: bytes, content: bytes) -> bytes:
    """Return a message as it is sent."""
    return _HEAD.pack(kind, len(content)) + content


def receive(sock: socket.socket) -> tuple[bytes, bytes] | None:
    """Wait for the next message; None at the end of the stream."""
    head = _receive_exactly(sock, _HEAD.size)
    if head is None:
        return None
    kind, size = _HEAD.unpack(head)
    content = _receive_exactly(sock, size)
    return None if content is None else (kind, content)


def _receive_exactly(sock: socket.socket, size: int) -> bytes | None:
    parts: list[bytes] = []
    while size > 0:
        part = sock.recv(min(size, _CHUNK))
        if not part:
            return None
        parts.append(part)
        size -= len(part)
    return b"".join(parts)


class Inbox:
    """Takes what has arrived on a socket that does not block, and gives the messages that are complete."""

    def __init__(self, sock: socket.socket) -> None:
        self._sock = sock
        self._bytes = bytearray()

    def take(self) -> int | None:
        """Read some bytes; returns how many there were, None at the end of the stream."""
        try:
            part = self._sock.recv(_CHUNK)
        except (BlockingIOError, InterruptedError):
            return 0
        except OSError:  # reset by the other end
            return None
        self._bytes += part
        return len(part) or None

    def messages(self) -> Iterator[tuple[bytes, bytes]]:
        """Yield the messages that have arrived."""
        while len(self._bytes) >= _HEAD.size:
            kind, size = _HEAD.unpack_from(self._bytes)
            end = _HEAD.size + size
            if len(self._bytes) < end:
                return
            content = bytes(self._bytes[_HEAD.size : end])
            del self._bytes[:end]
            yield kind, content
