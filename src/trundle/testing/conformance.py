"""The error of a failed conformance check."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from trundle.errors import InputError, TrundleError
from trundle.files.choice import Choice

_Made = TypeVar("_Made")


class ConformanceError(TrundleError, AssertionError):
    """An implementation of an interface does not meet its contract."""


def accept(make: Callable[[object], _Made], given: object) -> _Made:
    """Make a plug-in of whatever is given for one, as everywhere in trundle; of an object, of a copy.

    Raises:
        ConformanceError: If it is none.
    """
    try:
        return make(given if isinstance(given, str | Choice) else Choice.of_object(given))
    except InputError as error:
        raise ConformanceError(str(error)) from error


def expect(condition: bool, message: str) -> None:
    """Raise a `ConformanceError` if a requirement is not met.

    Raises:
        ConformanceError: If the condition does not hold.
    """
    if not condition:
        raise ConformanceError(message)
