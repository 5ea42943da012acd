"""Numbers, arrays and seeds that come from outside, checked where they come in."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from typing import TypeGuard, TypeVar

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError

_Item = TypeVar("_Item", bound=np.generic)


def as_number(value: object, what: str) -> float:
    """Take a number as a float, NaN and infinity included; text is none, also where it could be read as one.

    Raises:
        InputError: If it is no number.
    """
    try:
        if isinstance(value, str | bytes | bytearray):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must be a number, got {value!r}") from None


def is_finite_number(value: object) -> TypeGuard[float]:
    """Whether this is a number, not text, and neither NaN nor infinite."""
    return isinstance(value, numbers.Real) and math.isfinite(value)


def as_sequence(values: Sequence[float] | object, what: str = "a pose") -> Sequence[float]:
    """Take lists, tuples and arrays of one dimension.

    Raises:
        InputError: If it is none.
    """
    if isinstance(values, Sequence | np.ndarray) and not isinstance(values, str | bytes):
        return tuple(values)
    raise InputError(f"{what} must be a sequence of numbers, got {values!r}")


def as_array(
    values: object, kind: type[_Item], what: str, error: type[InputError] = InputError, *, copy: bool = True
) -> npt.NDArray[_Item]:
    """Take an array, or lists of numbers, as an array of this kind; a copy, or with `copy=False` one where it must be.

    Raises:
        InputError: If lists are ragged, or something in them is no number.
    """
    try:
        return np.array(values, dtype=kind, order="C", copy=True) if copy else np.asarray(values, dtype=kind)
    except (TypeError, ValueError, OverflowError) as problem:
        raise error(f"{what} must be an array of numbers: {problem}") from None


def check_seed(seed: object) -> int:
    """Take a seed.

    Raises:
        InputError: If it is no whole number of 0 or more.
    """
    if isinstance(seed, int | np.integer) and not isinstance(seed, bool) and seed >= 0:
        return int(seed)
    raise InputError(f"a seed must be a whole number of 0 or more, got {seed!r}")
