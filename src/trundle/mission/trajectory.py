"""`Trajectory`: where a robot was and what was commanded, one row per control period."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.extras import missing_extra
from trundle.files.npz import read_arrays
from trundle.files.writing import write_bytes
from trundle.geometry import FloatArray
from trundle.observation import LOCALIZATION_STATES
from trundle.values import as_array

if TYPE_CHECKING:
    import pandas  # pyright: ignore[reportMissingImports] - an extra

_WHOLE = ("goal", "path", "localization")
_ESTIMATES = ("estimate_x", "estimate_y", "estimate_yaw")
_ADDED = (*_ESTIMATES, "localization")
"""Columns that files of older versions lack."""


def _not_given() -> FloatArray:
    return np.zeros(0)


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A run, one row per control period, in arrays of shape (N,) that are read-only.

    The first row is the start, at rest. The command of a row is what was commanded during the period that ends there.

    Attributes:
        time: Simulated time [s].
        x, y, yaw: True pose of base_link, map frame [m, m, rad].
        v, w: True twist in base_link [m/s, rad/s].
        commanded_v, commanded_w: The command that was sent, before the robot's limits [m/s, rad/s].
        odometry_x, odometry_y, odometry_yaw: Wheel odometry, in a frame with its origin at the start pose.
        goal: Index of the goal that it was driving to; int64.
        path: Index in `Episode.paths` of the path that it was following, −1 for none; int64.
        estimate_x, estimate_y, estimate_yaw: Estimated pose of base_link, map frame; none given means the true pose.
        localization: What the localizer says of it, as an index in `LOCALIZATION_STATES`: 0 localized, 1 ambiguous, 2
            lost; int64. None given means localized.

    Raises:
        InputError: If the arrays are not one-dimensional, of one length above 0, and finite.
    """

    time: FloatArray
    x: FloatArray
    y: FloatArray
    yaw: FloatArray
    v: FloatArray
    w: FloatArray
    commanded_v: FloatArray
    commanded_w: FloatArray
    odometry_x: FloatArray
    odometry_y: FloatArray
    odometry_yaw: FloatArray
    goal: npt.NDArray[np.int64]
    path: npt.NDArray[np.int64]
    estimate_x: FloatArray = field(default_factory=_not_given)
    estimate_y: FloatArray = field(default_factory=_not_given)
    estimate_yaw: FloatArray = field(default_factory=_not_given)
    localization: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __post_init__(self) -> None:
        for name in _ESTIMATES:
            if len(getattr(self, name)) == 0:
                object.__setattr__(self, name, getattr(self, name.removeprefix("estimate_")))
        if len(self.localization) == 0:
            object.__setattr__(self, "localization", np.zeros(len(self.time), dtype=np.int64))
        for name in self.columns():
            kind = np.int64 if name in _WHOLE else np.float64
            array = as_array(getattr(self, name), kind, f"{name} of a trajectory")
            if array.ndim != 1 or len(array) == 0 or not np.isfinite(array).all():
                raise InputError(f"a trajectory needs finite numbers of shape (N,) with N ≥ 1; {name} is not that")
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if not np.isin(self.localization, range(len(LOCALIZATION_STATES))).all():
            raise InputError(f"localization of a trajectory must be 0 to {len(LOCALIZATION_STATES) - 1}")
        if len({len(getattr(self, name)) for name in self.columns()}) != 1:
            raise InputError("a trajectory needs all its arrays to be of one length")

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """Return names of the arrays."""
        return tuple(column.name for column in fields(cls))

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        return f"Trajectory({len(self)} rows, {self.time[0]:g} to {self.time[-1]:g} s)"

    @property
    def poses(self) -> FloatArray:
        """(x, y, yaw), shape (N, 3)."""
        return np.column_stack([self.x, self.y, self.yaw])

    @property
    def estimates(self) -> FloatArray:
        """Estimated (x, y, yaw), shape (N, 3)."""
        return np.column_stack([self.estimate_x, self.estimate_y, self.estimate_yaw])

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with a column for each array and a row for each control period.

        Raises:
            MissingExtraError: If pandas is not installed.
        """
        try:
            import pandas  # pyright: ignore[reportMissingImports] - an extra
        except ImportError as error:
            raise missing_extra("a table of a trajectory", "pandas", "pandas") from error
        return pandas.DataFrame({name: getattr(self, name) for name in self.columns()})

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an .npz of these arrays.

        Raises:
            OutputError: If it cannot be written; nothing is left behind.
        """
        write_arrays(path, {name: getattr(self, name) for name in self.columns()})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Read what `save` wrote. A file of an older version has no estimates: the true poses stand for them.

        Raises:
            InputError: If the file cannot be read, or is not a trajectory.
        """
        arrays, _ = read_arrays(path, cls.columns(), error=InputError)
        missing = [name for name in cls.columns() if name not in arrays and name not in _ADDED]
        if missing:
            raise InputError(
                f"{os.fspath(path)}: not a trajectory: it has no {', '.join(missing)}; give the trajectory.npz of a run"
            )
        try:
            return cls(**arrays)
        except InputError as error:
            raise InputError(f"{os.fspath(path)}: {error}") from error
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"{os.fspath(path)}: its arrays are no numbers: {error}") from error


def write_arrays(path: str | os.PathLike[str], arrays: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write arrays by name as an .npz, whole and durably.

    Raises:
        OutputError: If it cannot be written; nothing is left behind.
    """
    content = io.BytesIO()
    np.savez_compressed(content, **dict[str, Any](arrays))
    write_bytes(path, content.getvalue(), durable=True)
