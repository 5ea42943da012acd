"""Arguments of grid searches, read and checked."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, OutsideMapError
from trundle.values import check_count

CellLike = Sequence[int] | npt.NDArray[np.integer]
Cells = npt.NDArray[np.int64]
Span = slice | tuple[int, int] | int
"""Some rows or columns: a slice, a (first, end) pair, or one of them."""


def as_array(values: npt.ArrayLike, what: str) -> npt.NDArray[Any]:
    """Convert to an array, without a copy if it is one.

    Raises:
        InputError: If its rows differ in length, or it is a masked array, whose mask a search would not see.
    """
    if callable(getattr(values, "filled", None)):
        raise InputError(f"{what} are masked, which grid searches ignore: give them as {what}.filled(value)")
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InputError(f"{what} need shape (rows, cols): {error}") from None


def as_bytes(values: npt.ArrayLike, what: str) -> npt.NDArray[np.uint8]:
    """Bool or uint8 as uint8, without a copy."""
    array = as_array(values, what)
    if array.dtype == np.bool_:
        return array.view(np.uint8)
    if array.dtype != np.uint8:
        raise InputError(
            f"{what} must be bool or uint8 (0 is free), got {array.dtype}; compare it first, as in costs >= 253"
        )
    return array


THREADS_VARIABLE = "TRUNDLE_THREADS"
"""For programs that use every processor already, as the workers of an evaluation do."""


def check_threads(threads: int | None) -> int:
    """How many threads to use; none means TRUNDLE_THREADS, or as many as there are processors, up to 8.

    Raises:
        InputError: If it is not an integer from 1 to 1024.
    """
    if threads is not None:
        return check_count("threads", threads, 1, 1024)
    given = os.environ.get(THREADS_VARIABLE, "").strip()
    if given:
        return check_count(THREADS_VARIABLE, int(given) if given.isdecimal() else given, 1, 1024)
    return min(8, os.cpu_count() or 1)


def as_pair(cell: CellLike, what: str) -> tuple[int, int]:
    """A (row, col) of two integers; one of more than 64 bits becomes one that lies outside any map."""
    try:
        row, col = (max(-(2**62), min(2**62, operator.index(number))) for number in cell)
    except (TypeError, ValueError):
        raise InputError(f"the {what} must be a pair of integers (row, col), got {cell!r}") from None
    return row, col


def as_cells(cells: npt.ArrayLike, what: str) -> Cells:
    """Many (row, col) as integers, shape (N, 2)."""
    try:
        array = np.asarray(cells)
    except ValueError as error:
        raise InputError(f"{what} must be integers (row, col) of shape (N, 2): {error}") from error
    if array.shape in ((0,), (0, 2)):
        return np.empty((0, 2), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iu":
        raise InputError(f"{what} must be integers (row, col) of shape (N, 2), got {array.dtype} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.int64)


def as_span(span: Span, what: str, count: int) -> tuple[int, int]:
    """First and end of some rows or columns."""
    if isinstance(span, slice):
        if span.step not in (None, 1):
            raise InputError(f"{what} must be without gaps, got {span}")
        pair = (0 if span.start is None else span.start, count if span.stop is None else span.stop)
    else:
        pair = span if isinstance(span, tuple) else (span, None)
    try:
        first, last = pair
        first = operator.index(first)
        end = first + 1 if last is None else operator.index(last)
    except (TypeError, ValueError):
        raise InputError(f"{what} is a slice, a (first, end) pair or one number, all whole; got {span!r}") from None
    if not 0 <= first <= end <= count:
        raise OutsideMapError(f"{what} {first}:{end} are not within the map: there are 0:{count}")
    return first, end
