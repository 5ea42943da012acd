"""Options shared by several verbs, and parsing of their values."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import CoercionError, Parameter, Token

from trundle.errors import InputError, OutputError
from trundle.geometry.poses import FORM as ANGLE_FORM
from trundle.geometry.poses import parse_angle, warn_of_degrees
from trundle.messages.codec import Distro as Distribution

if TYPE_CHECKING:
    from trundle.geometry import Goal as Target
    from trundle.geometry import Pose2D


def _read_angle(_kind: object, tokens: Sequence[Token]) -> float:
    text = tokens[0].value
    try:
        angle = parse_angle(text)
    except ValueError:
        raise InputError(f"{tokens[0].keyword} {text!r} is not an angle; write {ANGLE_FORM}") from None
    warn_of_degrees(angle, str(tokens[0].keyword))
    return angle


Angle = Annotated[float, Parameter(converter=_read_angle, allow_leading_hyphen=True, metavar="ANGLE")]
"""An option's angle [rad], or in degrees: `10deg`."""


def _read_integer(_kind: object, tokens: Sequence[Token]) -> int:
    # By default cyclopts rounds 1.5 to 2.
    try:
        return int(tokens[0].value)
    except ValueError:
        raise CoercionError(token=tokens[0], target_type=int) from None


Integer = Annotated[int, Parameter(converter=_read_integer)]
"""An option's integer; numbers with a fraction are refused."""


def _speed(help: str) -> Parameter:
    return Parameter(name="--speed", allow_leading_hyphen=True, metavar="FACTOR|max", help=help)


FirstSpeed = Annotated[
    str, _speed("Simulated seconds per second of the first run, 0.1 to 50, or max; the page can change it.")
]
"""Speed of the first run of `trundle serve`."""

RunSpeed = Annotated[
    str | None,
    _speed(
        "Simulated seconds per second, 0.1 to 50, or max; default: 1 where it is shown in a window or in the browser, "
        "else max."
    ),
]
"""Speed of a run of any other verb."""

Browser = Annotated[
    bool,
    Parameter(
        name="--browser",
        negative="",
        help="Show it live in the browser, where it can be steered; ends when the page is closed.",
    ),
]

ROBOT_CHOICES = "nova_carter, jackal, turtlebot3_burger, turtlebot3_waffle, a plug-in's, or the path of its YAML"
ROBOT_HELP = f"A robot: {ROBOT_CHOICES}."

Flag = Annotated[bool, Parameter(negative="")]
"""A flag that is off unless it is given."""

Out = Annotated[Path | None, Parameter(name=["--out", "-o"])]
Height = Annotated[float | None, Parameter(allow_leading_hyphen=True)]
"""A height [m], which may be below 0."""

