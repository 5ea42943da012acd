"""The worlds of BARN and DynaBARN, from files that the user has, as environments."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from trundle.errors import InputError
from trundle.evaluation.public import barn, dynabarn
from trundle.geometry import Pose2D
from trundle.gym.arena import Arena, Missions, fixed_mission, make_map, record_movers
from trundle.gym.env import NavigationEnv
from trundle.gym.navigation_settings import NavigationSettings, Split
from trundle.gym.vector_env import NavigationVectorEnv
from trundle.maps import OccupancyGrid
from trundle.sim.batch import MoverRecording
from trundle.values import as_path, check_count, show_value
from trundle.worlds import World

GOAL_TOLERANCE = 1.0
"""The radius of BARN's goals [m]."""

MAX_TIME_S = 100.0
"""The time limit of the BARN Challenge [s]."""

_NAME = re.compile(r"world_(\d+)")

_ROOM = 1.0  # around start and goal [m]

_EVERY = 6
"""Every sixth world is for tests, 0, 6, 12, …, as in test.sh of the BARN Challenge; those halfway between validate."""

_UNUSED = {
    **dict.fromkeys(
        ("world", "worlds", "world_options", "movers", "crowd", "unmapped_boxes"), "these worlds are files"
    ),
    "min_distance": "start and goal are those of the BARN Challenge",
}


def barn_arena(settings: NavigationSettings, folder: str | os.PathLike[str], numbers: Sequence[int] | None) -> Arena:
    """Make the arena of BARN's worlds, each with the start and the goal of the BARN Challenge.

    Raises:
        InputError: If the folder holds no such worlds, none of the split, or lacks one of `numbers`.
    """
    found = barn.find_worlds(folder, numbers)
    chosen = split_worlds(list(found), settings.split, folder) if numbers is None else numbers
    worlds = [(f"world_{number}", World.load(found[number][0])) for number in chosen]
    return _arena(settings, worlds, Pose2D(*barn.START), barn.GOAL)


def dynabarn_arena(
    settings: NavigationSettings,
    file: str | os.PathLike[str],
    numbers: Sequence[int] | None,
    levels: Sequence[str] | None,
) -> Arena:
    """Make the arena of DynaBARN's worlds, each with the start and the goal of the BARN Challenge.

    Raises:
        InputError: If the file is damaged or of another kind, has no world of the split, or lacks one of `numbers`.
    """
    from trundle.worlds.dynabarn import LEVELS, load_dynabarn, read_dynabarn

    found = read_dynabarn(Path(file))
    if numbers is None:
        numbered = {int(match[1]): name for name in found if (match := _NAME.fullmatch(name))}
        names = [numbered[number] for number in split_worlds(list(numbered), settings.split, file)]
    else:
        names = [f"world_{number}" for number in numbers]
    for name in names:
        load_dynabarn(Path(file), world=name)  # refuses names that are not there
    wanted = LEVELS if levels is None else dynabarn.check_levels(levels)
    names = [name for name in names if found[name]["level"] in wanted]
    if not names:
        raise InputError(f"{file}: none of the worlds is {' or '.join(wanted)}")
    rng = np.random.default_rng(settings.seed)
    worlds = [(name, load_dynabarn(Path(file), world=name, start_s=float(rng.uniform(0.0, 60.0)))) for name in names]
    return _arena(settings, worlds, Pose2D(*dynabarn.START), dynabarn.GOAL)


def _arena(
    settings: NavigationSettings, worlds: Sequence[tuple[str, World]], start: Pose2D, goal: tuple[float, float]
) -> Arena:
    robot = settings.load_robot()
    grids, missions, fields, recordings = list[OccupancyGrid](), list[Missions](), [], list[list[MoverRecording]]()
    for name, world in worlds:
        low, high = world.bounds
        ends = np.array([(start.x, start.y), goal])
        corner, far = np.minimum(low[:2], ends.min(axis=0) - _ROOM), np.maximum(high[:2], ends.max(axis=0) + _ROOM)
        bounds = (float(corner[0]), float(corner[1])), (float(far[0]), float(far[1]))
        grid = make_map(settings, robot, world, bounds)
        mission, of_goal = fixed_mission(grid, robot, start, goal, name)
        grids.append(grid)
        missions.append(mission)
        fields.append(of_goal)
        recordings.append(record_movers(settings, robot, world))
    return Arena(robot, grids, [name for name, _ in worlds], missions, fields, recordings)


