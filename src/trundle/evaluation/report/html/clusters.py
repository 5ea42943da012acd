"""Failures in clusters: places where episodes failed within 2 m of each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

RADIUS = 2.0
_CELL = 0.5
"""Failures in one square of this side [m] are taken together, so that thousands of them are quick."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """Failures near each other.

    Attributes:
        center: Their mean [m, m].
        members: Their numbers among the given points, in order; the first is nearest to the centre.
    """

    center: tuple[float, float]
    members: tuple[int, ...]


def find_clusters(points: npt.ArrayLike) -> list[Cluster]:
    """Cluster points [m], shape (N, 2): the largest cluster first.

    The densest place comes first and takes all within 2 m of it, then the densest of the rest, and so on. Then clusters
    whose centres are within 2 m of each other are merged, so that no cluster is split by where the squares begin.
    """
    where = np.asarray(points, dtype=float).reshape(-1, 2)
    if len(where) == 0:
        return []
    _, cell = np.unique(np.floor(where / _CELL).astype(np.int64), axis=0, return_inverse=True)
    counts = np.bincount(cell)
    means = _means(where, cell, counts)
    label = _merge(means, counts, _gather(means, counts))
    of_point = label[cell]
    clusters: list[Cluster] = []
    for number in np.unique(of_point):
        members = np.flatnonzero(of_point == number)
        center = where[members].mean(axis=0)
        nearest = int(np.argmin(((where[members] - center) ** 2).sum(axis=1)))
        order = [int(members[nearest]), *(int(member) for member in np.delete(members, nearest))]
        clusters.append(Cluster((float(center[0]), float(center[1])), tuple(order)))
    return sorted(clusters, key=lambda cluster: (-len(cluster.members), min(cluster.members)))


def _means(points: FloatArray, label: npt.NDArray[np.intp], weights: npt.NDArray) -> FloatArray:
    return np.stack([np.bincount(label, points[:, axis]) for axis in (0, 1)], axis=1) / weights[:, None]


def _gather(means: FloatArray, counts: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """The cluster of each square: that of the densest place within reach."""
    n = len(means)
    label = np.full(n, -1)
    near = [np.flatnonzero(((means - mean) ** 2).sum(axis=1) <= RADIUS**2) for mean in means]
    density = np.array([counts[close].sum() for close in near])
    number = 0
    while (label < 0).any():
        seed = int(np.argmax(density))
        taken = near[seed][label[near[seed]] < 0]
        label[taken] = number
        number += 1
        for square in taken:
            density[near[square]] -= counts[square]
        density[label >= 0] = -1
    return label


def _merge(means: FloatArray, counts: npt.NDArray[np.intp], label: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Merge the two nearest clusters until all centres are more than 2 m apart."""
    while True:
        weights = np.bincount(label, counts)
        sums = np.stack([np.bincount(label, counts * means[:, axis]) for axis in (0, 1)], axis=1)
        centers = sums / weights[:, None]
        nearest = np.full(len(centers), -1)
        for number, center in enumerate(centers):
            distance = ((centers - center) ** 2).sum(axis=1)
            distance[number] = np.inf
            other = int(np.argmin(distance))
            if distance[other] <= RADIUS**2:
                nearest[number] = other
        mutual = [one for one, other in enumerate(nearest) if other > one and nearest[other] == one]
        if not mutual:
            return label
        target = np.arange(len(centers))
        target[nearest[mutual]] = mutual
        label = np.unique(target[label], return_inverse=True)[1]
