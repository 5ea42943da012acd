"""What is left out of a world: by name, by kind, and by where it lies."""

from __future__ import annotations

import fnmatch
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from trundle.errors import InputError, WorldWarning
from trundle.solids import Solid
from trundle.worlds.world_like import WorldT

_FLOOR_TOP = 0.01
_CEILING_BOTTOM = 2.0
"""[m]; what the words `floor` and `ceiling` leave out by its place."""

_BELOW = "/:[#"
"""What stands in a name between a group (`/World/Rack`, `shelf`) and what is in it (`/Post`, `::board`, `#2`)."""


@dataclass(slots=True)
class Filter:
    """Words that say what is left out; remembers which of them met something.

    A word is the name of a solid or of a group above it, also with `*` and `?`; or a kind (in USD a semantic label),
    whatever its case; or `floor`, what ends within 1 cm above z = 0, or `ceiling`, what starts above 2 m and is wider
    than high.

    Attributes:
        words: As a user wrote them.
        met: Those that something was left out by.
    """

    words: tuple[str, ...]
    met: set[str] = field(default_factory=set[str])

    @classmethod
    def of(cls, words: str | Sequence[str]) -> Filter:
        """Take words as a sequence, or as one text with commas between them."""
        return cls(tuple(word.rstrip("/") or "/" for word in split_words(words)))

    def takes_name(self, name: str) -> bool:
        """Whether a solid, or whatever has a name of this form, is left out by its name or that of a group above it."""
        return self._find(lambda word: _is_within(name, word))

    def takes_kind(self, kind: str) -> bool:
        """Whether a kind is left out."""
        return bool(kind) and self._find(lambda word: fnmatch.fnmatchcase(kind.lower(), _pattern(word.lower())))

    def takes_solid(self, solid: Solid) -> bool:
        """Whether a solid is left out by its name, its kind or its place."""
        return self.takes_name(solid.name) or self.takes_kind(solid.kind) or self._takes_place(solid)

    @property
    def unmet(self) -> list[str]:
        """What nothing was left out by, in the order of writing."""
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

    def _find(self, hits: Callable[[str], bool]) -> bool:
        word = next((word for word in self.words if hits(word)), None)
        if word is not None:
            self.met.add(word)
        return word is not None


def split_words(words: str | Sequence[str]) -> tuple[str, ...]:
    """Words from a sequence, or from one text with commas between them, as the command line gives it.

    Raises:
        InputError: If they are no texts.
    """
    given: object = words  # from a scenario or --set it may be anything
    if isinstance(words, str):
        return tuple(word.strip() for word in words.split(",") if word.strip())
    if not isinstance(given, Sequence) or not all(isinstance(word, str) for word in words):
        raise InputError(f"give words as texts, or as one text with commas between them, got {given!r}")
    return tuple(words)


def leave_out(world: WorldT, words: str | Sequence[str], where: str) -> WorldT:
    """A world without what the words of a `Filter` say.

    Args:
        world: The world.
        words: What to leave out.
        where: Of the world, for messages.

    Warns:
        WorldWarning: About words that nothing was left out by.
    """
    out = Filter.of(words)
    kept = tuple(solid for solid in world.solids if not out.takes_solid(solid))
    warn_of_unmet(out, where)
    return replace(world, solids=kept)


def warn_of_unmet(out: Filter, where: str) -> None:
    """Warn of the words that nothing was left out by."""
    if out.unmet:
        warnings.warn(f"{where}: nothing was left out by: {', '.join(out.unmet)}", WorldWarning, stacklevel=3)


def _is_within(name: str, word: str) -> bool:
    if "*" in word or "?" in word:
        pattern = _pattern(word)
        return fnmatch.fnmatchcase(name, pattern) or fnmatch.fnmatchcase(name, f"{pattern}[{_BELOW}]*")
    return name == word or (name.startswith(word) and name[len(word)] in _BELOW)


def _pattern(word: str) -> str:
    """A pattern in which only `*` and `?` mean something: brackets are part of names."""
    return word.replace("[", "[[]")
