"""What robot files look like: templates, from scratch or from a URDF or MJCF model, and the JSON Schema."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trundle.errors import InputError
from trundle.files.field_docs import commented_yaml, json_schema
from trundle.robots.parts import Body, Caster, DifferentialDrive, Lidar, Limits
from trundle.robots.robot import MODEL_SUFFIXES, Robot

_HEAD = """\
# A robot: `trundle run warehouse --robot FILE` drives it, `trundle view FILE` shows it.
# base_link is on the floor, midway between the drive wheels, x forward. A line that begins with # shows a default.
"""


def plain_robot(name: str) -> Robot:
    """Return a robot of 0.5 by 0.4 m with two wheels, a ball caster at the back and a lidar at the front."""
    return Robot(
        name=name,
        drive=DifferentialDrive(
            wheel_radius=0.1, track_width=0.36, left_joint="left_wheel_joint", right_joint="right_wheel_joint"
        ),
        limits=Limits(linear_speed=1.0, angular_speed=2.0, linear_acceleration=1.0, angular_acceleration=3.0),
        footprint=((0.15, 0.22), (-0.35, 0.22), (-0.35, -0.22), (0.15, -0.22)),
        body=Body(mass=15.0, height=0.3, clearance=0.05),
        casters=(Caster(x=-0.28, y=0.0, radius=0.05),),
        lidars={"front": Lidar(x=0.1, y=0.0, z=0.25)},
    )


def describe_robot(robot: Robot, model: Path | None = None) -> str:
    """Return YAML that `Robot.load` reads back as this robot, with a comment on every field.

    Args:
        robot: The robot to describe.
        model: The URDF or MJCF file that it was derived from, for a comment.
    """
    remark = "" if model is None else f"# Derived from {model.name}; the values below override the model.\n"
    plain = robot.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
    return _HEAD + remark + commented_yaml(robot, plain)


def check_name(name: str) -> str:
    """Return a robot's name if it can be a file name.

    Raises:
        InputError: If it cannot.
    """
    if not name or name != Path(name).name or name.startswith((".", "-")):
        raise InputError(f"{name!r} cannot name a robot: use a plain name such as my_robot")
    return name


def robot_schema() -> dict[str, Any]:
    """Return the schema of a robot's YAML: the fields of `Robot`, all optional if `model` or `base` is given."""
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
