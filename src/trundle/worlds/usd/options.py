"""Names and choices of USD stages."""

from typing import Literal, TypeAlias

Geometry: TypeAlias = Literal["auto", "collision", "visual"]
Missing: TypeAlias = Literal["skip", "error"]
Purpose: TypeAlias = Literal["default", "render", "proxy", "guide"]
UpAxis: TypeAlias = Literal["Y", "Z"]

NAME = "trundle:name"
"""Key of a prim's customData in which trundle's exporter stores a solid's name."""

SEEDS = "trundle:seeds"
"""Attribute of the default prim in which trundle's exporter stores a world's seeds [m]."""
