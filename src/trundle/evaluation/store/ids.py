"""`IdSet`: the ids of a million rows in a few megabytes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from trundle.evaluation.store.columns import to_key

Keys = NDArray[np.uint64]

_RECENT = 1 << 16


class IdSet:
    """A set of ids, kept as numbers of 64 bits.

    Args:
        keys: The ids to start with.
    """

    def __init__(self, keys: Keys) -> None:
        self._sorted: Keys = np.unique(keys)
        self._recent: set[int] = set()

    def add(self, identity: str) -> bool:
        """Add an id.

        Returns:
            Whether it was new.
        """
        key = to_key(identity)
        if key in self._recent or self._is_old(key):
            return False
        self._recent.add(key)
        if len(self._recent) >= _RECENT:
            self._sorted = np.union1d(self._sorted, np.fromiter(self._recent, np.uint64, len(self._recent)))
            self._recent = set()
        return True

    def contains(self, keys: Keys) -> NDArray[np.bool_]:
        """Which of these are in the set."""
        recent = np.fromiter(self._recent, np.uint64, len(self._recent))
        return np.isin(keys, self._sorted) | np.isin(keys, recent)

    def __contains__(self, identity: str) -> bool:
        key = to_key(identity)
        return key in self._recent or self._is_old(key)

    def __len__(self) -> int:
        return len(self._sorted) + len(self._recent)

    def _is_old(self, key: int) -> bool:
        wanted = np.uint64(key)
        place = int(np.searchsorted(self._sorted, wanted))
        return place < len(self._sorted) and self._sorted[place] == wanted
