"""Pydantic's errors as readable messages: location, value, allowed values, and the nearest known name."""

from __future__ import annotations

import difflib
import inspect
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, TypeAlias

import yaml
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from trundle.files.yaml_nodes import place
from trundle.values import show_value

Location: TypeAlias = tuple[int | str, ...]

_TYPES = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "an integer",
    "int_parsing": "an integer",
    "int_from_float": "an integer",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
}
"""What a value must be, by the type of pydantic's error."""

_RANGES = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
_LENGTHS = ("too_short", "too_long")


def describe_problems(
    problems: Sequence[ErrorDetails],
    model: type[BaseModel],
    given: object,
    *,
    name: str = "",
    node: yaml.Node | None = None,
) -> list[str]:
    """Describe each problem of a rejected value on one line.

    Args:
        problems: What pydantic found.
        model: The model that rejected the value.
        given: The rejected value, plain.
        name: Name of the file, for messages; if empty, the lines begin with the field.
        node: The file's content; values that are not in it get no line and column.
    """
    in_file = node is not None
    found: dict[Location, str] = {}
    unknown: list[Location] = []
    for problem in problems:
        if _is_other_branch(problem, problems):
            continue
        location = _strip_tags(problem, given)
        if location in found:  # the value matches none of several types
            found[location] = "must be a single value, or a list of them"
            continue
        found[location] = _describe(problem, location, model, in_file)
        if problem["type"] == "extra_forbidden":
            unknown.append(location)
    for location in unknown:  # a key that is missing because it is misspelt is one mistake
        nearest = _nearest(str(location[-1]), _keys(model, location[:-1], in_file))
        found.pop((*location[:-1], nearest or ""), None)
    lines: list[str] = []
    for location in [*unknown, *(one for one in found if one not in unknown)]:  # the rest may follow from a misspelling
        text = found[location]
        where = name if node is None else _place(location, node, name, of_key=location in unknown)
        lines.append(": ".join(part for part in (where, ".".join(map(str, location)), text) if part))
    return lines


def _is_other_branch(problem: ErrorDetails, problems: Sequence[ErrorDetails]) -> bool:
    """Return whether the type tried is not one for mappings: another one, which takes them, says what is wrong."""
    union = problem["loc"][:-1]
    return (
        isinstance(problem["input"], Mapping)
        and problem["type"] in _TYPES
        and any(other["loc"][: len(union)] == union and other["type"] not in _TYPES for other in problems)
    )


def _strip_tags(problem: ErrorDetails, given: object) -> Location:
    """Return the location of a problem without what pydantic adds: names of union types, and the 0 of a list of one."""
    location: list[int | str] = []
    parts = problem["loc"]
    for index, part in enumerate(parts):
        is_key = isinstance(given, Mapping) and part in given
        is_item = isinstance(given, list | tuple) and isinstance(part, int) and part < len(given)
        if is_key or is_item:
            given = given[part]  # type: ignore[index]
            location.append(part)
        elif problem["type"] == "missing" and index == len(parts) - 1:
            location.append(part)
    return tuple(location)


def _describe(problem: ErrorDetails, location: Location, model: type[BaseModel], in_file: bool) -> str:
    kind, value, context = problem["type"], problem["input"], problem.get("ctx", {})
    if kind == "missing":
        return "is missing"
    if kind == "extra_forbidden":
        keys = _keys(model, location[:-1], in_file)
        return f"unknown key.{_hint(str(location[-1]), keys)} There are: {', '.join(keys)}"
    if kind == "value_error":
        return str(context.get("error", problem["msg"]))
    if kind == "literal_error":
        choices = _literals(_field(model, location))
        if choices:
            return f"{_show(value)} is unknown.{_hint(str(value), choices)} There are: {', '.join(choices)}"
        return f"{_show(value)} is unknown; it must be {context.get('expected')}"
    if kind in _RANGES:
        return f"{_show(value)} is out of range: it must be {_range(_field(model, location), context)}"
    if kind in _LENGTHS:
        return f"has {context['actual_length']} items, it must have {_length(_field(model, location), context)}"
    if kind in _TYPES:
        return f"must be {_TYPES[kind]}, got {_show(value)}"
    return str(problem["msg"])


def _show(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "nothing"}[value]
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, Mapping):
        return "a mapping"
    return show_value(value, 60)


def _hint(text: str, choices: Sequence[str]) -> str:
    nearest = _nearest(text, choices)
    return f" Did you mean {nearest!r}?" if nearest is not None else ""


def _nearest(text: str, choices: Sequence[str]) -> str | None:
    return next(iter(difflib.get_close_matches(text, choices, n=1)), None)


