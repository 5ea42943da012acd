"""Reading YAML with limits, validated by pydantic, with the types of fields that several settings share.

Every mistake is reported as `file:line:column`. The units of fields appear in the JSON Schema and in range messages.
"""

from __future__ import annotations

import math
import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo
from pydantic_core import PydanticCustomError

from trundle.errors import AngleWarning, InputError
from trundle.files.kinds import describe_mismatch, kind_of_keys
from trundle.files.yaml_nodes import compose, keys_of, place
from trundle.files.yaml_problems import describe_problems
from trundle.geometry import wrap_angle
from trundle.geometry.poses import FORM, describe_degrees, is_in_degrees, parse_angle, warn_of_degrees
from trundle.registry import without_files
from trundle.values import is_finite_number

ANGLES = "angles"
"""Validation context key: what to do with an angle that is probably in degrees."""

_REFUSE, _ACCEPT = "refuse", "accept"
REFUSE_DEGREES, ACCEPT_DEGREES = {ANGLES: _REFUSE}, {ANGLES: _ACCEPT}
"""Contexts: raise a problem of type `DEGREES`, which keeps its location; or accept the angle silently."""

DEGREES = "angle_in_degrees"
"""Problem type: the angle exceeds a full turn."""


def read_angle(value: object, info: ValidationInfo) -> object:
    """Read `90deg`; warn about an angle larger than a full turn, unless the context says otherwise."""
    if isinstance(value, str):
        try:
            value = parse_angle(value)
        except ValueError:
            raise PydanticCustomError("angle", "{text} is not an angle; write " + FORM, {"text": repr(value)}) from None
    if is_finite_number(value) and is_in_degrees(value):
        wish = (info.context or {}).get(ANGLES)
        if wish == _REFUSE:
            raise PydanticCustomError(DEGREES, "{message}", {"message": describe_degrees(value)})
        if wish != _ACCEPT:
            warn_of_degrees(value, "angle")
        return wrap_angle(value)
    return value


def _read_pose(value: object, info: ValidationInfo) -> object:
    """Read the yaw of (x, y, yaw) as an angle."""
    if isinstance(value, list | tuple) and len(value) == 3:
        return (*value[:2], read_angle(value[2], info))
    return value


Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]

Angle = Annotated[
    float, BeforeValidator(read_angle, json_schema_input_type=float | str), Field(json_schema_extra={"unit": "rad"})
]
"""[rad]; text may be degrees, `90deg`."""

PoseNumbers = Annotated[
    tuple[float, ...],
    BeforeValidator(_read_pose, json_schema_input_type=list[float | str]),
    Field(min_length=2, max_length=3),
]
"""(x, y) or (x, y, yaw) [m, m, rad]; the yaw may be text in degrees, `90deg`."""


Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]
ModelT = TypeVar("ModelT", bound=BaseModel)


if TYPE_CHECKING:
    _Model = BaseModel
else:

    class _TypedErrors(type(BaseModel)):
        """Raises `InputError` when a model is constructed in Python, with the same messages as for files."""

        def __call__(cls, *arguments: Any, **given: Any) -> Any:
            try:
                return super().__call__(*arguments, **given)
            except ValidationError as error:
                problems = error.errors(include_url=False)
                raise InputError("\n".join(describe_problems(problems, cls, given))) from error

    class _Model(BaseModel, metaclass=_TypedErrors):
        pass


class Config(_Model):
    """Base of all settings read from YAML: no unknown keys, no NaN or infinity, immutable.

    Raises:
        InputError: If it is constructed in Python with invalid values; one line for each.
    """

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)
    file_keys: ClassVar[tuple[str, ...]] = ()
    """Keys that its files may have besides the fields; its loader takes them out first."""

    def part(self, model: type[ModelT]) -> ModelT:
        """Return the fields that this model has inherited from another, as that model alone."""
        return model.model_construct(**{name: getattr(self, name) for name in model.model_fields})


def load_config(path: str | os.PathLike[str], model: type[ModelT], *, kind: str | None = None) -> ModelT:
    """Read a YAML file into a pydantic model; `kind` is the expected kind of file, from `trundle.files.kinds`.

    Raises:
        InputError: As `compose` and `validate`.
    """
    return validate(compose(path), model, str(Path(path)), kind=kind)


def validate(node: yaml.Node, model: type[ModelT], name: str, *, kind: str | None = None) -> ModelT:
    """Check a YAML node against a pydantic model; `name` stands for the file in messages.

    Raises:
        InputError: If the model rejects values, one line each; or if the file is of another kind or has no keys.

    Warns:
        AngleWarning: For an angle larger than a full turn, which is probably in degrees.
    """
    if not isinstance(node, yaml.MappingNode):  # its text is not shown: it may be any file
        what = f"this is not the YAML of {kind or 'settings'}: it has no `key: value` lines"
        raise InputError(f"{place(node, name)}: {what}")
    try:
        return build(without_files(plain_value(node, name)), model, name=name, node=node)
    except InputError as error:
        found = kind_of_keys(keys_of(node))
        if kind is None or found in (None, kind):
            raise
        raise InputError(describe_mismatch(name, found, kind)) from error


def build(given: object, model: type[ModelT], *, name: str = "", node: yaml.Node | None = None) -> ModelT:
    """Construct a model from plain values.

    Args:
        given: The values.
        model: The model to construct.
        name: Name of the source file, for messages.
        node: That file's content, for lines and columns; values that are not in it get none.

    Raises:
        InputError: As `validate`.

    Warns:
        AngleWarning: As `validate`.
    """
    try:
        return model.model_validate(given, context=REFUSE_DEGREES)
    except ValidationError as error:
        problems = error.errors(include_url=False)
        wrong = [problem for problem in problems if problem["type"] != DEGREES]
        lines = describe_problems(wrong or problems, model, given, name=name, node=node)
        if wrong:
            raise InputError("\n".join(lines)) from error
    for line in lines:
        warnings.warn(line, AngleWarning, stacklevel=2)
    try:
        return model.model_validate(given, context=ACCEPT_DEGREES)
    except ValidationError as error:  # of a value whose angle was refused before the rest of it was looked at
        problems = error.errors(include_url=False)
        raise InputError("\n".join(describe_problems(problems, model, given, name=name, node=node))) from error


def plain_value(node: yaml.Node, name: str) -> Plain:
    """Convert a node to plain Python values; `1e-3` is read as a number, unlike in PyYAML."""
    if isinstance(node, yaml.MappingNode):
        return {str(key.value): plain_value(value, name) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [plain_value(item, name) for item in node.value]
    if not isinstance(node, yaml.ScalarNode):
        raise InputError(f"{place(node, name)}: this value cannot be read")
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
