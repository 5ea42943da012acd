"""The JSON Schema of robot files."""

from __future__ import annotations

from typing import Any

from trundle.files.field_docs import json_schema
from trundle.robots.robot import MODEL_SUFFIXES, Robot


def robot_schema() -> dict[str, Any]:
    """What a robot's YAML may hold: the fields of `Robot`, all of which a `model` may stand for."""
    schema = json_schema(Robot, "trundle robot")
    schema["properties"]["model"] = {
        "type": "string",
        "description": f"Path of a {', '.join(MODEL_SUFFIXES)} file from this file's folder: what is not written here "
        "is read from it.",
    }
    schema["properties"]["paths"] = {
        "type": "array",
        "items": {"type": "string"},
        "description": "Folders in which the model's package:// names are looked for.",
    }
    required = schema.pop("required")
    # A model says what is not written, also within the drive and the body.
    for part in schema["$defs"].values():
        part.pop("required", None)
    return {**schema, "anyOf": [{"required": ["model"]}, {"required": required}]}
