"""BARN as a suite: 300 worlds of cylinders, without a map; shipped by its authors, not by trundle.

Perille et al., Benchmarking Metric Ground Navigation, SSRR 2020. Start, goal, radius, time limit and score are those of
the BARN Challenge (run.py of Daffan/the-barn-challenge, as of 2026).
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.public.conditions import Conditions
from trundle.evaluation.public.reference import load_reference
from trundle.evaluation.statistics import Table
from trundle.evaluation.statistics.figures import mean_of_known
from trundle.evaluation.suite import Suite
from trundle.files.opening import is_file

START = (-2.25, 3.0, math.pi / 2.0)
GOAL = (-2.25, 13.0)

_WORLD = re.compile(r"world_(\d+)\.world")
_SOURCE = "Daffan/the-barn-challenge has them in jackal_helper/worlds/BARN"


def barn_suite(
    folder: str | os.PathLike[str], conditions: Conditions | None = None, *, numbers: Sequence[int] | None = None
) -> Suite:
    """Make a suite of BARN's worlds.

    Args:
        folder: Holds `world_N.world` of each world, and its `path_N.npy` beside it or in `path_files`.
        conditions: What drives, and how; by default `Conditions()`.
        numbers: Numbers of the worlds to drive in; by default all that are there.

    Raises:
        InputError: If the folder holds no such worlds, or lacks one of `numbers` or a path.
    """
    chosen = find_worlds(folder, numbers)
    worlds = [
        {"name": str(world), "label": f"world_{number}", "floor_z": 0.0, "reference": str(reference)}
        for number, (world, reference) in chosen.items()
    ]
    conditions = Conditions() if conditions is None else conditions
    return Suite.make(
        name="barn",
        worlds=worlds,
        missions={"seeds": conditions.seeds, "listed": [{"start": START, "goal": GOAL}]},
        **conditions.suite_fields(),
    )


def barn_figures(table: Table, rows: npt.NDArray[np.bool_] | None = None) -> Mapping[str, float | None]:
    """Return the means of BARN: of the score over all runs, of the times [s] over those that arrived."""
    every = np.ones(len(table), dtype=bool) if rows is None else rows
    arrived = every & table.arrived
    times, shortest = (table.numbers[name].astype(float) for name in ("time_s", "shortest_time_s"))
    return {
        "barn_score": mean_of_known(table.numbers["barn_score"][every]),
        "mean_time_s": mean_of_known(times[arrived]),
        "mean_shortest_time_s": mean_of_known(shortest[arrived]),
    }


def find_worlds(folder: str | os.PathLike[str], numbers: Sequence[int] | None = None) -> dict[int, tuple[Path, Path]]:
    """Return the files of BARN's worlds in a folder, by number: the world's, and that of its reference path.

    Raises:
        InputError: If there are none, or one is missing.
    """
    place = Path(folder)
    if not place.is_dir():
        what = "a file: give the folder that holds it" if is_file(place) else "no such folder"
        raise InputError(f"{place}: {what}; BARN's worlds are world_N.world with path_N.npy ({_SOURCE})")
    found = {int(match[1]): path for path in place.iterdir() if (match := _WORLD.fullmatch(path.name))}
    if not found:
        below = next((path for path in sorted(place.glob("**/world_*.world")) if _WORLD.fullmatch(path.name)), None)
        hint = "" if below is None else f"; there are some in {below.parent}"
        raise InputError(f"{place}: no world_N.world in it{hint}; {_SOURCE}")
    missing = [number for number in numbers or () if number not in found]
    if missing:
        raise InputError(f"{place}: there is no world_{missing[0]}.world; it has {_describe(sorted(found))}")
    chosen = sorted(found) if numbers is None else numbers
    return {number: (found[number], _reference_of(place, number)) for number in chosen}


def _reference_of(folder: Path, number: int) -> Path:
    name = f"path_{number}.npy"
    path = next((path for path in (folder / name, folder / "path_files" / name) if is_file(path)), None)
    if path is None:
        raise InputError(
            f"{folder}: there is no {name} for world_{number}.world, beside it or in path_files: the score needs this "
            f"reference path; {_SOURCE}/path_files"
        )
    load_reference(path)
    return path


def _describe(numbers: Sequence[int]) -> str:
    shown = ", ".join(map(str, numbers[:20]))
    return f"worlds {shown}{'' if len(numbers) <= 20 else f' and {len(numbers) - 20} more'}"
