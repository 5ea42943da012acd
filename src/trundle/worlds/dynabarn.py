"""DynaBARN's worlds: cylinders that move on splines between three walls, from a file of their key frames.

Nair et al., DynaBARN: Benchmarking Metric Ground Navigation in Dynamic Environments, SSRR 2022. Its public worlds have
the motions of their obstacles in compiled plug-ins of Gazebo; such a file has them as JSON.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

from trundle.errors import WorldError
from trundle.files.opening import parser_reason, read_limited
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Solid
from trundle.values import check_number, is_finite_number, show_value
from trundle.worlds.movers import Mover, Waypoints
from trundle.worlds.world import World

LEVELS = ("easy", "medium", "hard")

_RADIUS, _HEIGHT = 0.5, 1.0  # of an obstacle [m]
_WALLS = {"north": (0.0, 10.0, 20.0, 0.5), "south": (0.0, -10.0, 20.0, 0.5), "west": (-10.0, 0.0, 0.5, 20.0)}
"""Centre and size [m] of the walls, as in the public worlds."""

_RED: Color = (0.80, 0.22, 0.18, 1.0)
_BLUE: Color = (0.25, 0.38, 0.70, 1.0)
_MOST_BYTES = 100_000_000
_FORM = '{"world_0": {"level": "easy", "obstacles": [{"period_s": 33.5, "waypoints": [[0.0, 1.5, -3.0], …]}, …]}, …}'


def load_dynabarn(path: Path, *, world: str | int | None = None, start_s: float = 0.0) -> World:
    """Read one world from a file of DynaBARN's obstacles.

    Each obstacle follows a Catmull-Rom spline through its key frames (t, x, y), and starts again after its period: it
    jumps back to its first key frame, as in Gazebo.

    Args:
        path: The file.
        world: Name or number of the world, `world_4` or 4. If None, the file must have one only.
        start_s: How far the motions are when a run begins [s].

    Raises:
        WorldError: If the file is damaged or of another kind, or has no such world.
        InputError: If `start_s` is not a number of 0 or more.
    """
    start_s = check_number("start_s", start_s, 0.0, math.inf, "s")
    worlds = read_dynabarn(path)
    name = _choose(path, worlds, world)
    movers = tuple(
        Mover(
            f"obstacle_{number}",
            (Solid("cylinder", Cylinder(_RADIUS, _HEIGHT), Pose3D((0.0, 0.0, _HEIGHT / 2.0)), _RED),),
            _read_motion(f"{path}: {name}, obstacle {number}", obstacle, start_s),
            "obstacle",
            may_cross=True,
        )
        for number, obstacle in enumerate(worlds[name]["obstacles"])
    )
    walls = tuple(
        Solid(f"wall_{side}", Box((wide, deep, _HEIGHT)), Pose3D((x, y, _HEIGHT / 2.0)), _BLUE)
        for side, (x, y, wide, deep) in _WALLS.items()
    )
    return World(name, walls, movers=movers)


def read_dynabarn(path: Path) -> dict[str, dict[str, Any]]:
    """Return the worlds of a file, by name: `level` and `obstacles` of each.

    Raises:
        WorldError: If the file cannot be read, is damaged or of another kind.
    """
    too_large = f"larger than {_MOST_BYTES // 1_000_000} MB: this is no file of DynaBARN's worlds"
    data = read_limited(path, _MOST_BYTES, too_large, error=WorldError)
    try:
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise WorldError(
            f"{path}: not JSON: {parser_reason(error)}; the file may be incomplete: copy it again"
        ) from error
    if not isinstance(content, dict) or not content:
        raise WorldError(f"{path}: no worlds of DynaBARN in it; it must be {_FORM}")
    worlds = cast("dict[str, Any]", content)
    for name, world in worlds.items():
        _check(f"{path}: {name}", world)
    return worlds


def _check(where: str, world: object) -> None:
    fields = cast("Mapping[str, object]", world) if isinstance(world, Mapping) else {}
    if not isinstance(fields.get("obstacles"), list):
        raise WorldError(f"{where}: no world of DynaBARN: it has no obstacles; it must be as in {_FORM}")
    if fields.get("level") not in LEVELS:
        raise WorldError(
            f"{where}: level must be {', '.join(LEVELS[:-1])} or {LEVELS[-1]}, got {fields.get('level')!r}"
        )


def _choose(path: Path, worlds: Mapping[str, object], world: str | int | None) -> str:
    if world is None:
        if len(worlds) == 1:
            return next(iter(worlds))
        raise WorldError(f"{path}: there are {len(worlds)} worlds in it: name one with world={next(iter(worlds))}")
    name = f"world_{world}" if str(world).isdecimal() else str(world)
    if name not in worlds:
        nearest = get_close_matches(name, worlds, n=1)
        hint = f" (did you mean {nearest[0]}?)" if nearest else ""
        raise WorldError(f"{path}: there is no world {name}{hint}; there are {', '.join(worlds)}")
    return name


def _read_motion(where: str, obstacle: object, start_s: float) -> Waypoints:
    fields = cast("Mapping[str, object]", obstacle) if isinstance(obstacle, Mapping) else {}
    points, period = fields.get("waypoints"), fields.get("period_s")
    if not isinstance(points, list) or len(points) < 2 or not all(map(_is_key_frame, points)):
        raise WorldError(f"{where}: waypoints must be a list of two or more [t, x, y], all finite numbers")
    frames = [tuple(map(float, point)) for point in cast("list[list[float]]", points)]
    last = frames[-1]
    if not is_finite_number(period) or period < last[0]:
        raise WorldError(
            f"{where}: period_s must be a number of {last[0]:g} s, the last key frame, or more; "
            f"got {show_value(period)}"
        )
    if period > last[0]:
        frames.append((float(period), *last[1:]))
    try:
        return Waypoints(tuple(frames), "catmull_rom", "loop", phase_s=start_s)
    except WorldError as error:
        raise WorldError(f"{where}: {error}") from error


def _is_key_frame(point: object) -> bool:
    return isinstance(point, list) and len(point) == 3 and all(map(is_finite_number, cast("list[object]", point)))
