"""Reading .npz files, which may be damaged."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.files.opening import describe_unreadable, open_file, parser_reason
from trundle.values import as_path

MAX_BYTES = 4_000_000_000
"""Limit on the total unpacked size of all arrays."""


def read_arrays(
    path: str | os.PathLike[str], names: Sequence[str], *, error: type[InputError]
) -> tuple[dict[str, npt.NDArray[Any]], list[str]]:
    """Read arrays of numbers from a .npz file.

    Args:
        path: The file.
        names: Arrays to read; missing ones are skipped.
        error: Type of the exception.

    Returns:
        The arrays by name, and the names of all arrays in the file.

    Raises:
        InputError: Of the type `error`, if the file cannot be read, is damaged, or unpacks to more than 4 GB.
    """
    name = as_path(path, "a .npz file", error)
    try:
        with open_file(path) as stream:
            magic = stream.read(6)
            if not magic.startswith(b"PK"):
                what = "a single array, and " if magic == b"\x93NUMPY" else ""
                raise error(f"{name}: {what}not a .npz file of numbers")
            stream.seek(0)
            with zipfile.ZipFile(stream) as archive:
                size = sum(item.file_size for item in archive.infolist())
            if size > MAX_BYTES:
                raise error(f"{name}: it unpacks to {size} bytes; the limit is {MAX_BYTES}")
            stream.seek(0)
            with np.load(stream, allow_pickle=False) as stored:
                there = list(stored.files)
                found = {key: stored[key] for key in names if key in there}
        for key, value in found.items():
            if not isinstance(value, np.ndarray):  # the bytes of what is not in NumPy's format
                raise error(f"{name}: not a .npz file of numbers: {key} is no array")
        return found, there
    except OSError as problem:
        raise error(describe_unreadable(name, problem)) from problem
    except InputError:
        raise
    except Exception as problem:  # zipfile and numpy raise any exception on a damaged file
        raise error(f"{name}: not a .npz file of numbers: {parser_reason(problem)}") from problem
