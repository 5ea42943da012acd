"""The JSON Schema of robot files."""

from __future__ import annotations

from typing import Any

from trundle.files.field_docs import json_schema
from trundle.robots.robot import MODEL_SUFFIXES, Robot


def robot_schema() -> dict[str, Any]:
    """The schema of a robot's YAML: the fields of `Robot`, all optional if `model` or `base` is given."""
    schema = json_schema(Robot, "trundle robot")
    schema["properties"]["model"] = {
        "type": "string",
        "description": f"Path of a {', '.join(MODEL_SUFFIXES)} file, relative to this file: settings missing here "
        "are derived from it.",
    }
    schema["properties"]["base"] = {
        "type": "string",
        "description": "A robot, by its name or the path of its file, relative to this file: settings missing here are "
        "its own.",
    }
    schema["properties"]["paths"] = {
        "type": "array",
        "items": {"type": "string"},
        "description": "Folders to search for the model's package:// names.",
    }
    required = schema.pop("required")
    # A model or a base supplies missing fields, also within the drive and the body.
    for part in schema["$defs"].values():
        part.pop("required", None)
    return {**schema, "anyOf": [{"required": ["model"]}, {"required": ["base"]}, {"required": required}]}
