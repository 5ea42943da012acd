"""Interpreting a verb's first argument: a world by name, a world's file, a map's YAML, or a scenario's."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trundle.cli.shared.given import check_given
from trundle.cli.shared.options import join_paths, parse_pose, parse_settings
from trundle.errors import InputError, UnknownNameError
from trundle.files.kinds import MAP, ROBOT, WORLD

if TYPE_CHECKING:
    from trundle.costmap import Costmap
    from trundle.geometry import Goal, Pose2D
    from trundle.robots import Robot
    from trundle.worlds import World


def is_map(path: Path) -> bool:
    """Whether a file is a map: a ROS map's YAML has an `image:` key, a MovingAI map ends in .map.

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
    """Whether a YAML file is a scenario: it has a `world:` or a `map:` key.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    import yaml

    from trundle.files.yaml_nodes import compose

    node = compose(path)
    return isinstance(node, yaml.MappingNode) and any(key.value in ("world", "map") for key, _ in node.value)


def is_written(source: str) -> bool:
    """Whether an argument is the file of a scenario, which says itself what it does not leave to defaults.

    Raises:
        InputError: If it cannot be read as YAML.
    """
    return is_yaml(source) and is_scenario(Path(source)) and not is_map(Path(source))


def is_usd(text: str) -> bool:
    """Whether an argument is a USD file."""
    return text.lower().endswith((".usd", ".usda", ".usdc", ".usdz"))


def looks_like_file(text: str) -> bool:
    """Whether an argument is a file rather than a name."""
    from trundle.worlds.load import is_world_file

    return is_world_file(text) or os.sep in text


def is_yaml(text: str) -> bool:
    """Whether an argument is a YAML file, which may be a map or a scenario."""
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
    """Height [m] of the floor: --floor-z, else under the start, or under most of a world from a file.

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
    """A world with its floor at z = 0; see `find_floor_z`."""
    from trundle.worlds.floors import lower_world

    return lower_world(world, find_floor_z(world, source, robot, start, floor_z))


def start_pose(world: World, text: str | None) -> Pose2D:
    """A robot's start pose: --start, else the world's first free place, else the origin."""
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
