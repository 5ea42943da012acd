"""Types of a robot's numbers, each with a plausible range: a value outside is a wrong unit or a misplaced point."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BeforeValidator, Field

from trundle.files.config_fields import read_angle

WheelRadius = Annotated[float, Field(ge=0.001, le=5.0, json_schema_extra={"unit": "m"})]
WheelWidth = Annotated[float, Field(gt=0.0, le=5.0, json_schema_extra={"unit": "m"})]
TrackWidth = Annotated[float, Field(ge=0.005, le=20.0, json_schema_extra={"unit": "m"})]
Trail = Annotated[float, Field(ge=0.0, le=5.0, json_schema_extra={"unit": "m"})]
Coordinate = Annotated[float, Field(ge=-50.0, le=50.0, json_schema_extra={"unit": "m"})]
"""Coordinate in base_link [m]."""
Height = Annotated[float, Field(gt=0.0, le=50.0, json_schema_extra={"unit": "m"})]
Clearance = Annotated[float, Field(ge=0.0, le=50.0, json_schema_extra={"unit": "m"})]
WheelMass = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "kg"})]
BodyMass = Annotated[float, Field(gt=0.0, le=1e6, json_schema_extra={"unit": "kg"})]
Inertia = Annotated[float, Field(gt=0.0, le=1e9, json_schema_extra={"unit": "kg·m²"})]
Speed = Annotated[float, Field(gt=0.0, le=100.0, json_schema_extra={"unit": "m/s"})]
ReverseSpeed = Annotated[float, Field(ge=0.0, le=100.0, json_schema_extra={"unit": "m/s"})]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e3, json_schema_extra={"unit": "rad/s"})]
WheelSpeed = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "rad/s"})]
Acceleration = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "m/s²"})]
TurningAcceleration = Annotated[float, Field(gt=0.0, le=1e5, json_schema_extra={"unit": "rad/s²"})]
LeastRange = Annotated[float, Field(ge=0.0, le=1e4, json_schema_extra={"unit": "m"})]
LargestRange = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "m"})]
RangeNoise = Annotated[float, Field(ge=0.0, le=100.0, json_schema_extra={"unit": "m"})]
ScanRate = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "Hz"})]
Brightness = Annotated[float, Field(ge=0.0, le=1.0)]
FieldOfView = Annotated[
    float,
    BeforeValidator(read_angle, json_schema_input_type=float | str),
    Field(gt=0.0, le=math.tau + 1e-9, json_schema_extra={"unit": "rad"}),
]
