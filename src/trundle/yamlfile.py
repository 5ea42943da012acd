"""YAML that people write: read with limits, checked by pydantic, every mistake reported as `file:line:column`."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from trundle.errors import InputError

MAX_BYTES = 1_000_000

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]
ModelT = TypeVar("ModelT", bound=BaseModel)


class Config(BaseModel):
    """Base of everything that a person writes in YAML: no unknown keys, no NaN or infinity, frozen once read."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


def compose(path: str | os.PathLike[str], *, max_bytes: int = MAX_BYTES) -> yaml.Node:
    """Read one YAML document as nodes that know their line and column.

    Raises:
        InputError: If the file is missing, too large, not UTF-8, empty, not YAML, more than one document, uses
            anchors or aliases, or repeats a key.
    """
    source = Path(path)
    return compose_text(_read_text(source, max_bytes), str(source))


def compose_text(text: str, name: str) -> yaml.Node:
    """Read one YAML document from text; `name` stands for the file in messages. Raises as `compose` does."""
    try:
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
                raise InputError(
                    f"{_place(name, event.start_mark)}: anchors and aliases are not accepted; write the value out"
                )
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = _place(name, mark) if mark is not None else name
        raise InputError(f"{where}: not valid YAML: {error.problem or error.context}") from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: not valid YAML: {error}") from error
    if node is None:
        raise InputError(f"{name}: the file is empty")
    _refuse_duplicate_keys(node, name)
    return node


def load_config(path: str | os.PathLike[str], model: type[ModelT]) -> ModelT:
    """Read a YAML file into a pydantic model.

    Raises:
        InputError: As `compose`, and for every value that the model refuses, one line each.
    """
    return validate(compose(path), model, str(Path(path)))


def validate(node: yaml.Node, model: type[ModelT], name: str) -> ModelT:
    """Check a YAML node against a pydantic model; `name` stands for the file in messages."""
    try:
        return model.model_validate(plain_value(node, name))
    except ValidationError as error:
        lines = [_describe(problem["loc"], problem["msg"], node, name) for problem in error.errors()]
        raise InputError("\n".join(lines)) from error


def plain_value(node: yaml.Node, name: str) -> Plain:
    """Turn a node into plain Python values; `1e-3` is a number here, which PyYAML reads as text."""
    if isinstance(node, yaml.MappingNode):
        return {str(key.value): plain_value(value, name) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [plain_value(item, name) for item in node.value]
    if not isinstance(node, yaml.ScalarNode):
        raise InputError(f"{place(node, name)}: not a value that can be read")
    loader = yaml.SafeLoader("")
    try:
        value = loader.construct_object(node)
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(f"{place(node, name)}: {node.value!r} cannot be read: {error}") from error
    finally:
        loader.dispose()
    if isinstance(value, str) and node.style is None:
        try:
            number = float(value)
        except ValueError:
            return value
        return number if math.isfinite(number) else value
    return value if isinstance(value, bool | int | float | str) or value is None else str(node.value)


def place(node: yaml.Node, name: str) -> str:
    """`file:line:column` of a node, counted from 1."""
    return _place(name, node.start_mark)


def _read_text(path: Path, max_bytes: int) -> str:
    try:
        with path.open("rb") as stream:
            content = stream.read(max_bytes + 1)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error
    if len(content) > max_bytes:
        raise InputError(f"{path}: larger than {max_bytes} bytes; this is not a settings file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file in UTF-8 (byte {error.start})") from error


def _place(name: str, mark: yaml.Mark) -> str:
    return f"{name}:{mark.line + 1}:{mark.column + 1}"


def _refuse_duplicate_keys(node: yaml.Node, name: str) -> None:
    children: Sequence[yaml.Node]
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise InputError(f"{place(key, name)}: a key must be a plain name")
            if key.value in seen:
                raise InputError(f"{place(key, name)}: the key {key.value!r} is given twice")
            seen.add(key.value)
        children = [value for _, value in node.value]
    elif isinstance(node, yaml.SequenceNode):
        children = node.value
    else:
        return
    for child in children:
        _refuse_duplicate_keys(child, name)


def _describe(location: Sequence[int | str], message: str, root: yaml.Node, name: str) -> str:
    node = root
    for part in location:
        if isinstance(node, yaml.MappingNode):
            entries = {key.value: (key, value) for key, value in node.value}
            if str(part) not in entries:
                break
            key, value = entries[str(part)]
            node = value if part is not location[-1] or not message.startswith("Extra inputs") else key
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
    dotted = ".".join(str(part) for part in location)
    return f"{place(node, name)}: {dotted + ': ' if dotted else ''}{message}"
