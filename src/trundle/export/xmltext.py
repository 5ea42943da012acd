"""Writing XML: indented, with numbers that read back exactly."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable

import numpy as np


def numbers(values: Iterable[float]) -> str:
    """Numbers separated by spaces, each with the fewest digits that read back exactly."""
    return " ".join(_number(value) for value in np.asarray(list(values), dtype=np.float64).tolist())


def add(parent: ElementTree.Element, tag: str, text: str | None = None, **attributes: str) -> ElementTree.Element:
    """Add an element with a text and attributes."""
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text
    return element


def to_text(root: ElementTree.Element) -> str:
    """The whole file."""
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0") if text != "-0.0" else "0"
