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
from trundle.geometry import Twist2D

if TYPE_CHECKING:
    from trundle.cli.drive_log import DriveLog
    from trundle.robots import Limits
    from trundle.sim import Simulator

DEAD_MAN_S = 0.3
"""How long a key counts. A held key repeats faster than this in every terminal; a released one stops the robot."""

SPEED_SHARE = 0.6
"""Share of the robot's largest speeds that a key commands."""

_ARROWS = {b"A": "i", b"B": "k", b"C": "l", b"D": "j"}
_FORWARD = {"i": 1.0, "k": -1.0}
_LEFT = {"j": 1.0, "l": -1.0}
_HELP = "i/k or up/down: forward, back   j/l or left/right: turn   space: stop   q: quit"


class KeyDrive:
    """Turns key presses into a twist that dies away when the keys do.

    Forward and turn are kept apart, each with its own dead-man, so that pressing two keys in turn drives an arc.
    """

    def __init__(self, limits: Limits) -> None:
        self._v = SPEED_SHARE * limits.linear_speed
        self._w = SPEED_SHARE * limits.angular_speed
        self._forward = (0.0, float("-inf"))
        self._left = (0.0, float("-inf"))
        self.done = False

    def press(self, key: str, now: float) -> None:
        """Take one key at a time `now` [s]; unknown keys do nothing."""
        if key in _FORWARD:
            self._forward = (_FORWARD[key], now)
        elif key in _LEFT:
            self._left = (_LEFT[key], now)
        elif key == " ":
            self._forward = self._left = (0.0, now)
        elif key == "q":
            self.done = True

    def twist(self, now: float) -> Twist2D:
        """Return the command at a time `now` [s]."""
        forward, left = (sign if now - pressed <= DEAD_MAN_S else 0.0 for sign, pressed in (self._forward, self._left))
        return Twist2D(forward * self._v, left * self._w)


def split_keys(data: bytes) -> tuple[list[str], bytes]:
    """Split what a terminal sent into keys, arrows as i, k, j, l; an unfinished escape sequence is handed back."""
    keys: list[str] = []
    at = 0
    while at < len(data):
        byte = data[at : at + 1]
        if byte != b"\x1b":
            keys.append(byte.decode("ascii", "replace").lower())
            at += 1
            continue
        if data[at + 1 : at + 2] not in (b"[", b"O"):
            if at + 1 == len(data):
                return keys, data[at:]
            at += 1
            continue
        end = at + 2
        while end < len(data) and not 0x40 <= data[end] <= 0x7E:
            end += 1
        if end == len(data):
            return keys, data[at:]
        if data[end : end + 1] in _ARROWS:
            keys.append(_ARROWS[data[end : end + 1]])
        at = end + 1
    return keys, b""


def check_terminal() -> None:
    """See whether keys can be read.

    Raises:
        InputError: If standard input is no terminal, or this system has none that give single keys.
    """
    if importlib.util.find_spec("termios") is None:
        raise InputError("--teleop in a terminal needs a POSIX system; use --command")
    if not sys.stdin.isatty():
        raise InputError("--teleop reads keys, and standard input is no terminal; use --command")


@contextmanager
def raw_terminal(descriptor: int) -> Iterator[None]:
    """Hand keys over as they are pressed, without echo; put the terminal back whatever happens."""
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


def drive_by_keys(simulator: Simulator, log: DriveLog, *, period_s: float) -> None:
    """Drive in real time by the keys of the terminal on standard input, until q, Ctrl-C or its end."""
    descriptor = sys.stdin.fileno()
    drive = KeyDrive(simulator.robot.limits)
    print(_HELP, file=sys.stderr)
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
                pose, twist = state.pose, state.twist
                touched = "  touching " + ", ".join(sorted({c.other for c in state.contacts})) if state.contacts else ""
                print(
                    f"\r{state.time:7.2f} s  x {pose.x:7.3f}  y {pose.y:7.3f}  yaw {pose.yaw:6.3f}  "
                    f"v {twist.v:6.3f}  w {twist.w:6.3f}{touched}\x1b[K",
                    end="",
                    file=sys.stderr,
                    flush=True,
                )
    except KeyboardInterrupt:
        pass  # One of the ways to end; the drive is recorded all the same.
    finally:
        print(file=sys.stderr)


def _read_until(descriptor: int, deadline: float) -> tuple[bytes, bool]:
    """Collect what is typed until a time; the second value says that the terminal has gone."""
    data = b""
    while True:
        left = deadline - time.monotonic()
        ready, _, _ = select.select([descriptor], [], [], max(0.0, left))
        if not ready:
            return data, False
        try:
            chunk = os.read(descriptor, 1024)
        except OSError:  # A pseudo-terminal whose other side has closed.
            return data, True
        if not chunk:
            return data, True
        data += chunk
        if left <= 0.0:
            return data, False


def _leave(_signal: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + signal.SIGTERM)
