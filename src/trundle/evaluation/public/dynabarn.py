"""DynaBARN as a suite: worlds of moving cylinders, without a map; shipped by its authors, not by trundle.

Nair et al., DynaBARN: Benchmarking Metric Ground Navigation in Dynamic Environments, SSRR 2022. Start, goal, radius and
time limit are those of the BARN Challenge (run.py of Daffan/the-barn-challenge, as of 2026).
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.public.conditions import Conditions
from trundle.evaluation.statistics import Table
from trundle.evaluation.statistics.figures import mean_of_known
from trundle.evaluation.suite import Suite
from trundle.worlds.dynabarn import LEVELS, load_dynabarn, read_dynabarn

START = (11.0, 0.0, math.pi)
GOAL = (-9.0, 0.0)

_LATEST_START_S = 60.0
"""The motions are at a random time up to this [s] when the run begins, as in Gazebo: there it begins when the robot's
software is up."""

_REMEMBERED_S = 0.3
"""Nothing but the walls stands there: what no scan has hit for so long [s] has moved on, and its marks would only be in
the robot's way. No beam clears them behind the robot or behind another obstacle."""


def dynabarn_suite(
    file: str | os.PathLike[str],
    conditions: Conditions | None = None,
    *,
    numbers: Sequence[int] | None = None,
    levels: Sequence[str] | None = None,
) -> Suite:
    """Make a suite of DynaBARN's worlds. The seed of a run draws how far the obstacles' motions are when it begins.

    Args:
        file: The file of the worlds; see `trundle.worlds.dynabarn`.
        conditions: What drives, and how; by default five seeds, without drift and collision monitor.
        numbers: Numbers of the worlds to drive in; by default all that are there.
        levels: Levels of the worlds to drive in: easy, medium and hard; by default all.

    Raises:
        InputError: If the file is damaged or of another kind, or lacks one of `numbers`.
    """
    path = Path(file)
    found = read_dynabarn(path)
    names = list(found) if numbers is None else [f"world_{number}" for number in numbers]
    for name in names:
        load_dynabarn(path, world=name)  # reads its obstacles
    wanted = LEVELS if levels is None else check_levels(levels)
    names = [name for name in names if found[name]["level"] in wanted]
    if not names:
        raise InputError(f"{path}: none of the worlds is {' or '.join(wanted)}")
    worlds = [
        {
            "name": str(path),
            "label": f"{found[name]['level']}/{name}",
            "options": {"world": name, "start_s": {"uniform": [0.0, _LATEST_START_S]}},
        }
        for name in names
    ]
    conditions = Conditions(seeds=5, drift=False, collision_monitor=False) if conditions is None else conditions
    return Suite.make(
        name="dynabarn",
        worlds=worlds,
        missions={"seeds": conditions.seeds, "listed": [{"start": START, "goal": GOAL}]},
        layers={"obstacle": {"observation_persistence": _REMEMBERED_S + conditions.scan_age_s}},
        **conditions.suite_fields(),
    )


def check_levels(levels: Sequence[str]) -> tuple[str, ...]:
    """Return the levels of some names.

    Raises:
        UnknownNameError: If one is none.
    """
    unknown = [level for level in levels if level not in LEVELS]
    if unknown or not levels:
        raise UnknownNameError("level of DynaBARN", unknown[0] if unknown else "", LEVELS)
    return tuple(levels)


def dynabarn_figures(table: Table) -> Mapping[str, float | None]:
    """Return the shares of success of DynaBARN's levels, and the mean time [s] of the runs that arrived."""
    shares = {
        f"success_{level}": mean_of_known(table.arrived[of_level].astype(float))
        for level, of_level in rows_by_level(table).items()
    }
    return {**shares, "mean_time_s": mean_of_known(table.numbers["time_s"][table.arrived])}


def rows_by_level(table: Table) -> dict[str, npt.NDArray[np.bool_]]:
    """Return which rows are of each of DynaBARN's levels, in order of appearance."""
    worlds = table.named["world"]
    levels = [name.partition("/")[0] for name in worlds.names]
    return {level: np.array([each == level for each in levels])[worlds.codes] for level in dict.fromkeys(levels)}
