"""The worlds of BARN and DynaBARN, from files that the user has, as environments."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.evaluation.public import barn, dynabarn
from trundle.geometry import Pose2D
from trundle.gym.arena import Arena, Missions, fixed_mission, make_map, record_movers
from trundle.gym.env import NavigationEnv
from trundle.gym.settings import NavigationSettings
from trundle.gym.vector_env import NavigationVectorEnv
from trundle.maps import OccupancyGrid
from trundle.sim.batch import MoverRecording
from trundle.worlds import World

GOAL_TOLERANCE = 1.0
"""The radius of BARN's goals [m]."""

MAX_TIME_S = 100.0
"""The time limit of the BARN Challenge [s]."""

_ROOM = 1.0  # around start and goal [m]


def barn_arena(settings: NavigationSettings, folder: str | os.PathLike[str], numbers: Sequence[int] | None) -> Arena:
    """Make the arena of BARN's worlds, each with the start and the goal of the BARN Challenge.

    Raises:
        InputError: If the folder holds no such worlds, or lacks one of `numbers`.
    """
    worlds = [(f"world_{number}", World.load(path)) for number, (path, _) in barn.find_worlds(folder, numbers).items()]
    return _arena(settings, worlds, Pose2D(*barn.START), barn.GOAL)


def dynabarn_arena(
    settings: NavigationSettings,
    file: str | os.PathLike[str],
    numbers: Sequence[int] | None,
    levels: Sequence[str] | None,
) -> Arena:
    """Make the arena of DynaBARN's worlds, each with the start and the goal of the BARN Challenge.

    Raises:
        InputError: If the file is damaged or of another kind, or lacks one of `numbers`.
    """
    from trundle.worlds.dynabarn import LEVELS, load_dynabarn, read_dynabarn

    found = read_dynabarn(Path(file))
    names = list(found) if numbers is None else [f"world_{number}" for number in numbers]
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
        mission, of_goal = fixed_mission(grid, robot, start, goal, name, first_field=len(fields))
        grids.append(grid)
        missions.append(mission)
        fields += of_goal
        recordings.append(record_movers(settings, robot, world))
    return Arena(robot, grids, [name for name, _ in worlds], missions, fields, recordings)


def _challenge(options: dict[str, Any]) -> dict[str, Any]:
    for name in ("world", "worlds", "world_options", "movers", "crowd", "unmapped_boxes"):
        if name in options:
            raise InputError(f"the option {name} is for trundle/Navigation-v0; these worlds are files")
    return {"robot": "jackal", "goal_tolerance": GOAL_TOLERANCE, "max_time_s": MAX_TIME_S, **options}


def make_barn(
    *,
    folder: str | os.PathLike[str],
    numbers: Sequence[int] | None = None,
    render_mode: str | None = None,
    **options: Any,
) -> NavigationEnv:
    """Make `trundle/Barn-v0`: BARN's worlds of a folder; see `barn_suite` for the files."""
    options = _challenge(options)
    arena = barn_arena(NavigationSettings.of(options), folder, numbers)
    return NavigationEnv(render_mode=render_mode, arena=arena, **options)


def make_barn_vector(
    num_envs: int = 1, *, folder: str | os.PathLike[str], numbers: Sequence[int] | None = None, **options: Any
) -> NavigationVectorEnv:
    """Make many robots of `trundle/Barn-v0`; options as for `NavigationVectorEnv`."""
    own = {name: options.pop(name) for name in ("autoreset_mode", "render_mode") if name in options}
    options = _challenge(options)
    arena = barn_arena(NavigationSettings.of(options), folder, numbers)
    return NavigationVectorEnv(num_envs, arena=arena, **own, **options)


def make_dynabarn(
    *,
    file: str | os.PathLike[str],
    numbers: Sequence[int] | None = None,
    levels: Sequence[str] | None = None,
    render_mode: str | None = None,
    **options: Any,
) -> NavigationEnv:
    """Make `trundle/DynaBarn-v0`: DynaBARN's worlds of a file; see `dynabarn_suite` for it."""
    options = _challenge(options)
    arena = dynabarn_arena(NavigationSettings.of(options), file, numbers, levels)
    return NavigationEnv(render_mode=render_mode, arena=arena, **options)


def make_dynabarn_vector(
    num_envs: int = 1,
    *,
    file: str | os.PathLike[str],
    numbers: Sequence[int] | None = None,
    levels: Sequence[str] | None = None,
    **options: Any,
) -> NavigationVectorEnv:
    """Make many robots of `trundle/DynaBarn-v0`; options as for `NavigationVectorEnv`."""
    own = {name: options.pop(name) for name in ("autoreset_mode", "render_mode") if name in options}
    options = _challenge(options)
    arena = dynabarn_arena(NavigationSettings.of(options), file, numbers, levels)
    return NavigationVectorEnv(num_envs, arena=arena, **own, **options)
