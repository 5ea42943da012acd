"""The boundary to third-party parsers: any exception they raise on a bad file becomes one typed error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from trundle.errors import InputError, TrundleError

_NOT_UTF8 = "it contains text that is not UTF-8"


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
    """The message of an exception on one line; its type if the message is empty."""
    try:
        text = str(problem)
    except UnicodeDecodeError:  # its message quotes the file's bytes
        text = ""
        problem = UnicodeError()
    if isinstance(problem, UnicodeError):
        return _NOT_UTF8
    return " ".join(text.split()) or type(problem).__name__
