"""The script that a child process of this Python begins with: it reads its start message and calls a function.

Nothing of trundle is imported before the search path is the parent's. `process.start_python` sends the start message
on standard input: its length in `LENGTH_BYTES` bytes, and a pickle.
"""

from __future__ import annotations

import importlib
import os
import pickle
import sys
from typing import Any

LENGTH_BYTES = 8
"""The size of the length of the start message, whose highest byte comes first."""

_CHUNK = 1 << 20


def main() -> None:
    """Call the function that the first argument names ("module:function") with the start message."""
    start = _read_start()
    sys.path[:] = start["path"]
    module, _, function = sys.argv[1].partition(":")
    getattr(importlib.import_module(module), function)(start)


def _read_start() -> dict[str, Any]:
    head = _read(LENGTH_BYTES)
    size = int.from_bytes(head, "big")
    content = _read(size)
    problem = ""
    if len(head) < LENGTH_BYTES:
        problem = f"{len(head)} of the {LENGTH_BYTES} bytes of its length arrived"
    elif len(content) < size:
        problem = f"{len(content):,} of its {size:,} bytes arrived"
    else:
        try:
            return pickle.loads(content)
        except Exception as error:  # noqa: BLE001 - a damaged pickle raises anything
            problem = f"it cannot be unpickled: {type(error).__name__}: {error}"
    sys.exit(f"the start message cannot be read: {problem}")


def _read(size: int) -> bytes:
    """Read so many bytes of standard input, or fewer at its end; what follows them is left for the function."""
    parts: list[bytes] = []
    while size > 0 and (part := os.read(0, min(size, _CHUNK))):  # a pipe gives a long message in pieces
        parts.append(part)
        size -= len(part)
    return b"".join(parts)


if __name__ == "__main__":
    main()
