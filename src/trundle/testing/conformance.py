"""How a failed check is told."""

from __future__ import annotations

from trundle.errors import TrundleError


class ConformanceError(TrundleError, AssertionError):
    """Something behind a seam does not keep its promise."""


def require(holds: bool, promise: str, *, found: object) -> None:
    """Raise `ConformanceError` unless a promise holds."""
    if not holds:
        raise ConformanceError(f"{promise}; found: {found}")
