"""`Beliefs`: what the localizer of a bag believed, at the times of its rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle.bags.bag_content import BagContent
from trundle.bags.bag_rows import Rows
from trundle.geometry import Pose2D
from trundle.observation import LOCALIZATION_STATES, Estimate

_Known = TypeVar("_Known")


class Beliefs:
    """Makes the estimates of the rows of a bag: pose by its transforms, the rest as it was known last.

    Args:
        content: The bag's content.
        rows: Its rows.

    Attributes:
        states: Index in `LOCALIZATION_STATES` at each row, shape (N,).
        has_localizer: Whether the bag has anything of a localizer.
    """

    def __init__(self, content: BagContent, rows: Rows) -> None:
        self._rows = rows
        self._covariances = _at(rows, content.covariances)
        self._particles = _at(rows, content.particles)
        said = self._said = _at(rows, content.states)
        states = [0 if one is None else LOCALIZATION_STATES.index(one[0]) for one in said]
        self.states: npt.NDArray[np.int64] = np.array(states, dtype=np.int64)
        self.has_localizer = bool(content.covariances or content.particles or content.states)

    def at(self, index: int, time: float, pose: Pose2D, odometry: Pose2D) -> Estimate:
        """Return the estimate of a row."""
        said = self._said[index]
        return Estimate(
            time,
            pose,
            self._covariances[index],
            pose @ odometry.inverse(),
            LOCALIZATION_STATES[self.states[index]],
            () if said is None else said[1],
            self._particles[index],
        )


def _at(rows: Rows, known: Sequence[tuple[float, _Known]]) -> list[_Known | None]:
    """Return what was known last at each row, or None before there was anything."""
    times = np.array([time for time, _ in known]) - rows.began
    last = np.searchsorted(times, rows.times + 1e-6, side="right") - 1
    return [known[index][1] if index >= 0 else None for index in last.tolist()]
