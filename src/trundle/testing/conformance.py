"""What a failed conformance check raises."""

from __future__ import annotations

from trundle.errors import TrundleError


class ConformanceError(TrundleError, AssertionError):
    """Something that stands behind one of the seams does not do what the seam promises."""


def expect(condition: bool, message: str) -> None:
    """Raise a `ConformanceError` where a promise is not kept.

    Raises:
        ConformanceError: If the condition does not hold.
    """
    if not condition:
        raise ConformanceError(message)
