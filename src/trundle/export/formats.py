"""The export formats: their names and suffixes, the kinds that they hold, and the functions that write them."""

from __future__ import annotations

import importlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, cast

from trundle.errors import InputError, OutputError, UnknownNameError, WorldError
from trundle.export.plain import Scene, check_encodable
from trundle.files.opening import exists
from trundle.files.writing import output_path
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World

Kind: TypeAlias = Literal["world", "robot", "scenario"]
"""What can be exported."""


@dataclass(frozen=True, slots=True)
class Format:
    """A file format, and what it can hold.

    Attributes:
        suffixes: File suffixes; the first is the usual one.
        world: `"module:function"` that writes a world, taking the world and the path, or None.
        robot: The same for a robot.
        scene: The same for a robot in a world.
    """

    suffixes: tuple[str, ...]
    world: str | None = None
    robot: str | None = None
    scene: str | None = None

    def writer(self, kind: Kind) -> str | None:
        """Return the function that writes this kind, or None."""
        return {"world": self.world, "robot": self.robot, "scenario": self.scene}[kind]


FORMATS = {
    "glb": Format((".glb",), world="trundle.export.glb:export_world"),
    "isaac-script": Format((".py",), scene="trundle.export.isaac_script:export_scene"),
    "map": Format((".yaml", ".yml"), world="trundle.export.formats:export_map"),
    "mjcf": Format(
        (".xml", ".mjcf"),
        "trundle.export.mjcf:export_world",
        "trundle.export.mjcf:export_robot",
        "trundle.export.mjcf:export_scene",
    ),
    "sdf": Format((".sdf", ".world"), world="trundle.export.sdf:export_world"),
    "urdf": Format((".urdf",), robot="trundle.export.urdf:export_robot"),
    "usd": Format(
        (".usd", ".usda", ".usdc"),
        "trundle.export.usd:export_world",
        "trundle.export.usd:export_robot",
        "trundle.export.usd:export_scene",
    ),
}
"""The formats by name."""


def format_of(path: str | os.PathLike[str]) -> str:
    """Return the name of the format for a file's suffix.

    Raises:
        InputError: If no format has this suffix.
    """
    suffix = output_path(path).suffix.lower()
    for name, known in FORMATS.items():
        if suffix in known.suffixes:
            return name
    suffixes = ", ".join(f"{known.suffixes[0]} ({name})" for name, known in sorted(FORMATS.items()))
    raise InputError(f"{path}: unknown file format; the name must end in one of {suffixes}")


def export_world(world: World, path: str | os.PathLike[str], *, to: str | None = None, **options: Any) -> Path:
    """Write a world to a file.

    The file loads back as the same solids: names, shapes, poses and colours. A GLB holds only meshes, and its round
    shapes are at most 0.5 % larger. A map holds the solids in its height band. Blocked
    cells of a large map are written as boxes, in USD as one mesh of them.

    Args:
        world: The world.
        path: The file; an existing file is replaced atomically.
        to: The format by name; by default that of the path's suffix.
        options: Options of the format: `robot` for mjcf; `resolution` and `z_range` for map; `profile` for usd.

    Returns:
        The path.

    Raises:
        UnknownNameError: If there is no such format; the nearest is offered.
        WorldError: If the format cannot hold the world.
        InputError: If the path has another format's suffix, or an option is not the format's.
        OutputError: If the file cannot be written.
        MissingExtraError: If a library that it needs is not installed.
    """
    return _export("world", world, path, to, options)


def export_robot(robot: Robot, path: str | os.PathLike[str], *, to: str | None = None, **options: Any) -> Path:
    """Write a robot to a file: its bodies with their masses and inertias, its joints and colliders.

    Args:
        robot: The robot.
        path: The file; an existing file is replaced atomically.
        to: The format by name; by default that of the path's suffix.
        options: Options of the format: `profile` for usd.

    Returns:
        The path.

    Raises:
        UnknownNameError: If there is no such format; the nearest is offered.
        InputError: If the format holds no robots, the path has another format's suffix, or an option is not known.
        OutputError: If the file cannot be written.
        MissingExtraError: If a library that it needs is not installed.
    """
    return _export("robot", robot, path, to, options)


def export_scene(scene: Scene, path: str | os.PathLike[str], *, to: str | None = None, **options: Any) -> Path:
    """Write a robot in a world, at its start pose, to a file; `isaac-script` includes the planned paths.

    Args:
        scene: The scene.
        path: The file; an existing file is replaced atomically.
        to: The format by name; by default that of the path's suffix.
        options: Options of the format: `profile` for usd; `environment` and `robot_usd` for isaac-script.

    Returns:
        The path.

    Raises:
        UnknownNameError: If there is no such format; the nearest is offered.
        WorldError: If the format cannot hold the world.
        InputError: If the format holds no scenarios, the path has another format's suffix, or an option is not known.
        OutputError: If the file cannot be written.
        MissingExtraError: If a library that it needs is not installed.
    """
    return _export("scenario", scene, path, to, options)


def _export(kind: Kind, thing: object, path: str | os.PathLike[str], to: str | None, options: dict[str, Any]) -> Path:
    file = Path(path)
    name = format_of(file) if to is None else to
    if name not in FORMATS:
        raise UnknownNameError("format", name, FORMATS)
    chosen = FORMATS[name]
    target = chosen.writer(kind)
    if target is None:
        able = ", ".join(sorted(key for key, known in FORMATS.items() if known.writer(kind)))
        raise InputError(f"the format {name} cannot hold a {kind}; a {kind} can be written as {able}")
    if file.suffix.lower() not in chosen.suffixes:
        raise InputError(f"{file}: the name of a {name} file must end in {' or '.join(chosen.suffixes)}")
    if exists(file) and file.is_dir():
        raise OutputError(f"cannot write {file}: it is a folder")
    if isinstance(thing, World) and not thing.solids and name not in ("mjcf", "usd"):
        raise WorldError(f"world {thing.name!r} has no solids: there is nothing to write to {file}")
    world = thing.world if isinstance(thing, Scene) else thing
    if isinstance(world, World):
        check_encodable([world.name, *(solid.name for solid in world.solids)])
    module, _, function = target.partition(":")
    write = cast("Any", getattr(importlib.import_module(module), function))
    try:
        write(thing, file, **options)
    except TypeError as error:
        if "unexpected keyword" not in str(error):
            raise
        raise InputError(f"{name}: {error}") from error
    return file


def export_map(
    world: World, path: Path, *, resolution: float = 0.05, z_range: tuple[float, float] = (0.10, 0.62)
) -> None:
    """Write the map of a world.

    Args:
        world: The world.
        path: The YAML; its image lies beside it.
        resolution: Cell size [m].
        z_range: Height band of obstacles [m].

    Raises:
        MapError: If the map cannot be made; see `OccupancyGrid.from_world`.
        OutputError: If the files cannot be written.
    """
    OccupancyGrid.from_world(world, resolution=resolution, z_range=z_range).save(path)
