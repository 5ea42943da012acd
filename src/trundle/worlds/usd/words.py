"""The words that choose what is loaded of a USD stage."""

from typing import Literal, TypeAlias

Geometry: TypeAlias = Literal["auto", "collision", "visual"]
Missing: TypeAlias = Literal["warn", "error"]
Purpose: TypeAlias = Literal["default", "render", "proxy", "guide"]
UpAxis: TypeAlias = Literal["Y", "Z"]
