"""`Choice`: a name with options, as written in a scenario's YAML."""

from __future__ import annotations

from typing import Any, Self, TypeAlias

from pydantic import BeforeValidator, Field

from trundle.files.yaml_config import Config

Option: TypeAlias = bool | int | float | str | list[bool | int | float | str] | None


class Choice(Config):
    """A name with options: `least_cost`, or `{name: least_cost, options: {…}}`.

    Attributes:
        name: Name of a planner, a controller, a smoother or a simulator.
        options: Its options, passed by keyword.
    """

    name: str
    options: dict[str, Option] = Field(default_factory=dict)

    @classmethod
    def of(cls, name: str, **options: Option) -> Self:
        """Choose by name: `Choice.of("least_cost", goal_tolerance=0.5)`."""
        return cls(name=name, options=options)


def _name_alone(value: object) -> object:
    return {"name": value} if isinstance(value, str) else value


def takes_name(kind: type[Config]) -> BeforeValidator:
    """Return a validator that accepts a plain name as a choice without options."""
    return BeforeValidator(_name_alone, json_schema_input_type=str | kind | None)


def shorten(choice: dict[str, Any]) -> object:
    """Write a choice without options as its name alone."""
    kept = {key: value for key, value in choice.items() if value not in (None, {})}
    return kept["name"] if set(kept) == {"name"} else kept
