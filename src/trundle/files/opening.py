"""Opening files to read: regular files only, because a pipe or device could block the reader."""

from __future__ import annotations

import errno
import io
import os
import pathlib
import stat
from typing import BinaryIO

Path = str | os.PathLike[str]


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
    """Whether a path is a regular file; False if the text is not a valid path."""
    try:
        check_regular(path)
    except OSError:
        return False
    return True


def exists(path: Path) -> bool:
    """Whether this path exists."""
    try:
        pathlib.Path(path).stat()
    except (OSError, ValueError):
        return False
    return True
