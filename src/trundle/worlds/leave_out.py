"""Excluding parts of a world by name, kind or position."""

from __future__ import annotations

import fnmatch
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from trundle.errors import InputError, WorldWarning
from trundle.geometry.solids import Solid
from trundle.worlds.world_like import WorldT

_FLOOR_TOP, _CEILING_BOTTOM = 0.01, 2.0
"""Heights [m] for `floor` and `ceiling`: what ends lower is driven over, what starts higher is above every robot."""

_BELOW = "/:[#"
"""Characters that separate a group (`/World/Rack`, `shelf`) from its members (`/Post`, `::board`, `#2`) in names."""


@dataclass(slots=True)
class Filter:
    """Words that select what is left out; remembers which of them matched.

    A word is the name of a solid or of a group above it, with `*` and `?` as wildcards; or a kind (in USD a semantic
    label), case-insensitive; or `floor` (solids that end within 1 cm above z = 0) or `ceiling` (solids that start above
    2 m and are wider than high).

    Attributes:
        words: The words as the user wrote them.
        met: Words that matched something.
    """

    words: tuple[str, ...]
    met: set[str] = field(default_factory=set[str])

    @classmethod
    def of(cls, words: str | Sequence[str]) -> Filter:
        """Create from a sequence of words, or from one text with commas between them."""
        return cls(tuple(word.rstrip("/") or "/" for word in split_words(words)))

    def takes_name(self, name: str) -> bool:
        """Return whether a solid or other named item is left out by its name or that of a group above it."""
        return self._find(lambda word: _is_within(name, word))

    def takes_kind(self, kind: str) -> bool:
        """Return whether a kind is left out."""
        return bool(kind) and self._find(lambda word: fnmatch.fnmatchcase(kind.lower(), _pattern(word.lower())))

    def takes_solid(self, solid: Solid) -> bool:
        """Return whether a solid is left out by its name, kind or position."""
        return self.takes_name(solid.name) or self.takes_kind(solid.kind) or self._takes_place(solid)

    @property
    def unmet(self) -> list[str]:
        """Words that matched nothing, in the order given."""
        return [word for word in self.words if word not in self.met]

    def _takes_place(self, solid: Solid) -> bool:
        words = {word.lower() for word in self.words}
        if not words & {"floor", "ceiling"}:
            return False
        low, high = solid.bounds()
        if high[2] <= _FLOOR_TOP:
            return self._find(lambda word: word.lower() == "floor")
        across = max(high[0] - low[0], high[1] - low[1])
        return bool(low[2] >= _CEILING_BOTTOM and across > high[2] - low[2]) and self._find(
            lambda word: word.lower() == "ceiling"
        )

    def _find(self, matches: Callable[[str], bool]) -> bool:
        word = next((word for word in self.words if matches(word)), None)
        if word is not None:
            self.met.add(word)
        return word is not None


def split_words(words: str | Sequence[str]) -> tuple[str, ...]:
    """Return words from a sequence, or from one text with commas between them, as given on the command line.

    Raises:
        InputError: If they are not texts.
    """
    given: object = words  # from a scenario or --set it may be anything
    if isinstance(words, str):
        return tuple(word.strip() for word in words.split(",") if word.strip())
    if not isinstance(given, Sequence) or not all(isinstance(word, str) for word in words):
        raise InputError(f"give words as texts, or as one text with commas between them, got {given!r}")
    return tuple(words)


def leave_out(world: WorldT, words: str | Sequence[str], where: str) -> WorldT:
    """Return a world without the solids that the words of a `Filter` match.

    Args:
        world: The world.
        words: What to leave out.
        where: Name of the world, for messages.

    Warns:
        WorldWarning: For words that matched nothing.
    """
    out = Filter.of(words)
    kept = tuple(solid for solid in world.solids if not out.takes_solid(solid))
    warn_of_unmet(out, where)
    return replace(world, solids=kept)


def warn_of_unmet(out: Filter, where: str) -> None:
    """Warn about words that matched nothing."""
    if out.unmet:
        warnings.warn(f"{where}: nothing to exclude matches: {', '.join(out.unmet)}", WorldWarning, stacklevel=3)


def _is_within(name: str, word: str) -> bool:
    if "*" in word or "?" in word:
        pattern = _pattern(word)
        return fnmatch.fnmatchcase(name, pattern) or fnmatch.fnmatchcase(name, f"{pattern}[{_BELOW}]*")
    return name == word or (name.startswith(word) and name[len(word)] in _BELOW)


def _pattern(word: str) -> str:
    """Return a pattern with only `*` and `?` as wildcards: brackets are part of names."""
    return word.replace("[", "[[]")
