"""Checks on an MJCF file before MuJoCo reads it: its includes and the number of elements it generates.

MuJoCo's reader recurses into a model that attaches itself until it crashes, blocks on pipes, and creates any number
of copies.
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
"""Limit on included and attached files together."""

MAX_DEPTH = 32
"""Limit on nested includes."""

MAX_ELEMENTS = 1_000_000
"""Limit on elements in all files, counted once per generated copy."""

MAX_SAMPLES = 20_000_000
"""Limit on the heights of a height field: MuJoCo gives no reason where it gets no memory for them."""

_COPIES = ("replicate", "composite", "flexcomp")
_FOLDERS = ("meshdir", "texturedir", "assetdir")


def check_mjcf(path: Path, root: XmlElement, *, error: type[InputError]) -> None:
    """Check an MJCF file and those that it includes or attaches.

    Args:
        path: The file.
        root: Its content.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if a file includes itself, is not a regular file or not XML, or a limit is
            exceeded; the message has file and line.
    """
    _Check(error, path.parent).check(path, root, ())


@dataclass(slots=True)
class _Check:
    """A walk through the files.

    Attributes:
        error: Type of the exception.
        home: Folder of the main file.
        files: Number of files visited.
        elements: Number of elements, counted once per generated copy.
    """

    error: type[InputError]
    home: Path
    files: int = 0
    elements: int = 0
    _folders: list[Path] = field(default_factory=list[Path])

    def check(self, path: Path, root: XmlElement, above: tuple[Path, ...]) -> None:
        """Check a file; `above` are the files that include it."""
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
                raise self.error(f"{where}: this generates more than {MAX_ELEMENTS} elements; use fewer copies")
            if element.tag == "hfield":
                self._check_heights(where, element)
            name = element.get("file")
            if name is None:
                continue
            found = self._find(path, name)
            if found is None:
                continue  # if MuJoCo needs it, MuJoCo reports that it is missing
            try:
                check_regular(found)
            except OSError as problem:
                raise self.error(f"{where}: cannot read {found}: {problem.strerror or problem}") from problem
            if element.tag in ("include", "model"):
                self._enter(where, found, above)

    def _check_heights(self, where: str, element: XmlElement) -> None:
        """Check the size of a height field; MuJoCo checks all else of it."""
        try:
            rows, cols = (int(element.get(name, "0")) for name in ("nrow", "ncol"))
        except ValueError:
            return  # MuJoCo reports it
        if min(rows, cols) < 0 or rows * cols > MAX_SAMPLES:
            raise self.error(
                f"{where}: a height field has up to {MAX_SAMPLES} heights, got nrow {rows} and ncol {cols}; "
                "make it coarser, or correct the numbers"
            )

    def _enter(self, where: str, file: Path, above: tuple[Path, ...]) -> None:
        if file.resolve() in above:
            raise self.error(f"{where}: {file.name} includes itself")
        self.files += 1
        if self.files > MAX_FILES or len(above) > MAX_DEPTH:
            raise self.error(
                f"{where}: this model includes more than {MAX_FILES} files, or nests them more than {MAX_DEPTH} deep"
            )
        if file.suffix.lower() in (".xml", ".mjcf", ".urdf"):
            self.check(file, read_xml(file, error=self.error), above)

    def _find(self, path: Path, name: str) -> Path | None:
        folders = (path.parent, self.home, *self._folders)
        return next((folder / name for folder in folders if exists(folder / name)), None)


def _elements(root: XmlElement, copies: int) -> Iterator[tuple[XmlElement, int]]:
    """All elements, each with its number of generated copies."""
    stack = [(root, copies)]
    while stack:
        element, times = stack.pop()
        if element.tag in _COPIES:
            times *= _count(element)
        yield element, times
        stack.extend((cast("XmlElement", child), times) for child in element)


def _count(element: XmlElement) -> int:
    """Number of copies that an element generates; 1 if MuJoCo cannot parse the number."""
    try:
        return max(1, math.prod(int(word) for word in element.get("count", "1").split()))
    except ValueError:
        return 1
