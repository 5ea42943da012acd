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
from trundle.files.yaml_nodes import compose, compose_text, place

__all__ = ["Config", "Plain", "compose", "compose_text", "load_config", "place", "plain_value", "validate"]

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]
ModelT = TypeVar("ModelT", bound=BaseModel)


class Config(BaseModel):
    """Base of everything that a person writes in YAML: no unknown keys, no NaN or infinity, frozen once read."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


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
