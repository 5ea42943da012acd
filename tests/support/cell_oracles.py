"""Slow and plain versions of the kernels that go from cell to cell."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def gaps_by_hand(blocked: npt.NDArray[np.uint8], limit: float) -> npt.NDArray[np.uint8]:
    """What `mark_gaps` marks: short runs of open cells, blocked at both ends, in four directions."""
    rows, cols = blocked.shape
    padded = np.pad(blocked, 1, constant_values=1)
    marks = np.zeros_like(padded)
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for row in range(1, rows + 1):
            for col in range(1, cols + 1):
                if padded[row, col] or not padded[row - down, col - right]:
                    continue
                cells = []
                while not padded[row + down * len(cells), col + right * len(cells)]:
                    cells.append((row + down * len(cells), col + right * len(cells)))
                if len(cells) * np.hypot(down, right) < limit:
                    for cell in cells:
                        marks[cell] = 1
    return marks[1:-1, 1:-1]


def unfilter_by_hand(lines: npt.NDArray[np.uint8], step: int) -> npt.NDArray[np.uint8]:
    """What `png_unfilter` undoes, byte by byte as the PNG specification writes it (section 9)."""
    out = np.zeros((len(lines), lines.shape[1] - 1), dtype=np.uint8)
    for row, (kind, *differences) in enumerate(lines.tolist()):
        for col, difference in enumerate(differences):
            left = int(out[row, col - step]) if col >= step else 0
            up = int(out[row - 1, col]) if row else 0
            corner = int(out[row - 1, col - step]) if row and col >= step else 0
            estimate = left + up - corner
            paeth = min((left, up, corner), key=lambda value: abs(estimate - value))
            guess = (0, left, up, (left + up) // 2, paeth)[kind]
            out[row, col] = (difference + guess) % 256
    return out
