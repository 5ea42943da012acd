"""What is checked of an MJCF file before MuJoCo sees it: what it includes, and how much it says to make.

MuJoCo's reader follows a model that attaches itself until it crashes, waits for pipes, and makes as many copies as a
file says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from trundle.errors import InputError
from trundle.files.opening import check_regular, exists
from trundle.files.xml_elements import XmlElement, read_xml

MAX_FILES = 1_000
"""Of includes and attached models together."""

MAX_DEPTH = 32
"""Of files inside each other."""

MAX_ELEMENTS = 1_000_000
"""Of all files, counted as often as they are made."""

_COPIES = ("replicate", "composite", "flexcomp")
_FOLDERS = ("meshdir", "texturedir", "assetdir")


def check_mjcf(path: Path, root: XmlElement, *, error: type[InputError]) -> None:
    """Check an MJCF file and those that it includes or attaches.

    Args:
        path: The file.
        root: Its content.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if a file in it contains itself, is no regular file or no XML, or there is too
            much of it; the message has file and line.
    """
    _Check(error, path.parent).check(path, root, ())


@dataclass(slots=True)
class _Check:
    """A walk through the files.

    Attributes:
        error: Type of the exception.
        home: Folder of the main file.
        files: How many were walked.
        elements: How many there were, counted as often as they are made.
    """

    error: type[InputError]
    home: Path
    files: int = 0
    elements: int = 0
    _folders: list[Path] = field(default_factory=list[Path])

    def check(self, path: Path, root: XmlElement, above: tuple[Path, ...]) -> None:
        """Check a file; `above` are those around it."""
        above = (*above, path.resolve())
        self._folders += [
            self.home / folder
            for compiler in root.iter("compiler")
            for folder in map(compiler.get, _FOLDERS)
            if folder is not None
        ]
        for element, copies in _elements(root, 1):
            where = f"{path}:{element.line}"
            self.elements += copies
            if self.elements > MAX_ELEMENTS:
                raise self.error(f"{where}: this makes more than {MAX_ELEMENTS} elements; make fewer copies")
            name = element.get("file")
            if name is None:
                continue
            found = self._find(path, name)
            if found is None:
                continue  # MuJoCo says that it is not there, if it wants it
            try:
                check_regular(found)
            except OSError as problem:
                raise self.error(f"{where}: cannot read {found}: {problem.strerror or problem}") from problem
            if element.tag in ("include", "model"):
                self._enter(where, found, above)

    def _enter(self, where: str, file: Path, above: tuple[Path, ...]) -> None:
        if file.resolve() in above:
            raise self.error(f"{where}: {file.name} contains itself")
        self.files += 1
        if self.files > MAX_FILES or len(above) > MAX_DEPTH:
            raise self.error(
                f"{where}: more than {MAX_FILES} files, or {MAX_DEPTH} inside each other, are included in this model"
            )
        if file.suffix.lower() in (".xml", ".mjcf", ".urdf"):
            self.check(file, read_xml(file, error=self.error), above)

    def _find(self, path: Path, name: str) -> Path | None:
        folders = (path.parent, self.home, *self._folders)
        return next((folder / name for folder in folders if exists(folder / name)), None)


def _elements(root: XmlElement, copies: int) -> Iterator[tuple[XmlElement, int]]:
    """All elements, with how many of each are made."""
    stack = [(root, copies)]
    while stack:
        element, times = stack.pop()
        if element.tag in _COPIES:
            times *= _count(element)
        yield element, times
        stack.extend((cast("XmlElement", child), times) for child in element)


def _count(element: XmlElement) -> int:
    """How many copies an element makes; 1 where MuJoCo will not understand it."""
    try:
        return max(1, math.prod(int(word) for word in element.get("count", "1").split()))
    except ValueError:
        return 1
