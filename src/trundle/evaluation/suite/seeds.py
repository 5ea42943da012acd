"""Seeds of missions: a number of them, a range such as "0:500", or a list."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Annotated, Any, TypeAlias, cast

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

_RANGE = re.compile(r"(\d+):(\d+)(?::(\d+))?")
_ADVICE = 'a number of seeds, a range "0:500", or a list of integers of 0 or more'
_MOST = 2**63
"""Seeds are below it, so that results can hold them."""


def read_seeds(given: object) -> range | tuple[int, ...]:
    """Read seeds as a suite has them; a range is not expanded.

    Raises:
        ValueError: If these are no seeds; the message says what is.
    """
    if isinstance(given, bool):
        raise ValueError(f"must be {_ADVICE}, got {given}")
    if isinstance(given, int):
        if given < 0:
            raise ValueError(f"must be {_ADVICE}, got {given}")
        return range(given)
    if isinstance(given, range):
        return given
    if isinstance(given, str):
        match = _RANGE.fullmatch(given.strip())
        if match is None or match[3] == "0":
            raise ValueError(f"must be {_ADVICE}, got {given!r}")
        return range(int(match[1]), int(match[2]), int(match[3] or 1))
    if not isinstance(given, list | tuple):
        raise ValueError(f"must be {_ADVICE}, got {given!r}")
    seeds = tuple(cast("Sequence[Any]", given))
    if not all(isinstance(seed, int) and not isinstance(seed, bool) and seed >= 0 for seed in seeds):
        raise ValueError(f"must be {_ADVICE}, got {given!r}")
    if len(set(seeds)) < len(seeds):
        twice = next(seed for seed in seeds if seeds.count(seed) > 1)
        raise ValueError(f"seed {twice} is given twice")
    return seeds


def _check(given: object) -> object:
    try:
        seeds = read_seeds(given)
        if (seeds.stop if isinstance(seeds, range) else max(seeds, default=0)) > _MOST:
            raise ValueError("seeds must be below 2^63")
    except ValueError as error:
        raise PydanticCustomError("seeds", "{message}", {"message": str(error)}) from None
    if not seeds:
        raise PydanticCustomError("no_seeds", "no seeds: the cross product has no episodes", {})
    if isinstance(given, range):
        return f"{given.start}:{given.stop}:{given.step}" if given.step != 1 else f"{given.start}:{given.stop}"
    return given if isinstance(given, int | str) else seeds


Seeds: TypeAlias = Annotated[
    int | str | tuple[int, ...], BeforeValidator(_check, json_schema_input_type=int | str | list[int])
]
"""Of missions: 20 (0 to 19), "0:500" (0 to 499), "0:500:5", or [1, 2, 3]."""
