"""`BehaviorChoice`: a behavior by name, as in `recovery: [replan, {back_up: {distance: 0.5}}, spin=1.57]`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Annotated, Any, TypeAlias, cast

from pydantic import BeforeValidator, model_validator

from trundle.errors import InputError
from trundle.files.choice import Choice
from trundle.navigation.behaviors.behavior import BEHAVIORS, Behavior, create_behavior

_FORM = "write back_up, back_up=0.5 or {back_up: {distance: 0.5}}"


class BehaviorChoice(Choice):
    """A behavior: `back_up`, `back_up=0.5`, `{back_up: 0.5}` or `{back_up: {distance: 0.5}}`.

    Attributes:
        name: Its name.
        options: Its options, passed by keyword.
    """

    @model_validator(mode="before")
    @classmethod
    def _read(cls, given: object) -> object:
        if isinstance(given, str):
            name, equals, value = (part.strip() for part in given.partition("="))
            return {"name": name, "options": _first_option(name, _number(value)) if equals else {}}
        if isinstance(given, Mapping) and len(cast("Mapping[str, Any]", given)) == 1 and "name" not in given:
            ((name, value),) = cast("Mapping[str, Any]", given).items()
            if value is None or isinstance(value, Mapping):
                return {"name": name, "options": cast("object", value or {})}
            return {"name": name, "options": _first_option(name, value)}
        return cast("object", given)

    def make(self) -> Behavior:
        """Make the behavior.

        Raises:
            UnknownNameError: If there is no such behavior.
            InputError: If it does not take an option or a value.
        """
        return create_behavior(self.name, **dict[str, Any](self.options))


def shorten_behavior(choice: Mapping[str, Any]) -> object:
    """Write a behavior without options as its name alone, and one with options as `{name: {…}}`."""
    return {choice["name"]: choice["options"]} if choice["options"] else choice["name"]


def _first_option(name: str, value: object) -> dict[str, object]:
    """The options of a behavior of which only the first value is given."""
    maker = cast("Callable[..., object]", BEHAVIORS.load(name))
    for parameter in inspect.signature(maker).parameters.values():
        if parameter.kind is parameter.POSITIONAL_OR_KEYWORD:
            return {parameter.name: value}
    raise InputError(f"behavior {name!r} takes no value")


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _split(given: object) -> object:
    """Take one step alone, and split text at commas, also where it is one of a list."""
    if isinstance(given, str | Mapping | Choice):
        given = (cast("object", given),)
    if isinstance(given, list | tuple):
        items = cast("list[object]", given)
        split = [_parts(item) if isinstance(item, str) else (item,) for item in items]
        return tuple(part for parts in split for part in parts)
    raise InputError(f"a list of behaviors is needed, got {given!r}; {_FORM}")


def _parts(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())


BehaviorChoices: TypeAlias = Annotated[
    tuple[BehaviorChoice, ...],
    BeforeValidator(_split, json_schema_input_type=str | list[str | dict[str, Any]]),
]
"""Behaviors in order; text is split at commas."""
