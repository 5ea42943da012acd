"""Driving by keys in a terminal."""

from __future__ import annotations

import importlib.util
import os
import select
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.teleop.keys import KeyDrive, split_keys
from trundle.teleop.screen import Screen

if TYPE_CHECKING:
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.teleop.text_map import TextMap

_HELP = """\
w/s, i/k or up/down: forward, back
a/d, j/l or left/right: turn
The robot stops on release. space: stop   q: quit"""
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


def drive_by_keys(simulator: Simulator, log: DriveLog, chart: TextMap, *, period_s: float) -> None:
    """Drive in real time by the keys of the terminal on standard input, until q, Ctrl-C or its end.

    Standard error shows the state; if it is a terminal, with a small map.
    """
    descriptor = sys.stdin.fileno()
    drive = KeyDrive(simulator.robot.limits)
    screen = Screen(sys.stderr, chart)
    print(_HELP, *([_MAP_HELP] if sys.stderr.isatty() else []), sep="\n", file=sys.stderr)
    started = time.monotonic()
    rest = b""
    periods = 0
    log.begin(0.0, 0.0, 0.0)
    try:
        with raw_terminal(descriptor):
            while not drive.done:
                periods += 1
                data, ended = _read_until(descriptor, started + periods * period_s)
                keys, rest = split_keys(rest + data)
                for key in keys:
                    drive.press(key, time.monotonic())
                drive.done = drive.done or ended
                command = drive.twist(time.monotonic())
                state = simulator.step(command, period_s)
                log.add(state, command)
                screen.show(state)
    except KeyboardInterrupt:
        pass  # Ctrl-C is a normal end: the drive is still recorded.
    finally:
        screen.close()


def _read_until(descriptor: int, deadline: float) -> tuple[bytes, bool]:
    """Collect typed bytes until a time; the second value says that the terminal was closed."""
    data = b""
    while True:
        left = deadline - time.monotonic()
        ready, _, _ = select.select([descriptor], [], [], max(0.0, left))
        if not ready:
            return data, False
        try:
            chunk = os.read(descriptor, 1024)
        except OSError:  # A pseudo-terminal whose other end was closed.
            return data, True
        if not chunk:
            return data, True
        data += chunk
        if left <= 0.0:
            return data, False


def _leave(_signal: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + signal.SIGTERM)
