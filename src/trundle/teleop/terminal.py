"""Driving by keys in a terminal."""

from __future__ import annotations

import importlib.util
import os
import select
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.teleop.drive import drive_by_hand
from trundle.teleop.keys import KeyDrive, split_keys
from trundle.teleop.screen import Screen

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Observer
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.teleop.screen import TextMap

_HELP = """\
w/s, i/k or up/down: forward, back
a/d, j/l or left/right: turn
The robot stops on release, and before what it would touch.
space: stop   q: quit"""
_MAP_HELP = "Map: > ^ < v robot, # obstacle, . every 2 m; north is up"


def check_terminal() -> None:
    """Check that keys can be read.

    Raises:
        InputError: If standard input is not a terminal, or this system cannot read single keys.
    """
    if importlib.util.find_spec("termios") is None:
        raise InputError("--teleop in a terminal needs a POSIX system; use --command")
    if not sys.stdin.isatty():
        raise InputError("--teleop reads keys, and standard input is not a terminal; use --command")


@contextmanager
def raw_terminal(descriptor: int) -> Iterator[None]:
    """Read keys as they are pressed, without echo; the terminal's mode is restored in any case."""
    import termios
    import tty

    before = termios.tcgetattr(descriptor)
    terminated = signal.signal(signal.SIGTERM, _leave)
    try:
        tty.setcbreak(descriptor)
        yield
    finally:
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
        signal.signal(signal.SIGTERM, terminated)


class TerminalKeys:
    """The keys that are typed in a terminal, until q or the end of the input.

    Args:
        drive: Converts the keys.
        descriptor: File descriptor of the terminal.
    """

    def __init__(self, drive: KeyDrive, descriptor: int) -> None:
        self._drive = drive
        self._descriptor = descriptor
        self._rest = b""

    def read(self) -> Twist2D | None:
        """Return the command of the keys that were typed until now; None when the driver has left."""
        data, ended = _read_typed(self._descriptor)
        keys, self._rest = split_keys(self._rest + data)
        now = time.monotonic()
        for key in keys:
            self._drive.press(key, now)
        return None if ended or self._drive.done else self._drive.twist(now)


def drive_by_keys(
    simulator: Simulator,
    start: Pose2D,
    log: DriveLog,
    chart: TextMap,
    *,
    period_s: float,
    seed: int = 0,
    observers: Sequence[Observer] = (),
) -> None:
    """Drive in real time by the keys of the terminal on standard input, until q, Ctrl-C or its end.

    Standard error shows the state; if it is a terminal, with a small map. See `drive_by_hand`.
    """
    keys = TerminalKeys(KeyDrive(simulator.robot.limits), sys.stdin.fileno())
    screen = Screen(sys.stderr, chart)
    print(_HELP, *([_MAP_HELP] if sys.stderr.isatty() else []), sep="\n", file=sys.stderr)
    try:
        with raw_terminal(sys.stdin.fileno()):
            drive_by_hand(simulator, start, log, keys, screen.show, period_s=period_s, seed=seed, observers=observers)
    finally:
        screen.close()


def _read_typed(descriptor: int) -> tuple[bytes, bool]:
    """Return the bytes that were typed until now; the second value says that the terminal was closed."""
    data = b""
    while select.select([descriptor], [], [], 0.0)[0]:
        try:
            chunk = os.read(descriptor, 1024)
        except OSError:  # A pseudo-terminal whose other end was closed.
            return data, True
        if not chunk:
            return data, True
        data += chunk
    return data, False


def _leave(_signal: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + signal.SIGTERM)
