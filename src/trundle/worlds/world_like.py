"""`WorldLike`: the part of `World` that the readers and editors of worlds use; `World` itself imports them."""

from __future__ import annotations

from dataclasses import Field
from typing import Any, ClassVar, Protocol, TypeVar

from trundle.maps.from_world import SolidWorld


class WorldLike(SolidWorld, Protocol):
    """A frozen dataclass with the attributes of `trundle.worlds.World`."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def name(self) -> str:
        """Name of the world, for messages."""
        ...

    @property
    def ground_z(self) -> float | None:
        """Height [m] of the ground plane that its file declares."""
        ...


WorldT = TypeVar("WorldT", bound=WorldLike)
