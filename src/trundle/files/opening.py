"""Opening files to read, regular files only, and the exceptions of third-party parsers as one typed error.

A pipe or a device could block the reader. Parsers raise any exception on a bad file.
"""

from __future__ import annotations

import difflib
import errno
import io
import itertools
import os
import pathlib
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO

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


Path = str | os.PathLike[str]

_MOST_NAMES = 10_000
"""Files of a folder that are compared with a misspelt name."""


def open_file(path: Path) -> io.BufferedReader:
    """Open a regular file to read its bytes.

    Raises:
        OSError: If it cannot be opened, is not a regular file, or the text is not a valid path.
    """
    check_regular(path)
    # Non-blocking, in case it has become a pipe since the check.
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    return os.fdopen(handle, "rb")


def read_up_to(stream: BinaryIO, most: int) -> bytes:
    """Read at most `most` bytes; the buffer is never larger than the rest of the file."""
    left = os.fstat(stream.fileno()).st_size - stream.tell()
    return stream.read(max(0, min(most, left)))


def read_limited(path: Path, most: int, too_large: str, *, error: type[TrundleError], wanted: str = "") -> bytes:
    """Read a whole file.

    Args:
        path: The file.
        most: Bytes that it may have.
        too_large: What is said of a larger one, after its name.
        error: Type of the errors.
        wanted: What to give where there is no file; see `describe_unreadable`.

    Raises:
        TrundleError: Of the type `error`, if it cannot be read or is too large.
    """
    try:
        with open_file(path) as stream:
            content = read_up_to(stream, most + 1)
    except OSError as problem:
        raise error(describe_unreadable(path, problem, wanted)) from problem
    if len(content) > most:
        raise error(f"{path}: {too_large}")
    return content


def check_regular(path: Path) -> int:
    """Check that a path is a regular file; return its size [bytes].

    Raises:
        OSError: If it does not exist, is not a regular file, or the text is not a valid path.
    """
    try:
        found = pathlib.Path(path).stat()
    except ValueError:
        raise OSError(errno.EINVAL, "a path must not contain a null character", os.fspath(path)) from None
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "not a regular file", os.fspath(path))
    return found.st_size


def is_file(path: Path) -> bool:
    """Return whether a path is a regular file; False if the text is not a valid path."""
    try:
        check_regular(path)
    except OSError:
        return False
    return True


def exists(path: Path) -> bool:
    """Return whether this path exists."""
    try:
        pathlib.Path(path).stat()
    except (OSError, ValueError):
        return False
    return True


def describe_unreadable(path: Path, error: OSError, wanted: str = "") -> str:
    """Return why a file cannot be read, and what to do about it.

    Args:
        path: The file.
        error: What opening it raised.
        wanted: What to give, where no file in its folder has a similar name: `the file of a map`.
    """
    if isinstance(error, FileNotFoundError):
        return f"cannot read {path}: no such file{advise_missing(path, wanted)}"
    reason = error.strerror or error
    if isinstance(error, IsADirectoryError):
        return f"cannot read {path}: {reason}; give {wanted or 'a file in it'}"
    if isinstance(error, PermissionError):
        return f"cannot read {path}: {reason}; make it readable for you, or give another file"
    return f"cannot read {path}: {reason}"


def advise_missing(path: Path, wanted: str = "") -> str:
    """Return the end of a message about a file that does not exist: the nearest one in its folder, or what to give."""
    file = pathlib.Path(path)
    folder = file.parent
    if not folder.is_dir():
        return f": there is no folder {folder}"
    files = [entry for entry in itertools.islice(folder.iterdir(), _MOST_NAMES) if entry.is_file()]
    stems = difflib.get_close_matches(file.stem, [entry.stem for entry in files], n=_MOST_NAMES)
    nearest = difflib.get_close_matches(file.name, [entry.name for entry in files if entry.stem in stems], n=1)
    if nearest:
        return f"; did you mean {folder / nearest[0]}?"
    return f"; give {wanted}" if wanted else "; correct the name, or put the file there"
