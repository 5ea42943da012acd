"""Files in the folder of a run: `episode.json`, `paths.npz`, and `directives.json`, which steered it."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from typing import Any, TypeVar, cast

import numpy as np
import numpy.typing as npt
from pydantic import TypeAdapter, ValidationError

from trundle.errors import InputError
from trundle.files.npz import read_arrays
from trundle.files.opening import describe_unreadable, exists, is_file, open_file, read_up_to
from trundle.files.writing import write_text
from trundle.mission.steering.directives import GivenDirective, directive_fields, directive_name, read_directive
from trundle.mission.trajectory import write_arrays
from trundle.path import Path
from trundle.values import as_array, as_path, check_count, check_number

RECORD = "episode.json"
_MOST_BYTES = 50_000_000

_Kind = TypeVar("_Kind")


def read_record(folder: FilePath) -> Mapping[str, Any]:
    """Read the values of the record in a run's folder.

    Raises:
        InputError: If the folder does not hold a finished run, or the record is damaged.
    """
    file = folder / RECORD
    if not is_file(file):
        raise InputError(_describe_missing(folder))
    return read_json(file, "record", _DAMAGED)


def read_json(file: FilePath, what: str, advice: str) -> Mapping[str, Any]:
    """Read a JSON object; messages say what it is, and end with the advice.

    Raises:
        InputError: If it cannot be read, or holds anything else.
    """
    try:
        with open_file(file) as stream:
            content = read_up_to(stream, _MOST_BYTES)
    except OSError as error:
        raise InputError(describe_unreadable(file, error)) from error
    try:
        values = json.loads(content.decode("utf-8"), parse_constant=_refuse)
    except json.JSONDecodeError as error:
        raise InputError(f"{file}:{error.lineno}:{error.colno}: {error.msg}: {advice}") from error
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"{file}: it cannot be read as JSON ({type(error).__name__}): {advice}") from error
    if not isinstance(values, dict):
        raise InputError(f"{file}: it holds no {what}, which is a JSON object: {advice}")
    return values


def check_record(values: Mapping[str, Any], kind: type[_Kind], file: FilePath) -> _Kind:
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


def _describe_missing(folder: FilePath) -> str:
    """Return why a folder has no record."""
    if not exists(folder):
        return f"{folder}: no such folder; give the folder that trundle run wrote"
    if not folder.is_dir():
        return f"{folder}: not a folder; give the folder that trundle run wrote, here perhaps {folder.parent}"
    if exists(folder / "drive.csv"):
        return f"{folder}: the record of trundle drive, which has no episode; trundle compare reads it"
    if any(exists(folder / name) for name in (".lock", "trajectory.npz", "previous-run")):
        return f"{folder}: no {RECORD}: the run has not ended, or was killed; wait for it, or run it again"
    return f"{folder}: no {RECORD} in it; give the folder that trundle run wrote"


_NUMBERS = ("cost", "start_snapped_m", "goal_snapped_m", "remaining_m")
_KEYS = ("poses", "backward", "count", "planner", "replans", "partial", *_NUMBERS)


def save_paths(file: str | os.PathLike[str], paths: Sequence[Path]) -> None:
    """Write paths as an .npz that `load_paths` reads back bit for bit.

    Raises:
        OutputError: If it cannot be written; nothing is left behind.
    """
    none = np.zeros((0, 3))
    columns = {
        "poses": np.concatenate([none, *(path.poses for path in paths)]),
        "backward": np.concatenate([np.zeros(0, np.bool_), *(path.backward for path in paths)]),
        "count": np.array([len(path) for path in paths], dtype=np.int64),
        "planner": np.array([path.planner for path in paths], dtype=np.str_),
        "replans": np.array([path.replans for path in paths], dtype=np.int64),
        "partial": np.array([path.status == "partial" for path in paths], dtype=np.bool_),
    }
    columns |= {name: np.array([getattr(path, name) for path in paths], dtype=np.float64) for name in _NUMBERS}
    write_arrays(file, columns)


def load_paths(file: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Read what `save_paths` wrote.

    Raises:
        InputError: If the file cannot be read, or does not hold paths.
    """
    name = os.fspath(file)
    arrays, _ = read_arrays(file, _KEYS, error=InputError)
    missing = [key for key in _KEYS if key not in arrays]
    if missing:
        raise InputError(f"{name}: not the paths of a run: it has no {', '.join(missing)}")
    try:
        return _split(arrays)
    except InputError as error:
        raise InputError(f"{name}: not the paths of a run: {error}") from error
    except (TypeError, ValueError, OverflowError, IndexError, SystemError) as error:  # the last for text beyond Unicode
        raise InputError(f"{name}: not the paths of a run: its arrays do not fit together: {error}") from error


