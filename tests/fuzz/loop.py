"""What all fuzz targets share: rounds that a seed repeats, spoiled arguments, and calls that may refuse them."""

from __future__ import annotations

import math
import random
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Round = Callable[[random.Random], None]
"""Plays one round with the numbers of a generator; raises where an answer is wrong."""

REFUSALS = (TypeError, ValueError, IndexError, OverflowError)
NUMBERS: tuple[Any, ...] = (
    0,
    -1,
    0.5,
    1e-300,
    1e19,
    1e300,
    -1e300,
    math.nan,
    math.inf,
    -math.inf,
    2**31,
    2**63,
    None,
    "1",
)


def play(one_round: Round, *, seed: int, count: int | None = None, seconds: float | None = None) -> int:
    """Play rounds until the count or the time is reached; return how many there were."""
    started, done = time.monotonic(), 0
    while (count is None or done < count) and (seconds is None or time.monotonic() - started < seconds):
        try:
            one_round(random.Random(seed * 1_000_003 + done))
        except BaseException:
            print(f"seed {seed}, round {done}", file=sys.stderr)
            raise
        done += 1
    return done


def rng_of(generator: random.Random) -> np.random.Generator:
    """NumPy's numbers from a generator's."""
    return np.random.default_rng(generator.randrange(2**32))


def attempt(function: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    """What a kernel returns, or none where it refuses its arguments."""
    try:
        return function(*arguments)
    except REFUSALS:
        return None


def spoil(generator: random.Random, arguments: Sequence[Any], numbers: Sequence[Any] = NUMBERS) -> list[Any]:
    """The arguments with one of them as a kernel does not expect it."""
    out = list(arguments)
    which = generator.randrange(len(out))
    out[which] = spoil_array(generator, out[which]) if isinstance(out[which], np.ndarray) else generator.choice(numbers)
    return out


def spoil_array(generator: random.Random, array: npt.NDArray[Any]) -> Any:
    """An array of another type, rank, size or layout, or with numbers in it that are out of range."""
    match generator.randrange(8):
        case 0:
            kind = generator.choice((np.uint8, np.int8, np.int64, np.float32, np.float64, np.bool_, object))
            with np.errstate(invalid="ignore", over="ignore"):
                return array.astype(kind)
        case 1:
            return generator.choice((array[::-1], array[..., ::-1], array[::2], np.asfortranarray(array), array.T))
        case 2:
            return generator.choice((array[:0], array[..., :0], array[..., :-1], array[:1]))
        case 3:
            return generator.choice((array.ravel(), array[np.newaxis], array[..., np.newaxis]))
        case 4:
            return generator.choice((None, array.tolist(), "array", 1))
        case _:
            return with_extremes(generator, array)


def with_extremes(generator: random.Random, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A copy with some of its numbers at the ends of what the type holds, or beyond any number."""
    out = array.copy()
    if out.size == 0:
        return out
    if out.dtype.kind == "f":
        values: Sequence[Any] = (math.nan, math.inf, -math.inf, 1e300, -1e300, 1e-310, 1e19, -0.0)
        values = [value for value in values if out.dtype == np.float64 or abs(value) < 1e38 or not math.isfinite(value)]
    elif out.dtype.kind == "b":
        values = (True, False)
    else:
        bounds = np.iinfo(out.dtype)
        values = (bounds.min, bounds.max, bounds.max - 1, 0)
    for _ in range(generator.choice((1, 1, 3, out.size))):
        out.flat[generator.randrange(out.size)] = generator.choice(values)
    return out
