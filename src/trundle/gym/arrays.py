"""`Arrays`: what NumPy and PyTorch call differently, so that an environment's step is written once for both."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


class Arrays:
    """NumPy's arrays, on the host. `lib` has the functions that both libraries have under one name."""

    lib: Any = np
    on_host = True

    def put(self, values: Any) -> Any:
        """Return values of the host as an array of the device."""
        return np.asarray(values)

    def host(self, values: Any) -> npt.NDArray[Any]:
        """Return an array of the device as one of the host."""
        return values

    def cast(self, values: Any, kind: str) -> Any:
        """Return an array with another type of numbers; itself if it has that type."""
        return values.astype(kind, copy=False)

    def copy(self, values: Any) -> Any:
        """Return a copy of an array."""
        return values.copy()

    def full(self, shape: int | tuple[int, ...], value: float, kind: str = "float64") -> Any:
        """Return an array of one value."""
        return np.full(shape, value, dtype=kind)

    def indices(self, mask: Any) -> Any:
        """Return where a mask is true, shape (n,); the host waits for their number."""
        return mask.nonzero()[0]

    def columns(self, *parts: Any, kind: str = "float64") -> Any:
        """Return arrays of shape (n,) as columns, numbers of one type."""
        out = np.empty((len(parts[0]), len(parts)), dtype=kind)  # np.stack takes five times as long for one robot
        for column, part in enumerate(parts):
            out[:, column] = part
        return out

    def clip(self, values: Any, low: Any, high: Any) -> Any:
        """Return values cut off at two bounds, both numbers or both arrays."""
        return np.minimum(np.maximum(values, low), high)  # np.clip takes three times as long for one robot


HOST = Arrays()
