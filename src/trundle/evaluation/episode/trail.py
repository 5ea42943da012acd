"""Where a robot drove, in few points."""

from __future__ import annotations

import heapq

import numpy as np

from trundle.geometry import FloatArray

MOST_POINTS = 64
_CLOSE_M = 0.01


def simplify(points: FloatArray, most: int = MOST_POINTS) -> tuple[float, ...]:
    """Few points of a line from which all others are near; those that are farthest off come first.

    Args:
        points: (x, y) [m], shape (N, 2), N ≥ 1.
        most: How many points to keep at most.

    Returns:
        x0, y0, x1, y1, … [m], rounded to 1 cm, with both ends.
    """
    last = len(points) - 1
    kept = {0, last}
    parts = [_farthest(points, 0, last)]
    while parts and len(kept) < most:
        gap, first, split, end = heapq.heappop(parts)
        if -gap <= _CLOSE_M:
            break
        kept.add(split)
        heapq.heappush(parts, _farthest(points, first, split))
        heapq.heappush(parts, _farthest(points, split, end))
    return tuple(float(number) for number in np.round(points[sorted(kept)], 2).ravel())


def _farthest(points: FloatArray, first: int, last: int) -> tuple[float, int, int, int]:
    """The point that is farthest from the straight line between two: minus its distance, and the three numbers."""
    if last - first < 2:
        return 0.0, first, first, last
    start, along = points[first], points[last] - points[first]
    offsets = points[first + 1 : last] - start
    squared = float(along @ along)
    share = np.clip(offsets @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(offsets))
    gaps = np.hypot(*(offsets - share[:, None] * along).T)
    split = int(gaps.argmax())
    return -float(gaps[split]), first, first + 1 + split, last
