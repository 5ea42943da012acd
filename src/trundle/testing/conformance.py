"""The error of a failed conformance check."""

from __future__ import annotations

from trundle.errors import TrundleError


class ConformanceError(TrundleError, AssertionError):
    """An implementation of an interface does not meet its contract."""


def expect(condition: bool, message: str) -> None:
    """Raise a `ConformanceError` if a requirement is not met.

    Raises:
        ConformanceError: If the condition does not hold.
    """
    if not condition:
        raise ConformanceError(message)
