"""Reading XML with size limits, without document types or entities; every element knows its line."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from typing import cast
from xml.parsers import expat

from trundle.errors import InputError
from trundle.files.opening import read_limited

MAX_BYTES = 64 * 1024 * 1024
"""Size limit of a file: 160 times the largest BARN world."""

MAX_DEPTH = 200
"""Limit on nested elements; worlds and robots need about twenty."""


class XmlElement(ElementTree.Element):
    """An element that knows the line that it starts on."""

    line: int = 0


def read_xml(path: str | os.PathLike[str], *, error: type[InputError]) -> XmlElement:
    """Read an XML file; see `parse_xml`.

    Raises:
        InputError: Of the type `error`, also if the file cannot be read or is too large.
    """
    return parse_xml(path, read_source(path, error=error), error=error)


def read_source(path: str | os.PathLike[str], *, error: type[InputError]) -> bytes:
    """Read the bytes of an XML file, at most `MAX_BYTES`."""
    return read_limited(path, MAX_BYTES, f"larger than the limit of {MAX_BYTES // 1024**2} MiB", error=error)


def parse_xml(path: str | os.PathLike[str], content: bytes, *, error: type[InputError]) -> XmlElement:
    """Parse XML without document types, and so without entities, to at most `MAX_DEPTH` nested elements.

    Args:
        path: For messages.
        content: The file's bytes.
        error: Type of the exception.

    Raises:
        InputError: Of the type `error`, if it is not well-formed, declares a document type or nests too deeply; the
            message has the line.
    """
    parser = expat.ParserCreate()
    depth = 0

    def make(tag: str, attributes: dict[str, str]) -> XmlElement:
        element = XmlElement(tag, attributes)
        element.line = parser.CurrentLineNumber
        return element

    builder = ElementTree.TreeBuilder(element_factory=make)

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise error(f"{path}:{parser.CurrentLineNumber}: elements nested more than {MAX_DEPTH} deep")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: object) -> None:
        raise error(f"{path}:{parser.CurrentLineNumber}: a <!DOCTYPE …> is not accepted; remove it")

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(content, True)
    except InputError:
        raise
    except expat.ExpatError as problem:
        reason = expat.ErrorString(problem.code)
        raise error(f"{path}:{problem.lineno}:{problem.offset + 1}: not XML: {reason}") from problem
    except (LookupError, ValueError) as problem:  # an encoding that Python does not know
        raise error(f"{path}: not XML: {problem}") from problem
    return cast("XmlElement", builder.close())
