"""The eight orientations of an image: turned by quarters, and flipped."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle.maps.check.finding import Kind

ScalarT = TypeVar("ScalarT", bound=np.generic)


@dataclass(frozen=True, slots=True)
class Orientation:
    """The correction of an image: flipped first (top and bottom exchanged) or not, then turned counter-clockwise.

    Attributes:
        flipped: Whether top and bottom are exchanged first.
        turns: Quarter turns, 0 to 3.
    """

    flipped: bool
    turns: int

    def apply(self, cells: np.ndarray[tuple[int, int], np.dtype[ScalarT]]) -> npt.NDArray[ScalarT]:
        """Apply the correction to cells, row 0 at the bottom."""
        return np.rot90(cells[::-1] if self.flipped else cells, -self.turns)

    def undo(self, cells: np.ndarray[tuple[int, int], np.dtype[ScalarT]]) -> npt.NDArray[ScalarT]:
        """Undo the correction."""
        turned = np.rot90(cells, self.turns)
        return turned[::-1] if self.flipped else turned

    def move(
        self, rows: npt.NDArray[np.int64], cols: npt.NDArray[np.int64], shape: tuple[int, int]
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Where cells of a grid of a shape come to lie."""
        if self.flipped:
            rows = shape[0] - 1 - rows
        height, width = shape
        for _ in range(self.turns):
            rows, cols = cols, height - 1 - rows
            height, width = width, height
        return rows, cols

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """What is wrong with an image that needs this."""
        if self.flipped:
            return ("flipped",) if self.turns % 2 == 0 else ("flipped", "rotated")
        return ("rotated",) if self.turns else ()

    @property
    def yaw(self) -> float:
        """Yaw [rad] of the origin that does the same as the turns."""
        return math.remainder(self.turns * math.pi / 2.0, 2.0 * math.pi)

    def describe(self) -> str:
        """What is wrong with an image that needs this."""
        if self.flipped:
            return {
                0: "flipped: top and bottom are exchanged",
                2: "flipped: left and right are exchanged",
                1: "flipped along a diagonal: mirrored and turned by 90°",
                3: "flipped along a diagonal: mirrored and turned by 270°",
            }[self.turns]
        return f"rotated: it must be turned by {90 * self.turns}° counter-clockwise"


UPRIGHT = Orientation(flipped=False, turns=0)
ORIENTATIONS = tuple(Orientation(flipped, turns) for flipped in (False, True) for turns in range(4))
