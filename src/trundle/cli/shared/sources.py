"""What an argument is, a world, a map, a robot, a scenario or a run, by its name or its file; and loading it."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trundle.cli.shared.options import join_paths, parse_pose, parse_settings
from trundle.errors import InputError, MapError, MapWarning, UnknownNameError
from trundle.files.kinds import (
    DRIVE,
    EVALUATION,
    MAP,
    PICTURE,
    ROBOT,
    RUN,
    SCENARIO,
    SUITE,
    WORLD,
    describe_mismatch,
    find_kind,
)
from trundle.files.opening import advise_missing, exists, is_file

if TYPE_CHECKING:
    from trundle.costmap import Costmap
    from trundle.geometry import Goal, Pose2D
    from trundle.robots import Robot
    from trundle.worlds import World


_FILE_KINDS = frozenset({MAP, ROBOT, SCENARIO, SUITE, WORLD})
"""Kinds that are files, and no folders."""

_ADVICE = {
    (WORLD, MAP): "make its map with trundle map build {text} -o map.yaml",
    (SCENARIO, MAP): "give its map, or drive it with trundle run {text}",
    (SCENARIO, WORLD): "give its world or map, or drive it with trundle run {text}",
    (PICTURE, MAP): "give the map's YAML file, which has the image's name and the resolution",
    (PICTURE, WORLD): "of a map give the YAML file, which has the image's name and the resolution",
    (ROBOT, WORLD): "give it with --robot {text}",
    (ROBOT, MAP): "give it with --robot {text}",
    (WORLD, ROBOT): "give a robot first, and this with --world {text}",
    (MAP, ROBOT): "give a robot first, and this with --world {text}",
    (SCENARIO, ROBOT): "give its robot",
    (RUN, SCENARIO): "to repeat it give {text}/scenario.yaml",
    (RUN, MAP): "give the YAML file of a map",
    (DRIVE, RUN): "a drive has no replay; trundle compare reads it",
    (SUITE, RUN): "run it with trundle evaluate {text}",
    (SCENARIO, RUN): "run it with trundle run {text}, and give the folder that it writes",
    (RUN, EVALUATION): "compare runs with trundle compare; the figures and pictures of one are in its folder",
    ("a folder", EVALUATION): "give the folder that trundle evaluate wrote",
    (DRIVE, EVALUATION): "compare drives with trundle compare",
    (EVALUATION, RUN): "compare evaluations with trundle evaluate compare, or run one of its episodes again with "
    "trundle run --from {text}:ID",
    (EVALUATION, SCENARIO): "to run one of its episodes again, trundle run --from {text}:ID; to resume it, "
    "trundle evaluate {text}/suite.yaml -o {text}",
    (EVALUATION, SUITE): "to continue it, trundle evaluate {text}/suite.yaml -o {text}; its report, trundle evaluate "
    "report {text}",
    (SUITE, SCENARIO): "run its episodes with trundle evaluate {text}",
    (SUITE, EVALUATION): "run it with trundle evaluate {text}, and give the folder that it writes",
    (EVALUATION, MAP): "give the YAML file of a map",
    (DRIVE, SCENARIO): "to repeat its commands, trundle drive ROBOT --like {text}",
    (
        "a simulator",
        RUN,
    ): "drive with trundle drive ROBOT --like RUN --backend {text}, and compare the folders",
    ("a folder", MAP): "give the YAML file of a map in it",
}


def check_given(text: str | os.PathLike[str], *wanted: str) -> None:
    """Refuse a file or a name that is clearly of another kind than those wanted; the first of them is the main one.

    An unknown name and a missing folder are left to the loader to report.

    Raises:
        InputError: If it is of another kind, or a file that does not exist; the message says what to give instead.
    """
    text = os.fspath(text)
    # A file or folder may have a known name: `drive -o mujoco` creates one.
    found = find_kind(text)
    kinds = [*_kinds_of_name(text), *([] if found is None else [found])]
    if not kinds:
        check_file_exists(text, *wanted)
        _check_suffix(text, wanted)
    if not kinds or set(kinds) & set(wanted):
        return
    advice = next((_ADVICE[kinds[0], kind] for kind in wanted if (kinds[0], kind) in _ADVICE), None)
    message = describe_mismatch(text, kinds[0], _list_kinds(wanted))
    raise InputError(message if advice is None else f"{message}; {advice.format(text=text)}")


def check_file_exists(text: str, *wanted: str) -> None:
    """Refuse a text that looks like the path of a file, by a suffix or a slash, if there is none.

    Raises:
        InputError: If there is no such file; the message names the nearest one in its folder.
    """
    path = Path(text)
    suffix = path.suffix[1:]
    looks_like_path = os.sep in text or (suffix != "" and not suffix[0].isdigit() and " " not in suffix)
    if ":" in text or not looks_like_path or not _FILE_KINDS & {*wanted} or exists(path):
        return
    error = MapError if wanted[0] == MAP else InputError
    raise error(f"{text}: no such file{advise_missing(path, f'the file of {_list_kinds(wanted)}')}")


def _check_suffix(text: str, wanted: tuple[str, ...]) -> None:
    """Refuse a file of which the suffix says that nothing reads it as a world."""
    from trundle.worlds.load import LOADERS

    if WORLD in wanted and is_file(text) and Path(text).suffix.lower() not in LOADERS:
        suffixes = ", ".join(sorted(LOADERS))
        raise InputError(f"{text}: this is not the file of {_list_kinds(wanted)}: their names end in {suffixes}")


def _list_kinds(wanted: Sequence[str]) -> str:
    *others, last = wanted
    return f"{', '.join(others)} or {last}" if others else last


def warn_of_units(map_file: str | os.PathLike[str]) -> None:
    """Warn if the cell size of a ROS map is unlikely, as `trundle map check` does: its unit is probably not metres.

    A file that cannot be read is left to the loader to report.

    Warns:
        MapWarning: If it is.
    """
    from trundle.maps.ros_yaml import describe_resolution, read_fields

    if Path(map_file).suffix.lower() == ".map":
        return
    with suppress(MapError):
        unlikely = describe_resolution(read_fields(map_file))
        if unlikely is not None:
            warnings.warn("; ".join(unlikely), MapWarning, stacklevel=2)


def _kinds_of_name(text: str) -> list[str]:
    """Return the kinds of known things with this name."""
    from trundle.control import controller_names
    from trundle.planning import planner_names
    from trundle.robots import robot_names
    from trundle.sim import simulator_names
    from trundle.worlds import world_names

    names = {
        WORLD: world_names,
        ROBOT: robot_names,
        "a planner": planner_names,
        "a controller": controller_names,
        "a simulator": simulator_names,
    }
    return [kind for kind, known in names.items() if text in known()]


def is_map(path: Path) -> bool:
    """Return whether a file is a map: a ROS map's YAML has an `image:` key, a MovingAI map ends in .map.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    import yaml

    from trundle.files.yaml_nodes import compose

    if path.suffix.lower() == ".map":
        return True
    node = compose(path)
    return isinstance(node, yaml.MappingNode) and any(key.value == "image" for key, _ in node.value)


