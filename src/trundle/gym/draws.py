"""Random numbers that depend on a robot's seed, its episode and what they are for, and on nothing else."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Keys = npt.NDArray[np.uint64]


def mix(values: Keys) -> Keys:
    """Hash 64-bit numbers (splitmix64: Steele, Lea and Flood 2014)."""
    with np.errstate(over="ignore"):
        z = values * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def episode_keys(seeds: Keys, episodes: npt.NDArray[np.int64], split: int) -> Keys:
    """Return a number for each episode of each robot."""
    with np.errstate(over="ignore"):
        return mix(mix(seeds + np.uint64(1)) + mix(episodes.astype(np.uint64) + np.uint64(1 + split * 2**40)))


def uniform(keys: Keys, stream: int) -> npt.NDArray[np.float64]:
    """Return a number from 0 up to 1 for each key; another one for each stream."""
    with np.errstate(over="ignore"):
        bits = mix(keys + np.uint64(0xD1B54A32D192ED03) * np.uint64(stream + 1))
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53