def _split(arrays: Mapping[str, npt.NDArray[Any]]) -> tuple[Path, ...]:
    counts = as_array(arrays["count"], np.int64, "count")
    if counts.ndim != 1 or (counts < 1).any() or {len(arrays[key]) for key in _KEYS[2:]} != {len(counts)}:
        raise InputError("its arrays do not have one entry for each path")
    if len(arrays["poses"]) != counts.sum() or len(arrays["backward"]) != (counts - 1).sum():
        raise InputError("its poses and legs are not as many as its counts say")
    poses = np.split(arrays["poses"], np.cumsum(counts)[:-1])
    backward = np.split(arrays["backward"], np.cumsum(counts - 1)[:-1])
    return tuple(
        Path(
            poses[index],
            backward=backward[index],
            planner=str(arrays["planner"][index]),
            replans=int(arrays["replans"][index]),
            status="partial" if arrays["partial"][index] else "found",
            **{key: float(arrays[key][index]) for key in _NUMBERS},
        )
        for index in range(len(counts))
    )


DIRECTIVES_FILE = "directives.json"

_STEERED = "take the directives.json of a steered run's folder"
_MOST_PERIODS = 10_000_000
_ALWAYS = ("index", "time", "directive")
_OFTEN = ("by", "refused")


def save_directives(path: str | os.PathLike[str], directives: Sequence[GivenDirective]) -> None:
    """Write the directives of a run as JSON, one a line; `load_directives` reads them.

    Raises:
        OutputError: If it cannot be written.
    """
    lines = ",\n  ".join(json.dumps(_plain_given(given), ensure_ascii=False, allow_nan=False) for given in directives)
    write_text(path, f'{{"directives": [\n  {lines}\n]}}\n', durable=True)


def load_directives(path: str | os.PathLike[str]) -> tuple[GivenDirective, ...]:
    """Read the directives of a run, to give them again: `Session(…, directives=load_directives(path))`.

    Args:
        path: The file `directives.json`.

    Raises:
        InputError: If it cannot be read, or one of them is no directive; the message says which.
    """
    file = FilePath(as_path(path, "a file of directives"))
    values = read_json(file, "record of directives", _STEERED).get("directives")
    if not isinstance(values, list):
        raise InputError(f"{file}: it has no list 'directives': {_STEERED}")
    found: list[GivenDirective] = []
    for number, entry in enumerate(cast("list[object]", values), 1):
        try:
            given = _read_given(entry)
            if found and given.index < found[-1].index:
                raise InputError(f"index {given.index} comes after {found[-1].index}: they must be in order")
        except InputError as error:
            raise InputError(f"{file}: directive {number}: {error}") from error
        found.append(given)
    return tuple(found)


def _plain_given(given: GivenDirective) -> dict[str, object]:
    plain: dict[str, object] = {"index": given.index, "time": given.time, "directive": directive_name(given.directive)}
    plain |= directive_fields(given.directive)
    return plain | {name: value for name in _OFTEN if (value := getattr(given, name))}


def _read_given(entry: object) -> GivenDirective:
    if not isinstance(entry, dict):
        raise InputError(f"it must be an object, got {entry!r:.80}")
    values = dict(cast("Mapping[str, Any]", entry))
    missing = [name for name in _ALWAYS if name not in values]
    if missing:
        raise InputError(f"it lacks {', '.join(missing)}")
    index, time = check_count("index", values.pop("index"), 0, _MOST_PERIODS), values.pop("time")
    time = check_number("time", time, 0.0, math.inf, "s")
    name = values.pop("directive")
    texts = [values.pop(key, "") for key in _OFTEN]
    for key, text in zip(_OFTEN, texts, strict=True):
        if not isinstance(text, str):
            raise InputError(f"{key} must be a text, got {text!r:.80}")
    return GivenDirective(index, time, read_directive(name, values), *texts)
