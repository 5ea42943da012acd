"""Angles as users write them: radians, or degrees as `90deg`; a warning if a number looks like degrees."""

from __future__ import annotations

import math
import re
import warnings

from trundle.errors import AngleWarning

_DEGREES = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg|°|rad)\s*", re.ASCII)

FORM = "radians like 1.57, or degrees like 90deg"
"""The accepted notations of an angle, for messages."""


def parse_angle(text: str) -> float:
    """Read an angle [rad]: a plain number, or a number with the unit `rad`, `deg` or `°`.

    Raises:
        ValueError: If it is anything else, or not finite.
    """
    found = _DEGREES.fullmatch(text)
    number = float(text if found is None else found[1])
    angle = math.radians(number) if found is not None and found[2] != "rad" else number
    if not math.isfinite(angle):
        raise ValueError(f"{text!r} is not finite")
    return angle


def is_in_degrees(angle: float) -> bool:
    """Return whether an angle [rad] is more than one turn, so it was probably meant in degrees."""
    return not -math.tau <= angle <= math.tau


def describe_degrees(angle: float) -> str:
    """Return the message for an angle that `is_in_degrees`."""
    return (
        f"{angle:.12g} is more than one turn, and angles are in radians: for degrees write {angle:.12g}deg "
        f"in a file or an option, or {math.radians(angle):.6g}"
    )


def warn_of_degrees(angle: float, what: str, *, stacklevel: int = 1) -> None:
    """Warn if an angle [rad] was probably meant in degrees; the message begins with `what`."""
    if is_in_degrees(angle):
        warnings.warn(f"{what} {describe_degrees(angle)}", AngleWarning, stacklevel=stacklevel + 1)
