"""Descriptions of settings, taken from class docstrings: for JSON Schemas, tables and commented files."""

from __future__ import annotations

import json
import typing
from collections.abc import Iterator, Mapping, Sequence
from textwrap import wrap
from typing import Any, cast

import yaml
from docstring_parser import parse_from_object
from pydantic import BaseModel

from trundle.files.yaml_problems import field_names

_WIDTH = 96
_BOUNDS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


def describe_fields(model: type[BaseModel]) -> dict[str, str]:
    """Describe each field of a model: its own fields first, then those inherited from its bases."""
    found: dict[str, str] = {}
    for kind in reversed(model.__mro__):
        if kind.__doc__ and "Attributes:" in kind.__doc__:
            for entry in parse_from_object(kind).params:
                for name in entry.arg_name.split(", "):
                    found[name] = " ".join((entry.description or "").split())
    return {name: found.get(name, "") for name in field_names(model)}


def json_schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    """Return the JSON Schema of a model, with a description of each field, for editors that validate YAML."""
    schema = model.model_json_schema()
    kinds = {kind.__name__: kind for kind in models_in(model)}
    for name, part in [(model.__name__, schema), *schema.get("$defs", {}).items()]:
        part["description"] = (kinds[name].__doc__ or "").partition("\n\n")[0].strip()
        for field, text in describe_fields(kinds[name]).items():
            if text:
                part["properties"][field]["description"] = text
    return _with_plain_bounds({"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": title})


def _with_plain_bounds(schema: Any) -> Any:
    """Return the schema with whole bounds as integers.

    Python takes `Annotated[float, Ge(0)]` and `Annotated[float, Ge(0.0)]` for one type, and keeps the one that was made
    first: which of the two a schema shows would depend on what was imported before.
    """
    if isinstance(schema, list):
        return [_with_plain_bounds(part) for part in cast("Sequence[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    return {
        key: int(part) if key in _BOUNDS and isinstance(part, float) and part.is_integer() else _with_plain_bounds(part)
        for key, part in cast("Mapping[str, Any]", schema).items()
    }


def models_in(model: type[BaseModel]) -> list[type[BaseModel]]:
    """Return a model and all models nested in its fields, each once, in field order."""
    found = [model]
    for field in model.model_fields.values():
        for kind in _types_in(field.annotation):
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                found += models_in(kind)
    return list(dict.fromkeys(found))


def _types_in(kind: Any) -> Iterator[Any]:
    yield kind
    for argument in typing.get_args(kind):
        yield from _types_in(argument)


def commented_yaml(settings: BaseModel, plain: Mapping[str, Any]) -> str:
    """Write settings as YAML with a comment above each field; fields at their default are commented out.

    Args:
        settings: The settings to write.
        plain: The same settings as plain values, in the form to write.
    """
    return "\n".join(_lines(settings, plain)) + "\n"


def _lines(settings: BaseModel, plain: Mapping[str, Any]) -> Iterator[str]:
    for name, text in describe_fields(type(settings)).items():
        field = type(settings).model_fields[name]
        yield ""
        yield from (f"# {line}" for line in wrap(text, _WIDTH))
        value, default = getattr(settings, name), field.get_default(call_default_factory=True)
        if name not in plain or (value == default and not field.is_required()):
            yield f"# {name}:{'' if default is None else ' ' + _flow(_plain(default))}"
        elif isinstance(value, BaseModel) and isinstance(plain[name], Mapping) and "options" not in plain[name]:
            yield f"{name}:"
            _, *inner = _lines(value, plain[name])
            yield from (f"  {line}" if line else "" for line in inner)
        else:
            yield f"{name}: {_flow(plain[name])}"


def _flow(value: object) -> str:
    """Write a value on one line."""
    text = yaml.safe_dump(value, default_flow_style=True, allow_unicode=True, width=10**9, sort_keys=False)
    return text.removesuffix("...\n").strip()


def _plain(value: object) -> Any:
    if isinstance(value, BaseModel):
        shown = value.model_dump(mode="json", exclude_defaults=True)
        return shown["name"] if set(shown) == {"name"} else shown
    if isinstance(value, list | tuple):
        return [_plain(item) for item in cast("Sequence[object]", value)]
    return json.loads(json.dumps(value))


def fields_table(model: type[BaseModel]) -> str:
    """Write a Markdown table of a model's fields: name, type, default, meaning."""
    rows = ["| field | type | default | |", "| --- | --- | --- | --- |"]
    properties = model.model_json_schema()["properties"]
    for name, text in describe_fields(model).items():
        field = model.model_fields[name]
        default = "required" if field.is_required() else _default(field.get_default(call_default_factory=True))
        rows.append(f"| `{name}` | {_type(properties[name])} | {default} | {text} |".replace("  ", " "))
    return "\n".join(rows)


def _default(value: object) -> str:
    return "" if value is None else f"`{_flow(_plain(value))}`"


def _type(schema: Mapping[str, Any]) -> str:
    """Describe the type of a JSON Schema in a word or two."""
    if "anyOf" in schema or "oneOf" in schema:
        kinds = [_type(part) for part in schema.get("anyOf", schema.get("oneOf", ())) if part.get("type") != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "const" in schema or "enum" in schema:
        return " or ".join(f"`{choice}`" for choice in schema.get("enum", [schema.get("const")]))
    kind = {"number": "number", "integer": "integer", "string": "text", "boolean": "true or false"}
    if schema.get("type") == "array":
        within = schema.get("items", schema.get("prefixItems", [{}])[0] if "prefixItems" in schema else {})
        return f"list of {_type(within)}"
    if schema.get("type") == "object":
        within = schema.get("additionalProperties", {})
        return f"mapping of {_type(within)}" if isinstance(within, dict) and "$ref" in within else "mapping"
    return kind.get(str(schema.get("type")), "any") + _range(schema)


def _range(schema: Mapping[str, Any]) -> str:
    words = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    ends = [f"{sign} {schema[key]:g}" for key, sign in words.items() if key in schema]
    return f" {', '.join(ends)}" if ends else ""
