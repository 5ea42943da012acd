"""`SampleHistory`: the best samples of a run's controller, kept small, for the drawn video."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.control.controller import Rollouts

Samples: TypeAlias = npt.NDArray[np.float32]
"""Places (x, y) [m], map frame, shape (N, T, 2), of N samples."""

LINES = 12
"""How many samples are kept of a step."""
_POINTS = 15  # of each sample, about


class SampleHistory:
    """Collects what a controller considered best in each step; nothing for steps without samples.

    A step takes about 1.5 kB.
    """

    def __init__(self) -> None:
        self._steps: dict[int, Samples] = {}

    def __len__(self) -> int:
        return len(self._steps)

    def add(self, index: int, rollouts: Rollouts | None) -> None:
        """Add the samples of a step, by its index; step 0 begins another run."""
        if index == 0:
            self._steps.clear()
        if rollouts is None:
            return
        stride = max(1, rollouts.poses.shape[1] // _POINTS)
        self._steps[index] = rollouts.poses[:LINES, ::stride, :2].astype(np.float32)

    def at(self, index: int) -> Samples | None:
        """The samples of a step, the best first; none where it had none."""
        return self._steps.get(index)