Json = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON value and nothing else.")]
Quiet = Annotated[bool, Parameter(name="--quiet", negative="", help="No progress bar and no remarks.")]
Overwrite = Annotated[
    bool,
    Parameter(
        name="--overwrite",
        negative="",
        help="Replace an existing run in the folder of --out; it is deleted once the new one is complete.",
    ),
]
OverwriteMap = Annotated[
    bool,
    Parameter(name="--overwrite", negative="", help="Replace a map even if it was edited since trundle wrote it."),
]
OverwriteFile = Annotated[bool, Parameter(name="--overwrite", negative="", help="Replace the file if it exists.")]
Record = Annotated[
    bool,
    Parameter(
        name="--record", negative="", help="Also write run.mcap, a rosbag2 for Foxglove, RViz, PlotJuggler and ROS 2."
    ),
]
Distro = Annotated[
    Distribution | None,
    Parameter(name="--distro", help="The distribution of ROS 2 whose message types the bag has; default: jazzy."),
]
Seed = Annotated[Integer, Parameter(name="--seed", help="Random seed: the same seed gives the same result.")]
RobotArgument = Annotated[str, Parameter(help=ROBOT_HELP)]
WorldName = Annotated[
    str | None,
    Parameter(
        name="--world",
        help="The world: a name (corridors, cylinders, lot, maze, office, warehouse or a plug-in's), or its file "
        "(SDF, MJCF, USD, a mesh, a map's YAML); default: a level floor.",
    ),
]
RobotName = Annotated[str, Parameter(name="--robot", help=ROBOT_HELP)]
BACKEND_HELP = "The simulator: mujoco, kinematic, physx, isaac or a plug-in's name."
Backend = Annotated[str, Parameter(name="--backend", help=BACKEND_HELP)]
Compat = Annotated[
    Literal["humble"] | None,
    Parameter(name="--compat", help="Read the map as Nav2 of ROS 2 Humble does, instead of the current Nav2."),
]
MaxCells = Annotated[
    int | None,
    Parameter(
        name="--max-cells",
        converter=_read_integer,
        help="Largest number of cells of a map; default: 20 million, for which map check takes up to 1.5 GB.",
    ),
]
Pose = Annotated[
    str | None,
    Parameter(
        name="--start",
        allow_leading_hyphen=True,
        metavar="X,Y[,YAW]",
        help="Robot's pose [m, m, rad or 90deg], map frame; default: a free place in the world, or the origin.",
    ),
]
Settings = Annotated[
    list[str] | None,
    Parameter(
        name="--set",
        allow_leading_hyphen=True,
        negative="",
        metavar="KEY=VALUE",
        help="An option of the world's generator or file; repeatable.",
    ),
]
FloorZ = Annotated[
    float | None,
    Parameter(
        name="--floor-z",
        allow_leading_hyphen=True,
        negative="",
        metavar="METRES",
        help="Height of the floor in the world's file [m]; default: the lowest level surface under the robot "
        "with room for it above, or 0.",
    ),
]
Exclude = Annotated[
    list[str] | None,
    Parameter(
        name="--exclude",
        negative="",
        metavar="WHAT",
        help="Leave this out of the world: a solid or a group by name (/World/Robot, shelf, * as wildcard), a kind or "
        "semantic label, floor or ceiling; repeatable.",
    ),
]

Paths = Annotated[
    list[str] | None,
    Parameter(
        name="--paths",
        negative="",
        metavar="FOLDER",
        help="Folder to search for models and packages of a world's or robot's file, after its own folder; "
        "repeatable, or separate several with a colon.",
    ),
]


