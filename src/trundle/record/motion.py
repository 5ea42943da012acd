"""The motion of a robot over time, read from the record of a run or a drive: `trajectory.npz` or `drive.csv`."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from trundle.errors import InputError
from trundle.files.opening import exists, is_file
from trundle.geometry import FloatArray
from trundle.mission import Trajectory
from trundle.values import as_path

_CSV_NAMES = {"time": "time_s", "commanded_v": "command_v", "commanded_w": "command_w"}


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Poses and commands of a robot, one row per control period, in arrays of shape (N,).

    Attributes:
        time: Simulated time [s], increasing.
        x, y, yaw: Pose of base_link, map frame [m, m, rad].
        v, w: Twist in base_link [m/s, rad/s].
        commanded_v, commanded_w: Command during the period that ends at this time [m/s, rad/s].
    """

    time: FloatArray
    x: FloatArray
    y: FloatArray
    yaw: FloatArray
    v: FloatArray
    w: FloatArray
    commanded_v: FloatArray
    commanded_w: FloatArray

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Motion:
        """Read the folder of a run or of a drive, or the file in it.

        Raises:
            InputError: If there is no such folder or file, or it has no record; the message says what was searched.
        """
        place = Path(as_path(path, "the folder or file of a run"))
        is_folder = exists(place) and place.is_dir()
        files = [place / "trajectory.npz", place / "drive.csv"] if is_folder else [place]
        file = next((file for file in files if is_file(file)), None)
        if file is None:
            looked = "neither trajectory.npz nor drive.csv in it" if is_folder else "no such folder or file"
            raise InputError(f"{path}: {looked}; give the folder that trundle run or trundle drive wrote")
        columns = _read_csv(file) if file.suffix.lower() == ".csv" else _read_trajectory(file)
        if len(columns["time"]) < 2 or (np.diff(columns["time"]) <= 0.0).any():
            raise InputError(f"{file}: the times must increase, with at least two rows")
        return cls(**columns)


def _names() -> list[str]:
    return [field.name for field in fields(Motion)]


def _read_trajectory(file: Path) -> dict[str, FloatArray]:
    trajectory = Trajectory.load(file)
    return {name: getattr(trajectory, name) for name in _names()}


def _read_csv(file: Path) -> dict[str, FloatArray]:
    try:
        with file.open(newline="") as stream:
            rows = list(csv.DictReader(stream))
        columns = {
            name: np.array([float(row[_CSV_NAMES.get(name, name)]) for row in rows], dtype=np.float64)
            for name in _names()
        }
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"cannot read {file}: {error}") from error
    except KeyError as error:
        raise InputError(f"{file}: no column {error.args[0]}; give the drive.csv of trundle drive") from error
    except (TypeError, ValueError) as error:
        raise InputError(f"{file}: a row has a value that is not a number: {error}") from error
    if not all(np.isfinite(column).all() for column in columns.values()):
        raise InputError(f"{file}: a row has a value that is not finite")
    return columns
