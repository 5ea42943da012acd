"""What options are checked by, so that every planner and search refuses the same in the same words."""

from __future__ import annotations

import math
import numbers

from trundle.errors import InputError


def check_number(name: str, value: object, least: float, most: float, unit: str = "") -> float:
    """A number from `least` to `most` as a float.

    Raises:
        InputError: If it is none, or NaN.
    """
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        number = float(value)
        if least <= number <= most:
            return number
    bounds = f"of {least:g} or more" if math.isinf(most) else f"from {least:g} to {most:g}"
    raise InputError(f"{name} must be a number {bounds}{unit and f' {unit}'}, got {value!r}")
