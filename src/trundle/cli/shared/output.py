"""Printing: tables for people, one JSON value for machines, remarks on stderr."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum


def print_json(value: object) -> None:
    """Print one JSON value; NaN and infinity, which JSON does not have, become null."""
    print(json.dumps(plain(value), indent=2, allow_nan=False, ensure_ascii=False))


def print_json_line(value: object) -> None:
    """Print one JSON value on one line, as the last of several."""
    print(json.dumps(plain(value), allow_nan=False, ensure_ascii=False), flush=True)


def print_error(error: Exception, *, hint: str = "") -> None:
    """Print an error as one JSON value: its type, its message, and the hint if there is a separate one."""
    fields = {"type": type(error).__name__, "message": str(error), **({"hint": hint} if hint else {})}
    print_json({"error": fields})


def print_table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print aligned columns under a header."""
    lines = [list(header), *([_text(cell) for cell in row] for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    for line in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def print_facts(facts: Mapping[str, object]) -> None:
    """Print a table of two columns: name and value."""
    width = max(map(len, facts))
    for name, value in facts.items():
        print(f"{name:<{width}}  {_text(value)}")


def report_written(facts: Mapping[str, object], advice: str, *, json: bool, quiet: bool) -> None:
    """Print what was written, as JSON or as a table; and for people what to do with it, on stderr."""
    if json:
        print_json(facts)
    else:
        print_facts(facts)
        remark(advice, quiet=quiet)


def remark(text: str, *, quiet: bool) -> None:
    """Print a remark on stderr."""
    if not quiet:
        print(text, file=sys.stderr, flush=True)


def plain(value: object) -> object:
    """Convert a value for JSON: dataclasses and named tuples to objects, arrays to lists."""
    if value is None or (isinstance(value, bool | int | str) and not isinstance(value, Enum)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Enum):
        return plain(value.value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    fields = getattr(value, "_asdict", None)  # a named tuple
    if callable(fields):
        return plain(fields())
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    items = getattr(value, "tolist", None)  # NumPy's arrays and scalars
    if callable(items):
        return plain(items())
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:z.3f}" if math.isfinite(value) else "-"
    return "-" if value is None else str(value)
