"""`directives.json`: the directives that were given to a run, in its folder."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from trundle.errors import InputError
from trundle.files.writing import write_text
from trundle.mission.run_files import read_json
from trundle.mission.steering.directives import GivenDirective, directive_fields, directive_name, read_directive
from trundle.values import as_path, check_count, check_number

DIRECTIVES_FILE = "directives.json"

_ADVICE = "take the directives.json of a steered run's folder"
_MOST = 10_000_000
_ALWAYS = ("index", "time", "directive")
_OFTEN = ("by", "refused")


def save_directives(path: str | os.PathLike[str], directives: Sequence[GivenDirective]) -> None:
    """Write the directives of a run as JSON, one a line; `load_directives` reads them.

    Raises:
        OutputError: If it cannot be written.
    """
    lines = ",\n  ".join(json.dumps(_plain(given), ensure_ascii=False, allow_nan=False) for given in directives)
    write_text(path, f'{{"directives": [\n  {lines}\n]}}\n', durable=True)


def load_directives(path: str | os.PathLike[str]) -> tuple[GivenDirective, ...]:
    """Read the directives of a run, to give them again: `Session(…, directives=load_directives(path))`.

    Args:
        path: The file `directives.json`.

    Raises:
        InputError: If it cannot be read, or one of them is no directive; the message says which.
    """
    file = Path(as_path(path, "a file of directives"))
    values = read_json(file, "record of directives", _ADVICE).get("directives")
    if not isinstance(values, list):
        raise InputError(f"{file}: it has no list 'directives': {_ADVICE}")
    found: list[GivenDirective] = []
    for number, entry in enumerate(cast("list[object]", values), 1):
        try:
            given = _read(entry)
            if found and given.index < found[-1].index:
                raise InputError(f"index {given.index} comes after {found[-1].index}: they must be in order")
        except InputError as error:
            raise InputError(f"{file}: directive {number}: {error}") from error
        found.append(given)
    return tuple(found)


def _plain(given: GivenDirective) -> dict[str, object]:
    plain: dict[str, object] = {"index": given.index, "time": given.time, "directive": directive_name(given.directive)}
    plain |= directive_fields(given.directive)
    return plain | {name: value for name in _OFTEN if (value := getattr(given, name))}


def _read(entry: object) -> GivenDirective:
    if not isinstance(entry, dict):
        raise InputError(f"it must be an object, got {entry!r:.80}")
    values = dict(cast("Mapping[str, Any]", entry))
    missing = [name for name in _ALWAYS if name not in values]
    if missing:
        raise InputError(f"it lacks {', '.join(missing)}")
    index, time = check_count("index", values.pop("index"), 0, _MOST), values.pop("time")
    time = check_number("time", time, 0.0, math.inf, "s")
    name = values.pop("directive")
    texts = [values.pop(key, "") for key in _OFTEN]
    for key, text in zip(_OFTEN, texts, strict=True):
        if not isinstance(text, str):
            raise InputError(f"{key} must be a text, got {text!r:.80}")
    return GivenDirective(index, time, read_directive(name, values), *texts)
