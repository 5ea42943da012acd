"""Validation of the options of generators and loaders."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Literal, TypeAlias

from trundle.errors import InputError

Unknown: TypeAlias = Literal["solid", "free"]
"""How unknown cells of a map are treated in a world."""


def check_choice(option: str, value: object, choices: tuple[str, ...]) -> None:
    """Refuse a value that is not among an option's choices.

    Raises:
        InputError: If it is not.
    """
    if value not in choices:
        raise InputError(f"{option} is {value!r}; it must be {' or '.join(map(repr, choices))}")


def check_options(where: str, owner: str, given: Iterable[str], known: Sequence[str]) -> None:
    """Refuse unknown options, with a hint to the nearest known one.

    Args:
        where: Prefix of the message.
        owner: Whose options they are, "a .sdf file".
        given: Their names.
        known: Names of all options.

    Raises:
        InputError: If one is not known.
    """
    for name in given:
        if name not in known:
            nearest = difflib.get_close_matches(name, known, n=1)
            hint = f" (did you mean {nearest[0]!r}?)" if nearest else ""
            raise InputError(f"{where}: {name!r} is not an option of {owner}{hint}; there are: {', '.join(known)}")
