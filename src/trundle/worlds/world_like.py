"""`WorldLike`: the part of `World` that the readers and editors of worlds use; `World` itself imports them."""

from __future__ import annotations

from dataclasses import Field
from typing import Any, ClassVar, Protocol, TypeVar

from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid


class WorldLike(Protocol):
    """A frozen dataclass with the attributes of `trundle.worlds.World`."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def name(self) -> str:
        """For messages."""
        ...

    @property
    def solids(self) -> tuple[Solid, ...]:
        """The solids; names are unique."""
        ...

    @property
    def seeds(self) -> tuple[tuple[float, float], ...]:
        """Points (x, y) [m] that are free and reachable."""
        ...

    @property
    def ground_z(self) -> float | None:
        """Height [m] of the ground plane that its file declares."""
        ...

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Axis-aligned bounds (low, high) [m] of all solids, each of shape (3,)."""
        ...


WorldT = TypeVar("WorldT", bound=WorldLike)
