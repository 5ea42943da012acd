"""Limits on a child's reading time and memory."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

from trundle.errors import InputError

SECONDS = 20.0
GIGABYTES = 2.0
"""The usual limits. Higher ones let a bad file hang a program for longer, or fill the memory of a small machine; lower
ones refuse more of the large scenes that people do use, on a busy machine first."""

SECONDS_VARIABLE = "TRUNDLE_READ_SECONDS"
GIGABYTES_VARIABLE = "TRUNDLE_READ_GIGABYTES"
TRUSTED_VARIABLE = "TRUNDLE_TRUSTED"


@dataclass(frozen=True, slots=True)
class ReadLimits:
    """Limits on reading a file.

    Attributes:
        seconds: Time limit, counted from when the child is ready [s].
        gigabytes: Address space in addition to what the child uses before it reads [GB].
        trusted: Whether to read in this process, without limits.
    """

    seconds: float = SECONDS
    gigabytes: float = GIGABYTES
    trusted: bool = False


def read_limits(
    *, trusted: bool | None = None, time_limit_s: float | None = None, memory_limit_gb: float | None = None
) -> ReadLimits:
    """Return the limits that are given, or else those of the environment, or else the defaults.

    Args:
        trusted: Whether to read in this process; by default TRUNDLE_TRUSTED says so (0 or 1).
        time_limit_s: Time limit [s]; by default TRUNDLE_READ_SECONDS, or else 20.
        memory_limit_gb: Limit of the added memory [GB]; by default TRUNDLE_READ_GIGABYTES, or else 2.

    Raises:
        InputError: If a value is invalid.
    """
    if trusted is None:
        text = os.environ.get(TRUSTED_VARIABLE, "").strip()
        if text not in ("", "0", "1"):
            raise InputError(f"{TRUSTED_VARIABLE} is {text!r}; it must be 0 or 1")
        trusted = text == "1"
    given: object = trusted  # from --set it may have any type
    if not isinstance(given, bool):
        raise InputError(f"trusted is {given!r}; it must be true or false")
    return ReadLimits(
        _pick("time_limit_s", time_limit_s, SECONDS_VARIABLE, SECONDS),
        _pick("memory_limit_gb", memory_limit_gb, GIGABYTES_VARIABLE, GIGABYTES),
        trusted,
    )


def _pick(name: str, given: object, variable: str, usual: float) -> float:
    if given is None:
        name, given = variable, os.environ.get(variable, "").strip() or usual
    try:
        number = float(given) if isinstance(given, int | float | str) and not isinstance(given, bool) else math.nan
    except ValueError:
        number = math.nan
    if not 0.0 < number <= 1e6:
        raise InputError(f"{name} is {given!r}; it must be a number above 0 and at most 1,000,000")
    return number
