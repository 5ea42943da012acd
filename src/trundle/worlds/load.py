"""Worlds from files: the loader for each suffix, and the checks on every world that is read."""

from __future__ import annotations

import importlib
import inspect
import os
import warnings
from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.errors import WorldError, WorldWarning
from trundle.files.opening import check_regular, describe_unreadable
from trundle.guard import ReadCall, ReadLimits, read_guarded
from trundle.maps.from_world import find_outlier
from trundle.values import as_path
from trundle.worlds.leave_out import leave_out
from trundle.worlds.options import check_options
from trundle.worlds.world_like import WorldLike

_MAPS = "trundle.worlds.from_map:load_map"
_DYNABARN = "trundle.worlds.dynabarn:load_dynabarn"

LOADERS = {
    ".sdf": "trundle.worlds.gazebo.load:load_sdf",
    ".world": "trundle.worlds.gazebo.load:load_sdf",
    ".xacro": "trundle.worlds.gazebo.load:load_sdf",
    ".xml": "trundle.worlds.mjcf:load_mjcf",
    ".mjcf": "trundle.worlds.mjcf:load_mjcf",
    ".urdf": "trundle.worlds.mjcf:load_mjcf",
    ".glb": "trundle.worlds.meshes:load_mesh",
    ".gltf": "trundle.worlds.meshes:load_mesh",
    ".obj": "trundle.worlds.meshes:load_mesh",
    ".stl": "trundle.worlds.meshes:load_mesh",
    ".ply": "trundle.worlds.meshes:load_mesh",
    ".dae": "trundle.worlds.meshes:load_mesh",
    ".yaml": _MAPS,
    ".yml": _MAPS,
    ".map": _MAPS,
    ".json": _DYNABARN,
    ".usd": "trundle.worlds.usd:load_usd",
    ".usda": "trundle.worlds.usd:load_usd",
    ".usdc": "trundle.worlds.usd:load_usd",
    ".usdz": "trundle.worlds.usd:load_usd",
}
"""Suffix → `"module:function"`; the function takes the path and options by keyword, and returns a `World`."""

_LIBRARIES = {
    "trundle.worlds.gazebo.load:load_sdf": ("trundle.worlds.gazebo.load",),
    "trundle.worlds.mjcf:load_mjcf": ("trundle.worlds.mjcf", "mujoco"),
    "trundle.worlds.meshes:load_mesh": ("trundle.worlds.meshes", "trimesh"),
    "trundle.worlds.usd:load_usd": ("trundle.worlds.usd.load",),
}
"""Modules that each loader imports, which do not count towards the file's limits."""

LARGEST_EXTENT = 2_000.0
"""A world longer than this [m] is probably in another unit."""


def is_world_file(text: str) -> bool:
    """Return whether a text names a file that `World.load` has a loader for; it need not exist."""
    return Path(text).suffix.lower() in LOADERS


def load_world(path: str | os.PathLike[str], /, *, limits: ReadLimits, **options: Any) -> WorldLike:
    """Read a world from a file; see `World.load`.

    All formats but maps and JSON are read by third-party libraries, and therefore in a separate process: see
    `trundle.guard`.
    """
    file = Path(as_path(path, "a world's file", WorldError))
    target = LOADERS.get(file.suffix.lower())
    if target is None:
        raise WorldError(
            f"{file}: the suffix of a world file must be one of {', '.join(sorted(LOADERS))}, got {file.suffix!r}"
        )
    try:
        check_regular(file)
    except OSError as error:
        raise WorldError(describe_unreadable(file, error, "the file of a world")) from error
    if target in (_MAPS, _DYNABARN):
        return read_world(str(file), options)
    call = ReadCall(
        "trundle.worlds.load:read_world",
        (str(file), options),
        what=str(file),
        error=WorldError,
        limits=limits,
        imports=_LIBRARIES.get(target, ()),
    )
    return read_guarded(call, stacklevel=3)


def read_world(path: str, options: dict[str, Any]) -> WorldLike:
    """Read a world in this process; see `load_world`."""
    file = Path(path)
    options = dict(options)
    load = _loader(LOADERS[file.suffix.lower()])
    exclude, floor_z = options.pop("exclude", ()), options.pop("floor_z", None)
    known = _keywords(load)
    check_options(str(file), f"a {file.suffix} file", options, list(dict.fromkeys([*known, "exclude", "floor_z"])))
    # Loaders that take `exclude` skip those parts, so nothing in them can be missing or wrong.
    world = cast("WorldLike", load(file, **options, **({"exclude": exclude} if "exclude" in known else {})))
    if "exclude" not in known:
        world = leave_out(world, exclude, str(file))
    if floor_z is not None:
        from trundle.worlds.floors import lower_world

        world = lower_world(world, floor_z)
    takes_looks = "geometry" in known and options.get("geometry") != "visual"
    _check_extent(file, world, 'to load visual shapes without collision, use geometry="visual"' if takes_looks else "")
    return world


def takes_paths(text: str) -> bool:
    """Return whether a text names a file that may refer to others, so that its loader takes folders to search."""
    target = LOADERS.get(Path(text).suffix.lower())
    return target is not None and "paths" in _keywords(_loader(target))


def _loader(target: str) -> Any:
    module, _, name = target.partition(":")
    return getattr(importlib.import_module(module), name)


def _keywords(load: Any) -> list[str]:
    """Return the options of a loader."""
    parameters = inspect.signature(load).parameters.items()
    return [name for name, parameter in parameters if parameter.kind is inspect.Parameter.KEYWORD_ONLY]


def _check_extent(file: Path, world: WorldLike, advice: str) -> None:
    if not world.solids:
        here = f"{file}: it contains no solids: the world is an empty floor"
        warnings.warn(f"{here}{'; ' if advice else ''}{advice}", WorldWarning, stacklevel=4)
        return
    low, high = world.bounds
    if float(np.max(high - low)) <= LARGEST_EXTENT:
        return
    size = " x ".join(f"{extent:.0f}" for extent in high - low)
    warnings.warn(
        f"{file}: the world is {size} m; {find_outlier(world.solids)}. Look for a wrong unit (millimetres, "
        "centimetres) or a solid that is far away by mistake",
        WorldWarning,
        stacklevel=4,
    )
