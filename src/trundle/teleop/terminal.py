"""Driving by keys in a terminal, and its display: lines of numbers, and a small map of characters."""

from __future__ import annotations

import importlib.util
import math
import os
import select
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, TextIO

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.maps.rasterise import HeightBand, SolidRaster
from trundle.teleop.drive import KeyDrive, drive_by_hand, split_keys

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Observer, Step
    from trundle.record.drive_log import DriveLog
    from trundle.robots import Robot
    from trundle.sim import RobotState, Simulator
    from trundle.worlds import World


COLUMNS = 60
MAP_ROWS = 14

_TEXT_ROWS = 8  # of a terminal: the help on the keys, the lines of numbers and of the stop check, and the prompt
_LEAST_MAP = (20, 4)  # in columns and rows; a smaller map shows nothing useful
_PLAIN_PERIOD_S = 1.0
_CLEAR_LINE = "\x1b[K"
_CLEAR_BELOW = "\x1b[J"

_WIDTHS_M = (0.25, 0.5)
"""Widths of a character [m], the finest first; in terminals a character is about twice as tall as wide."""

_DOTS_M = 2.0
_REACH_M = 250.0
"""Distance from the start up to which obstacles are drawn [m]; it limits the memory for a large world."""

_ARROWS = ">^<v"


class Screen:
    """Shows the state of a drive on a stream.

    A terminal shows the line of numbers, what held the last command back, and the map, in place. Any other stream gets
    the lines once per second.
    """

    def __init__(self, stream: TextIO, chart: TextMap) -> None:
        self._stream = stream
        self._chart = chart
        self._in_place = stream.isatty()
        self._rows_below = 0
        self._next_s = 0.0

    def show(self, step: Step) -> None:
        """Show the state after a control period; call it for each."""
        state, held_back = step.state, "" if step.steering is None else step.steering.held_back
        if self._in_place:
            self._redraw(state, held_back)
        elif state.time >= self._next_s:
            self._next_s = state.time + _PLAIN_PERIOD_S
            print("  ".join(filter(None, [describe_state(state), held_back])), file=self._stream, flush=True)

    def close(self) -> None:
        """Leave the last picture, and go to the line below it."""
        if self._in_place:
            print(file=self._stream, flush=True)

    def _redraw(self, state: RobotState, held_back: str) -> None:
        # Some terminals wrap a line of full width, so it is one shorter.
        columns, rows = self._size()
        columns = min(COLUMNS, columns) - 1
        rows = min(MAP_ROWS, rows - _TEXT_ROWS)
        lines = [describe_state(state)[:columns], held_back[:columns]]
        if columns >= _LEAST_MAP[0] and rows >= _LEAST_MAP[1]:
            lines += self._chart.lines(state.pose, columns, rows)
        up = f"\x1b[{self._rows_below}A" if self._rows_below else ""
        text = "\n".join(line + _CLEAR_LINE for line in lines)
        print(f"{up}\r{text}{_CLEAR_BELOW}", end="", file=self._stream, flush=True)
        self._rows_below = len(lines) - 1

    def _size(self) -> tuple[int, int]:
        """Return columns and rows of the terminal; defaults if unknown."""
        columns, rows = os.get_terminal_size(self._stream.fileno())
        return columns or 80, rows or 24


def describe_state(state: RobotState) -> str:
    """Return time, pose, twist and contacts in one line."""
    pose, twist = state.pose, state.twist
    touched = "  touching " + ", ".join(sorted({c.other for c in state.contacts})) if state.contacts else ""
    speeds = f"v {twist.v:6.3f} w {twist.w:6.3f}"
    return f"{state.time:6.1f} s x{pose.x:7.2f} y{pose.y:7.2f} yaw{pose.yaw:6.2f} {speeds}{touched}"


class TextMap:
    """A world from above with north up: `#` obstacle, `.` every 2 m of free floor, and the robot as `>`, `^`, `<`, `v`.

    The whole world is shown if it fits; otherwise the map is centred on the robot.
    """

    def __init__(self, world: World, robot: Robot, start: Pose2D) -> None:
        """Create the map of a world.

        Args:
            world: The world.
            robot: The robot, whose heights determine the obstacles.
            start: The robot's start pose, map frame.
        """
        low, high = world.bounds
        self._world = world
        self._band = HeightBand(*robot.z_range)
        here = np.array([start.x, start.y])
        self._low = np.clip(low[:2], here - _REACH_M, here)
        self._high = np.clip(high[:2], here, here + _REACH_M)
        self._cells: dict[float, tuple[npt.NDArray[np.bool_], int, int]] = {}

    def lines(self, pose: Pose2D, columns: int, rows: int) -> list[str]:
        """Draw the map around a pose, at most so many characters wide and rows high; the top row is north."""
        for width in _WIDTHS_M:
            cells, first_col, first_row = self._draw(width)
            col = math.floor(pose.x / width) - first_col
            row = math.floor(pose.y / (2.0 * width)) - first_row
            high, wide = cells.shape
            if wide <= columns and high <= rows and 0 <= col < wide and 0 <= row < high:
                return self._crop(width, 0, 0, wide, high, (col, row), pose.yaw)
        width = _WIDTHS_M[0]
        _, first_col, first_row = self._draw(width)
        col = math.floor(pose.x / width) - first_col
        row = math.floor(pose.y / (2.0 * width)) - first_row
        return self._crop(width, col - columns // 2, row - rows // 2, columns, rows, (col, row), pose.yaw)

    def _crop(
        self, width: float, col: int, row: int, columns: int, rows: int, robot: tuple[int, int], yaw: float
    ) -> list[str]:
        """Return the text of the block of characters whose lower-left one is (col, row)."""
        cells, first_col, first_row = self._draw(width)
        every_col, every_row = round(_DOTS_M / width), round(_DOTS_M / (2.0 * width))
        lines: list[str] = []
        for r in range(row + rows - 1, row - 1, -1):
            line: list[str] = []
            for c in range(col, col + columns):
                if (c, r) == robot:
                    line.append(_ARROWS[round(yaw / (math.pi / 2.0)) % 4])
                elif 0 <= r < cells.shape[0] and 0 <= c < cells.shape[1] and cells[r, c]:
                    line.append("#")
                else:
                    on_dot = (c + first_col) % every_col == 0 and (r + first_row) % every_row == 0
                    line.append("." if on_dot else " ")
            lines.append("".join(line).rstrip())
        return lines

    def _draw(self, width: float) -> tuple[npt.NDArray[np.bool_], int, int]:
        """Return blocked characters of the world, shape (rows, columns), and the indices of the lower-left one."""
        if width not in self._cells:
            size = np.array([width, 2.0 * width])
            first = np.floor(self._low / size).astype(int)
            columns, rows = (np.floor(self._high / size).astype(int) - first + 1).tolist()
            squares = np.zeros((2 * rows, columns), dtype=np.int8)
            corner = (float(first[0] * size[0]), float(first[1] * size[1]))
            SolidRaster(squares, width, corner, self._band).add(self._world.solids)
            blocked = np.logical_or(squares[::2] > 0, squares[1::2] > 0)
            self._cells[width] = (blocked, int(first[0]), int(first[1]))
        return self._cells[width]


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
