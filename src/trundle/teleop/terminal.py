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
from trundle.geometry import Goal, Twist2D
from trundle.mission import Session
from trundle.navigation import NavigationStatus
from trundle.teleop.keys import KeyDrive, split_keys
from trundle.teleop.screen import Screen

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.observation import Estimate, Observation
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


class KeyAgent:
    """An agent that drives in real time by keys that are typed, until q or the end of the input.

    Every `update` waits until its control period begins, and reads the keys that were typed until then.

    Args:
        drive: Converts the keys.
        descriptor: Of the terminal.
        period_s: Length of a control period [s].

    Attributes:
        status: FINISHED when the driver has left.
        dt: Length of a control period [s].
    """

    def __init__(self, drive: KeyDrive, descriptor: int, *, period_s: float) -> None:
        self._drive = drive
        self._descriptor = descriptor
        self._rest = b""
        self.dt = period_s
        self.status = NavigationStatus.DRIVING
        self.reset()

    def reset(self, *, seed: int = 0) -> None:
        """Start the clock."""
        self._started = time.monotonic()
        self._periods = 0

    def set_goal(self, goal: Goal, /) -> None:
        """Do nothing: the keys say where to drive."""

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command of the keys."""
        if self._drive.done:
            self.status = NavigationStatus.FINISHED
            return Twist2D()
        self._periods += 1
        data, ended = _read_until(self._descriptor, self._started + self._periods * self.dt)
        keys, self._rest = split_keys(self._rest + data)
        for key in keys:
            self._drive.press(key, time.monotonic())
        self._drive.done = self._drive.done or ended
        return self._drive.twist(time.monotonic())


def drive_by_keys(
    simulator: Simulator, start: Pose2D, log: DriveLog, chart: TextMap, *, period_s: float, seed: int = 0
) -> None:
    """Drive in real time by the keys of the terminal on standard input, until q, Ctrl-C or its end.

    Standard error shows the state; if it is a terminal, with a small map.
    """
    agent = KeyAgent(KeyDrive(simulator.robot.limits), sys.stdin.fileno(), period_s=period_s)
    session = Session(simulator, agent, start, seed=seed, stop_on_contact=False, measure=None)
    log.add(session.state)
    screen = Screen(sys.stderr, chart)
    print(_HELP, *([_MAP_HELP] if sys.stderr.isatty() else []), sep="\n", file=sys.stderr)
    log.begin(0.0, 0.0, 0.0)
    try:
        with raw_terminal(sys.stdin.fileno()):
            agent.reset()
            while (step := session.step()) is not None:
                log.add(step.state, step.sent)
                screen.show(step.state)
    except KeyboardInterrupt:
        return  # Ctrl-C is a normal end: the drive is still recorded.
    finally:
        screen.close()
    if session.error is not None and not isinstance(session.error, KeyboardInterrupt):
        raise session.error


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
