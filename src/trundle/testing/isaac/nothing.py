"""Stands in for parts of Kit that have no effect here: windows, viewports, commands, the renderer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Self

called: dict[str, int] = {}
"""Names that were called, in order, and how often."""


class Nothing:
    """Accepts any call, gives itself back for any attribute, is false and empty.

    Args:
        name: Dotted name of what it stands in for.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Nothing:
        if name.startswith("__") or name == "_name":
            raise AttributeError(name)
        made = Nothing(f"{self._name}.{name}")
        self.__dict__[name] = made
        return made

    def __call__(self, *_: object, **__: object) -> Nothing:  # noqa: D102
        called[self._name] = called.get(self._name, 0) + 1
        return Nothing(f"{self._name}()")

    def __mro_entries__(self, _: tuple[Any, ...]) -> tuple[type, ...]:
        return (object,)

    def __bool__(self) -> bool:
        return False

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __int__(self) -> int:
        return 0

    def __float__(self) -> float:
        return 0.0

    def __or__(self, other: object) -> object:
        return other

    __ror__ = __or__

    def __getitem__(self, _: object) -> Nothing:
        return self

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def __await__(self) -> Iterator[Any]:
        return iter(())

    def __repr__(self) -> str:
        return f"<{self._name}, which does nothing here>"