def split_worlds(numbers: Sequence[int], split: Split, place: object) -> list[int]:
    """Return which worlds, by their numbers, are of a split.

    Numbers that 6 divides are "test", those that leave 3 are "validation", and the others are "train".

    Raises:
        InputError: If none is.
    """
    splits: dict[int, Split] = {0: "test", _EVERY // 2: "validation"}
    chosen = [number for number in numbers if splits.get(number % _EVERY, "train") == split]
    if not chosen:
        has = ", ".join(map(str, numbers[:20])) + (" and more" if len(numbers) > 20 else "")
        raise InputError(f"{place}: none of its worlds ({has}) is of the split {split!r}: give numbers")
    return chosen


def _read_options(
    name: str, options: dict[str, Any], where: Mapping[str, object], numbers: Sequence[int] | None
) -> dict[str, Any]:
    """Return options with the defaults of the BARN Challenge, once they are known to have an effect."""
    for key, value in where.items():
        if value is None:
            raise InputError(
                f"trundle/{name} needs {key}: its worlds are files of yours; see docs/public_benchmarks.md"
            )
        as_path(value, key)
    for key, reason in _UNUSED.items():
        if key in options:
            raise InputError(f"the option {key} is for trundle/Navigation-v0; {reason}")
    if numbers is not None:
        if not isinstance(numbers, Sequence | np.ndarray) or isinstance(numbers, str) or len(numbers) == 0:
            raise InputError(f"numbers must be a list of numbers of worlds, got {show_value(numbers)}")
        for number in numbers:
            check_count("a number of a world", number, 0, 10**9)
        if "split" in options:
            raise InputError("split chooses worlds by their numbers: give split or numbers")
    return {"robot": "jackal", "goal_tolerance": GOAL_TOLERANCE, "max_time_s": MAX_TIME_S, **options}


def _make_barn(
    folder: str | os.PathLike[str] | None, numbers: Sequence[int] | None, options: dict[str, Any]
) -> dict[str, Any]:
    if "seed" in options:
        raise InputError("the option seed is for trundle/Navigation-v0; the seed of reset draws one of BARN's worlds")
    options = _read_options("Barn-v0", options, {"folder": folder}, numbers)
    return {"arena": barn_arena(NavigationSettings.of(options), cast("str", folder), numbers), **options}


def _make_dynabarn(
    file: str | os.PathLike[str] | None,
    numbers: Sequence[int] | None,
    levels: Sequence[str] | None,
    options: dict[str, Any],
) -> dict[str, Any]:
    options = _read_options("DynaBarn-v0", options, {"file": file}, numbers)
    return {"arena": dynabarn_arena(NavigationSettings.of(options), cast("str", file), numbers, levels), **options}


def make_barn(
    *,
    folder: str | os.PathLike[str] | None = None,
    numbers: Sequence[int] | None = None,
    render_mode: str | None = None,
    **options: Any,
) -> NavigationEnv:
    """Make `trundle/Barn-v0`: BARN's worlds of a folder; see `barn_suite` for the files.

    Args:
        folder: Holds the worlds.
        numbers: Which worlds; if None, those of the option `split`, see `split_worlds`.
        render_mode: As for `NavigationEnv`.
        options: As for `NavigationEnv`, but for those of generated worlds.

    Raises:
        InputError: If the folder or one of its worlds is not there, or an option has no effect.
    """
    return NavigationEnv(render_mode=render_mode, **_make_barn(folder, numbers, options))


def make_barn_vector(
    num_envs: int = 1,
    *,
    folder: str | os.PathLike[str] | None = None,
    numbers: Sequence[int] | None = None,
    **options: Any,
) -> NavigationVectorEnv:
    """Make many robots of `trundle/Barn-v0`; options as for `make_barn` and `NavigationVectorEnv`."""
    own = {name: options.pop(name) for name in ("autoreset_mode", "render_mode") if name in options}
    return NavigationVectorEnv(num_envs, **own, **_make_barn(folder, numbers, options))


def make_dynabarn(
    *,
    file: str | os.PathLike[str] | None = None,
    numbers: Sequence[int] | None = None,
    levels: Sequence[str] | None = None,
    render_mode: str | None = None,
    **options: Any,
) -> NavigationEnv:
    """Make `trundle/DynaBarn-v0`: DynaBARN's worlds of a file; see `dynabarn_suite` for it.

    Args:
        file: Holds the worlds.
        numbers: Which worlds; if None, those of the option `split`, see `split_worlds`.
        levels: Which of these: of these levels; if None, all.
        render_mode: As for `NavigationEnv`.
        options: As for `NavigationEnv`, but for those of generated worlds.

    Raises:
        InputError: If the file or one of its worlds is not there, or an option has no effect.
    """
    return NavigationEnv(render_mode=render_mode, **_make_dynabarn(file, numbers, levels, options))


def make_dynabarn_vector(
    num_envs: int = 1,
    *,
    file: str | os.PathLike[str] | None = None,
    numbers: Sequence[int] | None = None,
    levels: Sequence[str] | None = None,
    **options: Any,
) -> NavigationVectorEnv:
    """Make many robots of `trundle/DynaBarn-v0`; options as for `make_dynabarn` and `NavigationVectorEnv`."""
    own = {name: options.pop(name) for name in ("autoreset_mode", "render_mode") if name in options}
    return NavigationVectorEnv(num_envs, **own, **_make_dynabarn(file, numbers, levels, options))
