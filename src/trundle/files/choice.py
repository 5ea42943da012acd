"""`Choice`: a name with options, as written in a scenario's YAML; or, in Python, what has no name there."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import PurePath
from types import NoneType
from typing import Any, Self, TypeAlias, cast

from pydantic import BeforeValidator, Field, PrivateAttr

from trundle.errors import InputError
from trundle.files.yaml_config import Config
from trundle.registry import PYTHON, is_model_file, is_plugin_file, name_of

Option: TypeAlias = bool | int | float | str | list[bool | int | float | str] | None

_PLAIN = (str, int, float, list, tuple, NoneType)
"""Types that are no plug-in: the field says what is wrong with them."""


class Choice(Config):
    """A name with options: `least_cost`, or `{name: least_cost, options: {…}}`.

    Attributes:
        name: A name, or `module:name` of a class, a function or an object that no installed package has registered.
        options: Its options, passed by keyword.
    """

    name: str
    options: dict[str, Option] = Field(default_factory=dict)
    _object: Any = PrivateAttr(default=None)

    @classmethod
    def of(cls, name: str, **options: Option) -> Self:
        """Choose by name: `Choice.of("least_cost", goal_tolerance=0.5)`."""
        return cls(name=name, options=options)

    @classmethod
    def of_object(cls, given: object, **fields: Any) -> Self:
        """Choose a Python object, a class, a function or an object; with other fields, such as options."""
        choice = cls(**{**fields, "name": PYTHON + name_of(given)})
        choice._object = given
        return choice

    @property
    def is_python(self) -> bool:
        """Whether it is, or was before it was saved, a Python object."""
        return self.name.startswith(PYTHON)

    @property
    def short_name(self) -> str:
        """Name for reports; of a plug-in in a file, its name in that file; of a policy, the file without its folder."""
        name = self.name.removeprefix(PYTHON)
        if is_model_file(name):
            return PurePath(name).name
        return name.rpartition(":")[2] if is_plugin_file(name) else name

    @property
    def given(self) -> object:
        """The Python object, or None if the choice is a name."""
        return self._object

    def make_from(self) -> object:
        """Return what the plug-in is made from: the name, or a copy of the Python object.

        The copy gives each run the object as it was given.

        Raises:
            InputError: If it cannot be copied.
        """
        if self._object is None:
            return self.name
        try:
            return copy.deepcopy(self._object)
        except Exception as error:
            raise InputError(
                f"{self.short_name!r} cannot be copied for a run ({type(error).__name__}: {error}): give its class, or "
                "a function that makes one"
            ) from error


def split_choice(given: object) -> tuple[str, Any, dict[str, Any]]:
    """Return a choice's name for reports, what its plug-in is made from, and its options."""
    if isinstance(given, Choice):
        return given.short_name, given.make_from(), dict(given.options)
    return Choice(name=given).short_name if isinstance(given, str) else name_of(given), given, {}


def takes_name(kind: type[Config]) -> BeforeValidator:
    """Return a validator that accepts a plain name as a choice without options."""

    def name_alone(value: object) -> object:
        return {"name": value} if isinstance(value, str) else value

    return BeforeValidator(name_alone, json_schema_input_type=str | kind | None)


def takes_plugin(kind: type[Choice], *, objects: bool = True, optional: bool = True) -> BeforeValidator:
    """Return a validator that accepts a plain name, any choice, and in Python a class, a function or an object.

    Args:
        kind: What it makes of them.
        objects: Whether Python objects are accepted.
        optional: Whether the field may be None.
    """

    def read(value: object) -> object:
        if isinstance(value, str):
            return {"name": value}
        if isinstance(value, Choice) and not isinstance(value, kind):
            value = {"name": value.name if value.given is None else value.given, "options": value.options}
        if isinstance(value, Mapping):
            fields = cast("Mapping[str, Any]", value)
            named = fields.get("name")
            is_object = objects and not isinstance(named, _PLAIN)
            return kind.of_object(named, **fields) if is_object else fields
        return value if not objects or isinstance(value, (*_PLAIN, kind)) else kind.of_object(value)

    return BeforeValidator(read, json_schema_input_type=str | kind | None if optional else str | kind)


def shorten(choice: dict[str, Any]) -> object:
    """Write a choice without options as its name alone."""
    kept = {key: value for key, value in choice.items() if value not in (None, {})}
    return kept["name"] if set(kept) == {"name"} else kept