def is_scenario(path: Path) -> bool:
    """Return whether a YAML file is a scenario: it has a `world:` or a `map:` key.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    import yaml

    from trundle.files.yaml_nodes import compose

    node = compose(path)
    return isinstance(node, yaml.MappingNode) and any(key.value in ("world", "map") for key, _ in node.value)


def is_written(source: str) -> bool:
    """Return whether an argument is the file of a scenario, which says itself what it does not leave to defaults.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    return is_yaml(source) and is_scenario(Path(source)) and not is_map(Path(source))


def is_usd(text: str) -> bool:
    """Return whether an argument is a USD file."""
    return text.lower().endswith((".usd", ".usda", ".usdc", ".usdz"))


def looks_like_file(text: str) -> bool:
    """Return whether an argument is a file rather than a name."""
    from trundle.worlds.load import is_world_file

    return is_world_file(text) or os.sep in text


def is_yaml(text: str) -> bool:
    """Return whether an argument is a YAML file, which may be a map or a scenario."""
    return text.lower().endswith((".yaml", ".yml"))


def load_robot(text: str, paths: list[str] | None = None) -> Robot:
    """Load a robot by name or from its file; `paths` are the folders of --paths.

    Raises:
        UnknownNameError: If it is neither; the nearest name is offered.
        InputError: If the file cannot be used.
    """
    from trundle.robots import Robot

    check_given(text, ROBOT)
    return Robot.load(text, paths=join_paths(paths))


