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
from trundle.yamlnodes import compose, compose_text, place

<<<<<<< HEAD
__all__ = ["Config", "Plain", "compose", "compose_text", "load_config", "place", "plain_value", "validate"]
=======
MAX_BYTES = 250_000
MAX_DEPTH = 32
>>>>>>> bb2444d (Test the base values; limit the depth of YAML)

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]
ModelT = TypeVar("ModelT", bound=BaseModel)


class Config(BaseModel):
    """Base of everything that a person writes in YAML: no unknown keys, no NaN or infinity, frozen once read."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


<<<<<<< HEAD
=======
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
        depth = 0
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > MAX_DEPTH:
                raise InputError(f"{_place(name, event.start_mark)}: nested more than {MAX_DEPTH} levels deep")
            if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
                raise InputError(
                    f"{_place(name, event.start_mark)}: anchors and aliases are not accepted; write the value out"
                )
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = _place(name, mark) if mark is not None else name
        raise InputError(f"{where}: not valid YAML: {error.problem or error.context}") from error
    except yaml.YAMLError as error:
        raise InputError(f"{name}: not valid YAML: {error}") from error
    if node is None:
        raise InputError(f"{name}: the file is empty")
    _refuse_duplicate_keys(node, name)
    return node


>>>>>>> bb2444d (Test the base values; limit the depth of YAML)
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
