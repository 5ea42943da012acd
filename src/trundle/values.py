"""Checks for numbers, arrays and seeds that come from outside, and lists of names in messages."""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Sequence
from typing import TypeGuard, TypeVar

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, TrundleError

_Item = TypeVar("_Item", bound=np.generic)


def as_number(value: object, what: str) -> float:
    """Return a number as a float, NaN and infinity included; text is refused, even if it could be parsed as one.

    Raises:
        InputError: If it is not a number.
    """
    try:
        if isinstance(value, str | bytes | bytearray):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} must be a number, got {show_value(value)}") from None


def finite_number(value: object) -> float | None:
    """Return a finite real number as a float; None for text, bools, NaN, infinity and integers too large for it."""
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def is_finite_number(value: object) -> TypeGuard[float]:
    """Return whether this is a finite number, and neither text nor a bool."""
    return finite_number(value) is not None


def show_value(value: object, most: int = 80) -> str:
    """Shorten a value for a message; Python refuses to write integers of more than 4300 digits."""
    try:
        text = repr(value)
    except ValueError:
        return f"a number of type {type(value).__name__} with thousands of digits"
    return text if len(text) <= most else f"{text[:most]}…"


def check_number(name: str, value: object, least: float, most: float, unit: str = "") -> float:
    """Return a number from `least` to `most` as a float.

    Raises:
        InputError: If it is not such a number, or NaN.
    """
    number = value if isinstance(value, float) and math.isinf(value) else finite_number(value)
    if number is not None and least <= number <= most:
        return number
    bounds = f"of {least:g} or more" if math.isinf(most) else f"from {least:g} to {most:g}"
    raise InputError(f"{name} must be a number {bounds}{unit and f' {unit}'}, got {show_value(value)}")


def check_count(name: str, value: object, least: int, most: int) -> int:
    """Return an integer from `least` to `most`, checked.

    Raises:
        InputError: If it is not.
    """
    if isinstance(value, int | np.integer) and not isinstance(value, bool) and least <= value <= most:
        return int(value)
    raise InputError(f"{name} must be an integer from {least} to {most}, got {show_value(value)}")


def check_flag(name: str, value: object) -> bool:
    """Return a bool, checked.

    Raises:
        InputError: If it is not a bool.
    """
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} must be true or false, got {show_value(value)}")
    return bool(value)


def check_kind(value: object, kinds: type | tuple[type, ...], what: str, advice: str) -> None:
    """Raise `InputError`, with what to do instead, unless a value is of one of these classes."""
    if isinstance(value, kinds):
        return
    *others, last = [kind.__name__ for kind in (kinds if isinstance(kinds, tuple) else (kinds,))]
    wanted = f"{', '.join(others)} or {last}" if others else last
    raise InputError(f"{what} must be of type {wanted}, got {type(value).__name__}; {advice}")


def as_path(value: object, what: str, error: type[TrundleError] = InputError) -> str:
    """Return the path of a file, a str or a `pathlib.Path`, as text.

    Raises:
        TrundleError: Of the type `error`, if it is neither.
    """
    path = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if isinstance(path, str):
        return path
    raise error(f"{what} must be a path, str or pathlib.Path, got {type(value).__name__}")


def as_sequence(values: Sequence[float] | object, what: str = "a pose") -> Sequence[float]:
    """Return the numbers of a list, a tuple or a one-dimensional array.

    Raises:
        InputError: If it is anything else.
    """
    if isinstance(values, Sequence | np.ndarray) and not isinstance(values, str | bytes):
        return tuple(values)
    raise InputError(f"{what} must be a sequence of numbers, got {show_value(values)}")


def as_array(
    values: object, kind: type[_Item], what: str, error: type[InputError] = InputError, *, copy: bool = True
) -> npt.NDArray[_Item]:
    """Return an array, or lists of numbers, as an array of this type: a copy, or with `copy=False` only if needed.

    Raises:
        InputError: If lists are ragged, or hold something that is not a number.
    """
    try:
        return np.array(values, dtype=kind, order="C", copy=True) if copy else np.asarray(values, dtype=kind)
    except (TypeError, ValueError, OverflowError) as problem:
        raise error(f"{what} must be an array of numbers: {problem}") from None


def check_seed(seed: object) -> int:
    """Return a seed, checked.

    Raises:
        InputError: If it is not an integer of 0 or more.
    """
    if isinstance(seed, int | np.integer) and not isinstance(seed, bool) and seed >= 0:
        return int(seed)
    raise InputError(f"a seed must be an integer of 0 or more, got {show_value(seed)}")


def first_names(names: Sequence[str], most: int = 5) -> str:
    """List the first names, and how many more there are, for a message."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
