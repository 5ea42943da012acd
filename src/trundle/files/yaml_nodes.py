"""Reading YAML, with limits, as nodes that know their line and column; mistakes are reported with both."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import yaml

from trundle.errors import InputError
from trundle.files.opening import read_limited
from trundle.values import as_path

MAX_BYTES = 250_000
"""Size limit of a settings file: PyYAML takes seconds, and over a hundred times as much memory."""

MAX_DEPTH = 32
"""Limit on nested values: PyYAML calls itself for each level, and Python ends at about a thousand calls."""


class _LimitedLoader(yaml.SafeLoader):
    """Composes nodes, and stops at anchors, aliases and deep nesting before they use memory."""

    def __init__(self, text: str, name: str) -> None:
        self._name = name
        self._depth = 0
        super().__init__(text)

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise InputError(
                f"{_place(self._name, event.start_mark)}: anchors and aliases are not accepted; write the value out"
            )
        if self._depth > MAX_DEPTH:
            raise InputError(f"{_place(self._name, event.start_mark)}: nested more than {MAX_DEPTH} levels deep")
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node


def compose(
    path: str | os.PathLike[str],
    *,
    max_bytes: int = MAX_BYTES,
    allow_duplicate_keys: bool = False,
    wanted: str = "",
) -> yaml.Node:
    """Read one YAML document as nodes that know their line and column.

    Args:
        path: The file.
        max_bytes: The largest file to accept.
        allow_duplicate_keys: Accept repeated keys, and keys that are not plain names, for formats that allow them.
        wanted: What to give where there is no such file, for the message.

    Raises:
        InputError: If the file is missing, too large, not UTF-8, empty, not YAML, more than one document, uses
            anchors or aliases, or repeats a key.
    """
    source = Path(as_path(path, "a YAML file"))
    return compose_text(read_text(source, max_bytes, wanted), str(source), allow_duplicate_keys=allow_duplicate_keys)


def compose_text(text: str, name: str, *, allow_duplicate_keys: bool = False) -> yaml.Node:
    """Read one YAML document from text; `name` stands for the file in messages. Raises as `compose` does."""
    try:
        node = _LimitedLoader(text, name).get_single_node()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = _place(name, mark) if mark is not None else name
        raise InputError(f"{where}: not valid YAML: {error.problem or error.context}") from error
    except (yaml.YAMLError, OverflowError) as error:
        raise InputError(f"{name}: not valid YAML: {error}") from error
    except ValueError as error:
        # From numbers in escapes and directives, which PyYAML passes to int() and chr() unchecked.
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: not valid YAML: {error}") from error
    if node is None:
        raise InputError(f"{name}: the file is empty; write `key: value` lines into it, or give another file")
    if not allow_duplicate_keys:
        _refuse_duplicate_keys(node, name)
    return node


def place(node: yaml.Node, name: str) -> str:
    """Return `file:line:column` of a node, counted from 1."""
    return _place(name, node.start_mark)


def keys_of(node: yaml.Node) -> list[str]:
    """Return the keys of a mapping; of any other node none."""
    if not isinstance(node, yaml.MappingNode):
        return []
    return [key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode)]


def read_text(path: Path, max_bytes: int = MAX_BYTES, wanted: str = "") -> str:
    """Read a text file; `wanted` is what to give where there is none, for the message.

    Raises:
        InputError: If it cannot be read, is too large, or is not UTF-8.
    """
    too_large = f"larger than {max_bytes} bytes; this is not a settings file"
    content = read_limited(path, max_bytes, too_large, error=InputError, wanted=wanted)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file in UTF-8 (byte {error.start}); save it as UTF-8") from error


def _place(name: str, mark: yaml.Mark) -> str:
    return f"{name}:{mark.line + 1}:{mark.column + 1}"


def _refuse_duplicate_keys(node: yaml.Node, name: str) -> None:
    children: Sequence[yaml.Node]
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise InputError(f"{place(key, name)}: a key must be a plain name, as in `name: value`")
            if key.value in seen:
                raise InputError(f"{place(key, name)}: the key {key.value!r} is given twice; leave one out")
            seen.add(key.value)
        children = [value for _, value in node.value]
    elif isinstance(node, yaml.SequenceNode):
        children = node.value
    else:
        return
    for child in children:
        _refuse_duplicate_keys(child, name)
