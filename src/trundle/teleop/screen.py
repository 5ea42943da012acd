"""The display while driving by keys: a line of numbers, what held the robot back, and a small map, redrawn in place."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from trundle.mission import Step
    from trundle.sim import RobotState
    from trundle.teleop.text_map import TextMap

COLUMNS = 60
MAP_ROWS = 14

_TEXT_ROWS = 8  # of a terminal: the help on the keys, the lines of numbers and of the stop check, and the prompt
_LEAST_MAP = (20, 4)  # in columns and rows; a smaller map shows nothing useful
_PLAIN_PERIOD_S = 1.0
_CLEAR_LINE = "\x1b[K"
_CLEAR_BELOW = "\x1b[J"


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
        """Columns and rows of the terminal; defaults if unknown."""
        columns, rows = os.get_terminal_size(self._stream.fileno())
        return columns or 80, rows or 24


def describe_state(state: RobotState) -> str:
    """Time, pose, twist and contacts in one line."""
    pose, twist = state.pose, state.twist
    touched = "  touching " + ", ".join(sorted({c.other for c in state.contacts})) if state.contacts else ""
    speeds = f"v {twist.v:6.3f} w {twist.w:6.3f}"
    return f"{state.time:6.1f} s x{pose.x:7.2f} y{pose.y:7.2f} yaw{pose.yaw:6.2f} {speeds}{touched}"