def parse_numbers(option: str, text: str, form: str, *, at_least: int, at_most: int) -> list[float]:
    """Read finite numbers with commas between them; `form` describes the format in messages."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if not (at_least <= len(numbers) <= at_most and all(math.isfinite(number) for number in numbers)):
        raise InputError(f"{option} {text!r}: give {form} as finite numbers with commas, without spaces")
    return numbers


def parse_list(text: str) -> list[str]:
    """Read texts with commas between them."""
    return [part.strip() for part in text.split(",") if part.strip()]


def parse_seeds(text: str) -> int | str | list[int]:
    """Read seeds: a number of them, several with commas between them, or a range such as `0:50`, which is returned."""
    parts = parse_list(text)
    if not all(part.isdecimal() for part in parts):
        return text
    return [int(part) for part in parts] if len(parts) > 1 else int(text)


def parse_speed(text: str) -> float:
    """Read `--speed`: simulated seconds per second; infinity for max."""
    try:
        speed = math.inf if text == "max" else float(text)
    except ValueError:
        speed = math.nan
    if not (0.1 <= speed <= 50.0 or text == "max"):
        raise InputError(f"--speed {text!r}: give simulated seconds per second, from 0.1 to 50, or max")
    return speed


def parse_pose(option: str, text: str) -> Pose2D:
    """Read `X,Y` or `X,Y,YAW` [m, m, rad]; the yaw may be in degrees, `90deg`."""
    return parse_goal(option, text).pose


def parse_goal(option: str, text: str) -> Target:
    """Read `X,Y` (a goal with any yaw) or `X,Y,YAW`."""
    from trundle.geometry import Goal as Target
    from trundle.geometry import wrap_angle

    *position, yaw = text.split(",")
    form = "X,Y or X,Y,YAW"
    if len(position) != 2:
        x, y = parse_numbers(option, text, form, at_least=2, at_most=2)
        return Target(x, y)
    try:
        angle = parse_angle(yaw)
    except ValueError:
        raise InputError(f"{option} {text!r}: YAW {yaw!r} is not an angle; write {ANGLE_FORM}") from None
    x, y = parse_numbers(option, ",".join(position), form, at_least=2, at_most=2)
    warn_of_degrees(angle, f"{option} {text}: YAW")
    return Target(x, y, wrap_angle(angle))


def parse_pairs(option: str, texts: list[str] | None, example: str) -> dict[str, bool | int | float | str]:
    """Read `KEY=VALUE` options: true and false, integers, numbers, else text."""
    settings: dict[str, bool | int | float | str] = {}
    for text in texts or []:
        key, equals, value = text.partition("=")
        key = key.strip().replace("-", "_")
        if not equals or not key.isidentifier():
            raise InputError(f"{option} {text!r}: give KEY=VALUE, for example {option} {example}")
        if key in settings:
            raise InputError(f"{option} {key} is given twice")
        settings[key] = _plain(value.strip())
    return settings


def parse_settings(texts: list[str] | None, exclude: list[str] | None = None) -> dict[str, bool | int | float | str]:
    """Read the pairs of `--set`. `--exclude` becomes one of them."""
    settings = parse_pairs("--set", texts, "aisle_width=1.6")
    if exclude:
        if "exclude" in settings:
            raise InputError("give --exclude or --set exclude=, not both")
        settings["exclude"] = ",".join(exclude)
    return settings


def join_paths(folders: list[str] | None) -> str:
    """Join the folders of `--paths` into one text."""
    return os.pathsep.join(folders or ())


def output_file(out: Path, default_name: str, suffixes: tuple[str, ...]) -> Path:
    """Return the file that a verb writes: `out` if it has one of the suffixes, else `default_name` in that folder.

    The folder is created and checked before any work is done.

    Raises:
        OutputError: If the folder cannot be written to.
        InputError: If `out` has another file suffix, or is the image of a map.
    """
    suffix = out.suffix.lower()
    if suffix in suffixes and not out.is_dir():
        _make_folder(out.parent)
        _refuse_map_image(out)
        return out
    if out.is_file() or (suffix and not suffix[1:].isdigit() and not out.is_dir()):
        raise InputError(f"--out {out}: give a file that ends in {' or '.join(suffixes)}, or a folder")
    return _make_folder(out) / default_name


def _refuse_map_image(out: Path) -> None:
    """Refuse to replace the image of a map in the folder.

    Raises:
        InputError: If the YAML of a map names it.
    """
    if out.suffix.lower() == ".png" and out.is_file():
        from trundle.maps.ros_writer import find_map_of

        found = find_map_of(out)
        if found is not None:
            raise InputError(f"--out {out}: it is the image of the map {found}; give another name")


def new_yaml_file(out: Path, default_name: str, *, overwrite: bool) -> Path:
    """Return the `output_file` of a verb that writes YAML, and replaces a file only with --overwrite.

    Raises:
        OutputError: As `output_file`.
        InputError: As `output_file`, and if the file exists and `overwrite` is false.
    """
    target = output_file(out, default_name, (".yaml", ".yml"))
    if target.exists() and not overwrite:
        raise InputError(f"{target} already exists: give another file with -o, or replace it with --overwrite")
    return target


def check_map_replaceable(target: Path, option: str = "-o") -> None:
    """Refuse to replace a ROS map that is not as trundle wrote it; see `check_replaceable`."""
    from trundle.maps.ros_writer import is_as_written

    check_replaceable(target, is_as_written=is_as_written(target), option=option)


def check_replaceable(target: Path, *, is_as_written: bool, option: str = "-o") -> None:
    """Refuse to replace a map that is there, unless it is byte for byte what trundle wrote.

    Args:
        target: The map's file.
        is_as_written: Whether it is what trundle wrote.
        option: The option that gives the file, for the message.

    Raises:
        InputError: If there is one and it is not; it may have been edited by hand.
    """
    if target.exists() and not is_as_written:
        raise InputError(
            f"{target} already exists, and is not as trundle wrote it: it may have been edited by hand. Give another "
            f"file with {option}, or replace it with --overwrite"
        )


def _make_folder(folder: Path) -> Path:
    from trundle.files.writing import make_folder

    try:
        return make_folder(folder)
    except OutputError as error:
        raise OutputError(f"{error}; give another place with -o") from error


def _plain(text: str) -> bool | int | float | str:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
