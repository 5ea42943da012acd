"""Field types that several settings share. Their units appear in the JSON Schema and in range messages."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, ValidationInfo
from pydantic_core import PydanticCustomError

from trundle.geometry import wrap_angle
from trundle.geometry.angles import FORM, describe_degrees, is_in_degrees, parse_angle, warn_of_degrees
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
