"""Checks of the options of world generators and loaders.

Those with a parameter `world`, the name of a generator, return the value, or raise a `WorldError` that names world and
option.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Sequence
from typing import Literal, TypeAlias

import numpy as np

from trundle.errors import InputError, WorldError
from trundle.values import finite_number, show_value

Unknown: TypeAlias = Literal["solid", "free"]
"""How unknown cells of a map are treated in a world."""


def check_choice(option: str, value: object, choices: tuple[str, ...]) -> None:
    """Raise `InputError` unless a value is among an option's choices."""
    if value not in choices:
        raise InputError(f"{option} is {value!r}; it must be {' or '.join(map(repr, choices))}")


def check_options(where: str, owner: str, given: Iterable[str], known: Sequence[str]) -> None:
    """Raise `InputError`, with a hint to the nearest known option, unless all given ones are known.

    Args:
        where: Prefix of the message.
        owner: Owner of the options, such as "a .sdf file".
        given: Names of the options that are given.
        known: Names of all options.
    """
    for name in given:
        if name not in known:
            nearest = difflib.get_close_matches(name, known, n=1)
            hint = f" (did you mean {nearest[0]!r}?)" if nearest else ""
            raise InputError(f"{where}: {name!r} is not an option of {owner}{hint}; there are: {', '.join(known)}")


def check_number(world: str, name: str, value: float, low: float, high: float) -> float:
    """Return a finite number from `low` to `high`."""
    number = finite_number(value)
    if number is None or not low <= number <= high:
        raise WorldError(f"{world}: {name} must be a number from {low:g} to {high:g}, got {show_value(value)}")
    return number


def check_flag(world: str, name: str, value: bool) -> bool:
    """Return true or false."""
    if not isinstance(value, bool):
        raise WorldError(f"{world}: {name} must be true or false, got {show_value(value)}")
    return value


def check_whole(world: str, name: str, value: int, low: int, high: int) -> int:
    """Return an integer from `low` to `high`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise WorldError(f"{world}: {name} must be an integer from {low} to {high}, got {show_value(value)}")
    return int(value)


def check_seed(world: str, seed: int) -> int:
    """Return a seed."""
    return check_whole(world, "seed", seed, 0, 2**63 - 1)


def check_size(
    world: str, size: Sequence[float] | str, low: float, high: float, *, name: str = "size"
) -> tuple[float, float]:
    """Return two lengths in metres, along x and y; text has a comma between them."""
    try:
        length, width = size.split(",") if isinstance(size, str) else size
    except (TypeError, ValueError):
        shown = show_value(size)
        raise WorldError(f"{world}: {name} must be two lengths in metres, along x and y, got {shown}") from None
    return (
        check_number(world, f"{name} along x", float_of(length), low, high),
        check_number(world, f"{name} along y", float_of(width), low, high),
    )


def check_numbers(
    world: str, name: str, values: Sequence[float] | str | float, low: float, high: float, *, most: int
) -> tuple[float, ...]:
    """Return one to `most` numbers; text has commas between them, and a single number is accepted."""
    items: Sequence[object]
    if isinstance(values, str):
        items = values.split(",")
    else:
        try:
            items = list(values) if not isinstance(values, int | float) else [values]
        except TypeError:
            items = []
    if not 1 <= len(items) <= most:
        raise WorldError(f"{world}: {name} must be 1 to {most} numbers, got {show_value(values)}")
    return tuple(check_number(world, name, float_of(item), low, high) for item in items)


def float_of(item: object) -> float:
    """Read a number that may be text; anything else becomes NaN, which every check refuses."""
    try:
        return float(item)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError, OverflowError):
        return math.nan
