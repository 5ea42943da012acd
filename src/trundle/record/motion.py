"""The motion of a robot over time, read from the record of a run or a drive: `trajectory.npz` or `drive.csv`."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from trundle.errors import InputError
from trundle.files.opening import exists, is_file
from trundle.geometry import FloatArray, Pose2D
from trundle.mission import Trajectory
from trundle.values import as_path

_CSV_NAMES = {"time": "time_s", "commanded_v": "command_v", "commanded_w": "command_w"}
_RESOLUTION_S = 2e-6
"""Resolution of the times in a record, which has six decimals."""


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

    @property
    def start(self) -> Pose2D:
        """The pose at the start."""
        return Pose2D(float(self.x[0]), float(self.y[0]), float(self.yaw[0]))

    def commands(self, step_s: float) -> list[tuple[float, float, float]]:
        """Return the commands (v [m/s], w [rad/s], seconds) that repeat it, consecutive equal ones merged.

        Args:
            step_s: Length of a physics step [s]. Times are rounded to it: a record has six decimals.

        Raises:
            InputError: If a control period is not a multiple of the physics step.
        """
        periods = np.diff(self.time).tolist()
        steps = [round(seconds / step_s) for seconds in periods]
        for seconds, count in zip(periods, steps, strict=True):
            if abs(seconds - count * step_s) > _RESOLUTION_S:
                raise InputError(
                    f"the record has a control period of {seconds:g} s, which is not a multiple of {step_s:g} s, the "
                    "step of the physics: its commands cannot be replayed exactly"
                )
        commands: list[tuple[float, float, float]] = []
        for v, w, count in zip(self.commanded_v[1:].tolist(), self.commanded_w[1:].tolist(), steps, strict=True):
            if commands and commands[-1][:2] == (v, w):
                commands[-1] = (v, w, round(commands[-1][2] + count * step_s, 9))
            else:
                commands.append((v, w, round(count * step_s, 9)))
        return commands


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
