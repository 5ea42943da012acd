"""`Arrays`: what NumPy and PyTorch call differently, and random numbers that are the same in both."""

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


# Random numbers depend on a robot's seed, its episode and what they are for, and on nothing else. They are computed in
# int64, which wraps: PyTorch has no arithmetic of uint64.


def mix(values: Any) -> Any:
    """Hash 64-bit numbers, an int64 array (splitmix64: Steele, Lea and Flood 2014)."""
    z = values * _signed(0x9E3779B97F4A7C15)
    z = (z ^ _shifted(z, 30)) * _signed(0xBF58476D1CE4E5B9)
    z = (z ^ _shifted(z, 27)) * _signed(0x94D049BB133111EB)
    return z ^ _shifted(z, 31)


def seed_keys(seeds: Any) -> Any:
    """Return a number for each seed, for `episode_keys`; int64 arrays."""
    return mix(seeds + 1)


def episode_keys(keys: Any, episodes: Any, split: int) -> Any:
    """Return a number for each episode of each robot, of the numbers of their seeds; int64 arrays."""
    return mix(keys + mix(episodes + (1 + split * 2**40)))


def uniform(arrays: Arrays, keys: Any, streams: Any) -> Any:
    """Return numbers from 0 up to 1 for each key, float64, shape (streams, keys); other ones for each stream.

    Args:
        arrays: The arrays of the device.
        keys: int64.
        streams: int64, of the device; see `stream_numbers`.
    """
    bits = mix(keys + streams[:, None])
    return arrays.cast(_shifted(bits, 11), "float64") * 2.0**-53


def stream_numbers(*streams: int) -> npt.NDArray[np.int64]:
    """Return what `uniform` adds to keys for these streams."""
    return np.array([_signed(0xD1B54A32D192ED03 * (stream + 1)) for stream in streams])


def _signed(number: int) -> int:
    """Return the int64 that has the 64 lowest bits of a number."""
    return (number + 2**63) % 2**64 - 2**63


def _shifted(values: Any, bits: int) -> Any:
    """Shift to the right and fill up with zeros; on an int64 `>>` fills up with the sign."""
    return (values >> bits) & (2 ** (64 - bits) - 1)
