"""`episode.json`: the record that a run's folder has when the run has ended."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from trundle.errors import InputError
from trundle.files.opening import exists, is_file, open_file, read_up_to

RECORD = "episode.json"
_MOST_BYTES = 50_000_000

_Kind = TypeVar("_Kind")


def read_record(folder: Path) -> Mapping[str, Any]:
    """Read the values of the record in a run's folder.

    Raises:
        InputError: If the folder does not hold a finished run, or the record is damaged.
    """
    file = folder / RECORD
    if not is_file(file):
        raise InputError(_describe_missing(folder))
    return read_json(file, "record", _DAMAGED)


def read_json(file: Path, what: str, advice: str) -> Mapping[str, Any]:
    """Read a JSON object; messages say what it is, and end with the advice.

    Raises:
        InputError: If it cannot be read, or holds anything else.
    """
    try:
        with open_file(file) as stream:
            content = read_up_to(stream, _MOST_BYTES)
    except OSError as error:
        raise InputError(f"cannot read {file}: {error.strerror or error}") from error
    try:
        values = json.loads(content.decode("utf-8"), parse_constant=_refuse)
    except json.JSONDecodeError as error:
        raise InputError(f"{file}:{error.lineno}:{error.colno}: {error.msg}: {advice}") from error
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"{file}: it cannot be read as JSON ({type(error).__name__}): {advice}") from error
    if not isinstance(values, dict):
        raise InputError(f"{file}: it holds no {what}, which is a JSON object: {advice}")
    return values


def check_record(values: Mapping[str, Any], kind: type[_Kind], file: Path) -> _Kind:
    """Make a dataclass of the values that it names; `file` is for messages.

    Raises:
        InputError: If one is missing or of another type; all are named.
    """
    try:
        return TypeAdapter(kind).validate_python(dict(values))
    except ValidationError as error:
        problems = [
            f"{file}: {'.'.join(str(part) for part in problem['loc'])}: {problem['msg']}" for problem in error.errors()
        ]
        raise InputError("\n".join([*problems, _DAMAGED])) from error


_DAMAGED = "the record is damaged, or trundle did not write it: take it from a copy, or run the scenario again"


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant} is not a finite number")


def _describe_missing(folder: Path) -> str:
    """Say why a folder has no record."""
    if not exists(folder):
        return f"{folder}: no such folder; give the folder that trundle run wrote"
    if not folder.is_dir():
        return f"{folder}: not a folder; give the folder that trundle run wrote, here perhaps {folder.parent}"
    if exists(folder / "drive.csv"):
        return f"{folder}: the record of trundle drive, which has no episode; trundle compare reads it"
    if any(exists(folder / name) for name in (".lock", "trajectory.npz", "previous-run")):
        return f"{folder}: no {RECORD}: the run has not ended, or was killed; wait for it, or run it again"
    return f"{folder}: no {RECORD} in it; give the folder that trundle run wrote"