def _range(field: FieldInfo | None, context: Mapping[str, Any]) -> str:
    """Describe both limits of the allowed range, with the unit."""
    ends = {key: context[key] for key in ("gt", "ge", "lt", "le") if key in context}
    unit = ""
    if field is not None:
        for constraint in field.metadata:
            ends |= {key: getattr(constraint, key) for key in ("gt", "ge", "lt", "le") if hasattr(constraint, key)}
        extra = field.json_schema_extra
        unit = f" {extra['unit']}" if isinstance(extra, dict) and "unit" in extra else ""
    words = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}
    return " and ".join(f"{word} {ends[key]:.12g}" for key, word in words.items() if key in ends) + unit


def _length(field: FieldInfo | None, context: Mapping[str, Any]) -> str:
    least, most = context.get("min_length"), context.get("max_length")
    for constraint in field.metadata if field is not None else ():
        least = getattr(constraint, "min_length", None) if least is None else least
        most = getattr(constraint, "max_length", None) if most is None else most
    if least is None or most is None:
        return f"at most {most}" if least is None else f"at least {least}"
    return f"{least} to {most}" if least != most else str(least)


# Lookups in the model ------------------------------------------------------------------------------------------


def _keys(model: type[BaseModel], location: Location, in_file: bool) -> list[str]:
    """Return the keys that a mapping at this location may have, in a file or as arguments in Python."""
    owner = _item(_descend(model, location)[0])
    if not _is_model(owner):
        return []
    return [*field_names(owner), *(getattr(owner, "file_keys", ()) if in_file else ())]


def field_names(model: type[BaseModel]) -> list[str]:
    """Return the names of a model's fields: its own first, then those inherited from its bases."""
    names = [name for kind in model.__mro__ for name in inspect.get_annotations(kind)]
    return [name for name in dict.fromkeys(names) if name in model.model_fields]


def _field(model: type[BaseModel], location: Location) -> FieldInfo | None:
    return _descend(model, location)[1]


def _literals(field: FieldInfo | None) -> list[str]:
    """Return the allowed values of a field with a fixed set of them; of any other none."""
    kinds = [] if field is None else [field.annotation, *typing.get_args(field.annotation)]
    literals = [kind for kind in kinds if typing.get_origin(kind) is typing.Literal]
    return [str(choice) for literal in literals for choice in typing.get_args(literal)]


def _descend(model: type[BaseModel], location: Location) -> tuple[Any, FieldInfo | None]:
    """Return the type at a location in a model, and its field; None if the model does not define one."""
    kind: Any = model
    field: FieldInfo | None = None
    for part in location:
        if isinstance(part, str):
            kind = _item(kind)
        arguments = typing.get_args(kind)
        if _is_model(kind):
            field = kind.model_fields.get(str(part))
            kind = None if field is None else field.annotation
        elif typing.get_origin(kind) is dict:
            kind, field = arguments[1], None
        elif arguments and isinstance(part, int):
            kind, field = arguments[part if part < len(arguments) and arguments[-1] is not ... else 0], None
        else:
            return None, None
        kind, inner = _unwrap(kind)
        field = inner or field
    return kind, field


def _item(kind: Any) -> Any:
    """Return the type of a list's items, as one value may be given for the list; any other type as it is."""
    arguments = typing.get_args(kind)
    return _unwrap(arguments[0])[0] if typing.get_origin(kind) in (list, tuple) and arguments else kind


def _unwrap(kind: Any) -> tuple[Any, FieldInfo | None]:
    """Return a type without `| None` and `Annotated`, and the field that an annotation holds."""
    field = None
    while True:
        if typing.get_origin(kind) is Annotated:
            field = FieldInfo.from_annotation(kind)
            kind = field.annotation
        elif typing.get_origin(kind) in (types.UnionType, typing.Union):
            several = [one for one in typing.get_args(kind) if one is not type(None)]
            kind = next((one for one in several if _is_model(_unwrap(one)[0])), several[0] if several else None)
        else:
            return kind, field


def _is_model(kind: Any) -> typing.TypeGuard[type[BaseModel]]:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _place(location: Location, node: yaml.Node, name: str, *, of_key: bool) -> str:
    """Return `file:line:column` of a value or its key; for a missing key, that of its mapping."""
    for index, part in enumerate(location):
        if isinstance(node, yaml.MappingNode):
            entry = next(((key, value) for key, value in node.value if key.value == str(part)), None)
            if entry is None:
                return name if index < len(location) - 1 else place(node, name)
            node = entry[0] if of_key and index == len(location) - 1 else entry[1]
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
    return place(node, name)
