"""The boundary to third-party parsers: any exception they raise on a bad file becomes one typed error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from trundle.errors import InputError, TrundleError

_NOT_UTF8 = "it contains text that is not UTF-8"

_DAMAGED = "the file is damaged, or holds something that is not supported: write it again, or in another format"
_SILENT = (AssertionError, LookupError, TypeError, AttributeError, ArithmeticError, StopIteration, NotImplementedError)
"""Exceptions of parsers whose messages are about their code, and not about the file."""

_ABOUT_ARRAYS = (
    "cannot reshape",
    "buffer is smaller",
    "buffer size must be",
    "setting an array element",
    "operands could not be broadcast",
    "all the input array dimensions",
    "Maximum allowed dimension",
    "Maximum allowed size",
    "array is too big",
)
"""How NumPy's messages begin that are about a reader's arrays, and not about the file."""

_NOTHING = ("", "Caught an unknown exception!", "Unknown exception", "unknown error", "None")


@contextmanager
def parser_errors(message: str, error: type[InputError]) -> Iterator[None]:
    """Raise a typed error for any exception of a parser. Only calls of the parser belong in the block.

    On a bad file a parser may raise anything, from KeyError to RecursionError. Outside the block, the same exceptions
    are bugs in trundle and propagate unchanged.

    Args:
        message: The file and what could not be done; the parser's reason is added.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, from the parser's exception.
    """
    try:
        yield
    except TrundleError:
        raise
    except Exception as problem:
        raise error(f"{message}: {parser_reason(problem)}") from problem


def parser_reason(problem: BaseException) -> str:
    """Return the message of an exception on one line. If it says nothing to a user, say so, and what to do."""
    try:
        text = str(problem)
    except UnicodeDecodeError:  # its message quotes the file's bytes
        text = ""
        problem = UnicodeError()
    if isinstance(problem, UnicodeError):
        return _NOT_UTF8
    text = " ".join(text.split())
    if isinstance(problem, _SILENT) or text in _NOTHING or text.startswith(_ABOUT_ARRAYS):
        known = "" if text in _NOTHING else f" ({type(problem).__name__}: {text})"
        return f"its reader gives no reason{known or f' ({type(problem).__name__})'}; {_DAMAGED}"
    return text
