"""`trundle robot`: write a robot file to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output

app = App(
    name="robot",
    version_flags=[],
    help="Write a robot file to edit.",
    help_epilogue=(
        "Examples:\n"
        "  trundle robot new my_robot\n"
        "  trundle robot new husky --urdf husky.urdf -o robots/husky.yaml\n"
        "  trundle robot schema > robot.schema.json"
    ),
)


@app.command
def new(
    name: str,
    /,
    *,
    urdf: Annotated[Path | None, Parameter(negative="")] = None,
    paths: options.Paths = None,
    out: options.Out = None,
    overwrite: options.OverwriteFile = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Write NAME.yaml: a robot that drives, with a comment on every field.

    Example: trundle robot new my_robot

    Args:
        name: Name of the robot, or the file to write, my_robot.yaml.
        urdf: Derive the robot from this URDF or MJCF file; default: a simple one with two wheels and a caster.
        out: The file; default: NAME.yaml in the current folder.
    """
    from trundle.files.writing import write_text
    from trundle.robots import Robot
    from trundle.robots.file_format import check_name, describe_robot, plain_robot

    file = Path(name)
    if file.suffix.lower() in (".yaml", ".yml"):
        name, out = file.stem, out or file
    target = options.new_yaml_file(out or Path(f"{check_name(name)}.yaml"), f"{name}.yaml", overwrite=overwrite)
    robot = plain_robot(name) if urdf is None else Robot.from_model(urdf, name=name, paths=options.join_paths(paths))
    write_text(target, describe_robot(robot, urdf), durable=True)
    advice = f"To drive it: trundle run warehouse --robot {target}"
    output.report_written({"robot": target}, advice, json=json, quiet=quiet)
    return 0


@app.command
def schema() -> int:
    """Print the JSON Schema of robot files, for editors that validate YAML."""
    from trundle.robots.file_format import robot_schema

    output.print_json(robot_schema())
    return 0
