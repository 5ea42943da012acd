"""`paths.npz`: the paths that a run followed."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.files.npz import read_arrays
from trundle.mission.trajectory import write_arrays
from trundle.path import Path
from trundle.values import as_array

_NUMBERS = ("cost", "start_snapped_m", "goal_snapped_m", "remaining_m")
_KEYS = ("poses", "backward", "count", "planner", "replans", "partial", *_NUMBERS)


def save_paths(file: str | os.PathLike[str], paths: Sequence[Path]) -> None:
    """Write paths as an .npz that `load_paths` reads back bit for bit.

    Raises:
        OutputError: If it cannot be written; nothing is left behind.
    """
    none = np.zeros((0, 3))
    columns = {
        "poses": np.concatenate([none, *(path.poses for path in paths)]),
        "backward": np.concatenate([np.zeros(0, np.bool_), *(path.backward for path in paths)]),
        "count": np.array([len(path) for path in paths], dtype=np.int64),
        "planner": np.array([path.planner for path in paths], dtype=np.str_),
        "replans": np.array([path.replans for path in paths], dtype=np.int64),
        "partial": np.array([path.status == "partial" for path in paths], dtype=np.bool_),
    }
    columns |= {name: np.array([getattr(path, name) for path in paths], dtype=np.float64) for name in _NUMBERS}
    write_arrays(file, columns)


def load_paths(file: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Read what `save_paths` wrote.

    Raises:
        InputError: If the file cannot be read, or does not hold paths.
    """
    name = os.fspath(file)
    arrays, _ = read_arrays(file, _KEYS, error=InputError)
    missing = [key for key in _KEYS if key not in arrays]
    if missing:
        raise InputError(f"{name}: not the paths of a run: it has no {', '.join(missing)}")
    try:
        return _split(arrays)
    except InputError as error:
        raise InputError(f"{name}: not the paths of a run: {error}") from error
    except (TypeError, ValueError, OverflowError, IndexError, SystemError) as error:  # the last for text beyond Unicode
        raise InputError(f"{name}: not the paths of a run: its arrays do not fit together: {error}") from error


def _split(arrays: Mapping[str, npt.NDArray[Any]]) -> tuple[Path, ...]:
    counts = as_array(arrays["count"], np.int64, "count")
    if counts.ndim != 1 or (counts < 1).any() or {len(arrays[key]) for key in _KEYS[2:]} != {len(counts)}:
        raise InputError("its arrays do not have one entry for each path")
    if len(arrays["poses"]) != counts.sum() or len(arrays["backward"]) != (counts - 1).sum():
        raise InputError("its poses and legs are not as many as its counts say")
    poses = np.split(arrays["poses"], np.cumsum(counts)[:-1])
    backward = np.split(arrays["backward"], np.cumsum(counts - 1)[:-1])
    return tuple(
        Path(
            poses[index],
            backward=backward[index],
            planner=str(arrays["planner"][index]),
            replans=int(arrays["replans"][index]),
            status="partial" if arrays["partial"][index] else "found",
            **{key: float(arrays[key][index]) for key in _NUMBERS},
        )
        for index in range(len(counts))
    )