def load_world(text: str, *, seed: int, settings: Mapping[str, bool | int | float | str]) -> World:
    """Generate a world by name, or load it from a file: a map, SDF, MJCF, URDF, a mesh.

    Raises:
        UnknownNameError: If it is neither a world nor a file; the nearest name is offered.
        InputError: If the file cannot be used, or the world does not have these options.
    """
    from trundle.worlds import World, world_names

    check_given(text, WORLD, MAP)
    if text in world_names():
        return World.generate(text, **{"seed": seed, **dict[str, Any](settings)})
    if not looks_like_file(text):
        raise UnknownNameError("world", text, world_names())
    return World.load(text, **dict[str, Any](settings))


def load_place(text: str | None, *, seed: int, settings: Mapping[str, bool | int | float | str]) -> World:
    """Load a world as `load_world` does, or an empty floor if the text is None."""
    from trundle.worlds import World

    if text is not None:
        return load_world(text, seed=seed, settings=settings)
    if settings:
        raise InputError("--set and --exclude are for worlds: give --world as well")
    return World(name="empty", solids=())


def read_settings(
    world: str | None,
    settings: list[str] | None,
    exclude: list[str] | None,
    paths: list[str] | None,
    *,
    robot: str | None = None,
) -> dict[str, bool | int | float | str]:
    """Read --set, --exclude and --paths for a world; the robot's file may also use --paths.

    Raises:
        InputError: If neither uses the folders of --paths.
    """
    from trundle.robots import is_robot_file
    from trundle.worlds.load import takes_paths

    given = parse_settings(settings, exclude)
    if not paths:
        return given
    if world is not None and takes_paths(world):
        if "paths" in given:
            raise InputError("give --paths or --set paths=, not both")
        given["paths"] = join_paths(paths)
    elif robot is None or not is_robot_file(robot):
        raise InputError("--paths is for files that refer to others: a world's SDF, MJCF or URDF, or a robot's file")
    return given


def find_floor_z(
    world: World, source: str | None, robot: Robot, start: tuple[float, float] | Pose2D | None, floor_z: float | None
) -> float:
    """Return the height [m] of the floor: --floor-z, else under the start, or under most of a world from a file.

    Raises:
        InputError: If --floor-z is given without a world.
        WorldError: If the floor is ambiguous, or --floor-z is implausible.
    """
    from trundle.geometry import Pose2D
    from trundle.worlds.floors import check_floor, find_common_floor, find_floor

    if floor_z is not None:
        if source is None:
            raise InputError("--floor-z is the height of the floor in a world: give --world as well")
        check_floor(world, floor_z)
        return floor_z
    if source is None or not looks_like_file(source) or is_yaml(source) or source.lower().endswith(".map"):
        return 0.0
    if start is None:
        return find_common_floor(world, robot)
    return find_floor(world, robot, start if isinstance(start, Pose2D) else Pose2D(*start))


def stand_on_floor(
    world: World, source: str | None, robot: Robot, start: Pose2D | None, floor_z: float | None
) -> World:
    """Move a world so that its floor is at z = 0; see `find_floor_z`."""
    from trundle.worlds.floors import lower_world

    return lower_world(world, find_floor_z(world, source, robot, start, floor_z))


def start_pose(world: World, text: str | None) -> Pose2D:
    """Return a robot's start pose: --start, else the world's first free place, else the origin."""
    from trundle.geometry import Pose2D

    if text is not None:
        return parse_pose("--start", text)
    return Pose2D(*world.seeds[0]) if world.seeds else Pose2D(0.0, 0.0)


def pick_ends(costmap: Costmap, start: Pose2D | None, goal: Goal | None, *, seed: int) -> tuple[Pose2D, Goal]:
    """Return start and goal; missing ones are picked from the free space by seed.

    Raises:
        ScenarioError: If none can be picked.
    """
    from trundle.geometry import Goal
    from trundle.mission import sample_mission

    if start is not None and goal is not None:
        return start, goal
    first, last = sample_mission(costmap, seed, start=start, goal=goal)
    return first, goal or Goal.of(last)
