"""The words that choose what is loaded of a USD stage."""

from typing import Literal, TypeAlias

Geometry: TypeAlias = Literal["auto", "collision", "visual"]
Missing: TypeAlias = Literal["skip", "error"]
Purpose: TypeAlias = Literal["default", "render", "proxy", "guide"]
UpAxis: TypeAlias = Literal["Y", "Z"]

NAME = "trundle:name"
"""Key of a prim's customData under which our exporter keeps a solid's name."""

SEEDS = "trundle:seeds"
"""Attribute of the default prim in which our exporter keeps a world's seeds [m]."""
