"""Options that earlier versions took, answered with what to do instead."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from trundle.errors import InputError

_P = ParamSpec("_P")
_R = TypeVar("_R")


def refuse_removed(**hints: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Decorate a function that no longer takes some keywords: they raise an `InputError` with a hint.

    Args:
        hints: For each removed keyword, what to do instead; it completes "`keyword` was removed; …".
    """

    def decorate(function: Callable[_P, _R]) -> Callable[_P, _R]:
        @functools.wraps(function)
        def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            if not hints.keys().isdisjoint(kwargs):
                name = next(name for name in hints if name in kwargs)
                raise InputError(f"option {name!r} was removed; {hints[name]}")
            return function(*args, **kwargs)

        return call

    return decorate
