"""Keys as commands: parsing terminal input, and converting keys to twists."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.geometry import Twist2D

if TYPE_CHECKING:
    from trundle.robots import Limits

DEAD_MAN_S = 0.3
"""How long a key press is active. A held key repeats faster than this; after a release the robot stops."""

SPEED_SHARE = 0.6
"""Share of the robot's maximum speeds that a key commands: a key is on or off, so the fastest is hard to steer."""

_ARROWS = {b"A": "i", b"B": "k", b"C": "l", b"D": "j"}
_FORWARD = {"i": 1.0, "w": 1.0, "k": -1.0, "s": -1.0}
_LEFT = {"j": 1.0, "a": 1.0, "l": -1.0, "d": -1.0}


class KeyDrive:
    """Converts key presses to a twist that ends when the keys are released.

    Forward and turn have separate dead-man timers, so that alternating two keys drives an arc.
    """

    def __init__(self, limits: Limits) -> None:
        self._v = SPEED_SHARE * limits.linear_speed
        self._w = SPEED_SHARE * limits.angular_speed
        self._forward = (0.0, float("-inf"))
        self._left = (0.0, float("-inf"))
        self.done = False

    def press(self, key: str, now: float) -> None:
        """Process a key at a time `now` [s]; unknown keys do nothing."""
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


class StepDrive:
    """Converts single key presses to a twist, in steps of a fifth of the robot's maximum speeds.

    The window reports only key presses, not releases, so that a key cannot mean "while held": up and down change the
    speed, left and right the turn, and `stop` ends both.
    """

    STEPS = 5

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._forward = 0
        self._left = 0

    def press(self, key: str) -> None:
        """Process one key of `NativeWindow.read_keys`; others do nothing."""
        match key:
            case "up" | "down":
                self._forward = self._stepped(self._forward, key == "up")
            case "left" | "right":
                self._left = self._stepped(self._left, key == "left")
            case "stop":
                self._forward = self._left = 0
            case _:
                pass

    def twist(self) -> Twist2D:
        """Return the command."""
        return Twist2D(
            self._forward / self.STEPS * self._limits.linear_speed,
            self._left / self.STEPS * self._limits.angular_speed,
        )

    def _stepped(self, value: int, up: bool) -> int:
        return max(-self.STEPS, min(self.STEPS, value + (1 if up else -1)))


def split_keys(data: bytes) -> tuple[list[str], bytes]:
    """Split what a terminal sent into keys, arrows as i, k, j, l; an unfinished escape sequence is returned."""
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
