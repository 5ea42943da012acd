"""The options of `load_usd`, and the keys under which trundle's exporter stores what USD has no place for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from trundle.errors import InputError

Geometry: TypeAlias = Literal["auto", "collision", "visual"]
Missing: TypeAlias = Literal["skip", "error"]
Purpose: TypeAlias = Literal["default", "render", "proxy", "guide"]
UpAxis: TypeAlias = Literal["Y", "Z"]

NAME = "trundle:name"
"""Key of a prim's customData in which trundle's exporter stores a solid's name."""

SEEDS = "trundle:seeds"
"""Attribute of the default prim in which trundle's exporter stores a world's seeds [m]."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options of `load_usd`, with texts of several words split.

    Raises:
        InputError: If a value is not an allowed choice.
    """

    geometry: str
    exclude: tuple[str, ...]
    missing: str
    purposes: tuple[str, ...]
    variants: tuple[str, ...]
    meters_per_unit: float | None
    up_axis: str | None

    def __post_init__(self) -> None:
        given = [("geometry", self.geometry, get_args(Geometry)), ("missing", self.missing, get_args(Missing))]
        if self.up_axis is not None:
            given.append(("up_axis", self.up_axis, get_args(UpAxis)))
        given += [("a purpose", purpose, get_args(Purpose)) for purpose in self.purposes]
        for what, word, choices in given:
            if word not in choices:
                raise InputError(f"{what} is {word!r}; it must be one of: {', '.join(choices)}")
