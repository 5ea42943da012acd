"""Exceptions and exit codes in words."""

from __future__ import annotations

import signal

from trundle.guard.process import signal_name

_MOST_TEXT = 2000


def describe_error(error: BaseException) -> str:
    """An exception in one line, which every file can hold, however odd the bytes that it was made of."""
    try:
        said = str(error)
    except Exception:  # noqa: BLE001 - classes of other people may do anything
        said = ""
    text = " ".join(said[:_MOST_TEXT].split()).encode(errors="replace").decode()
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def describe_status(status: int) -> str:
    """An exit code in words."""
    if status >= 0:
        return f"status {status}"
    name = signal_name(-status)
    meaning = signal.strsignal(-status) if name.startswith("SIG") else None
    return f"{name} ({meaning.lower()})" if meaning else name
