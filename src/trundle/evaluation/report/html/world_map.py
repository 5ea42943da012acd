"""The map of a world in a page, with a frame that places marks on it; and the clusters of failures that are marked."""

from __future__ import annotations

import base64
import io
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PIL import Image

from trundle.geometry import FloatArray
from trundle.maps.cells import OCCUPIED
from trundle.maps.grid import OccupancyGrid
from trundle.pictures.cells import merge_cells
from trundle.pictures.colors import occupancy_palette

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
    """Return the cluster of each square: that of the densest place within reach."""
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


LONGEST = 1000.0
"""Longer side of a map's drawing, in its own units."""
_MOST_PIXELS = 900
_MOST_BYTES = 40_000
_GREYS = 7
_UNKNOWN = 255


@dataclass(frozen=True, slots=True)
class Frame:
    """The place of a drawing in the map frame.

    Attributes:
        left: Least x [m].
        top: Largest y [m].
        scale: Units per metre.
        width: Width of the drawing, in units.
        height: Height of the drawing, in units.
    """

    left: float
    top: float
    scale: float
    width: float
    height: float

    @classmethod
    def around(cls, points: npt.ArrayLike, margin: float = 0.0) -> Frame:
        """Return the frame that holds points [m], shape (N, 2), with a margin [m]."""
        where = np.asarray(points, dtype=float).reshape(-1, 2)
        low, high = where.min(axis=0) - margin, where.max(axis=0) + margin
        sides = np.maximum(high - low, 1.0)
        scale = LONGEST / float(sides.max())
        return cls(float(low[0]), float(high[1]), scale, float(sides[0]) * scale, float(sides[1]) * scale)

    def x(self, x: float) -> float:
        """Return the distance of x [m] from the left edge of the drawing, in its units."""
        return (x - self.left) * self.scale

    def y(self, y: float) -> float:
        """Return the distance of y [m] from the top of the drawing, in its units."""
        return (self.top - y) * self.scale


@dataclass(frozen=True, slots=True)
class WorldMap:
    """A map as a picture.

    Attributes:
        frame: Where the map frame's points lie.
        png: The picture.
        size: Its pixels, (columns, rows).
        matrix: From pixels to units, as in SVG.
    """

    frame: Frame
    png: bytes
    size: tuple[int, int]
    matrix: tuple[float, float, float, float, float, float]

    def image(self, name: str) -> str:
        """Return the picture as an SVG element with this id."""
        data = base64.b64encode(self.png).decode()
        matrix = " ".join(f"{value:.6g}" for value in self.matrix)
        return (
            f'<image id="{name}" class="map" width="{self.size[0]}" height="{self.size[1]}" '
            f'transform="matrix({matrix})" href="data:image/png;base64,{data}"/>'
        )


def draw_map(grid: OccupancyGrid, most_bytes: int = _MOST_BYTES) -> WorldMap:
    """Draw a map in few greys and at most 900 pixels; coarser where it would be more than `most_bytes`.

    A square of cells that becomes one pixel is occupied where one of them is, so that no wall is lost.
    """
    factor = max(1, math.ceil(max(grid.shape) / _MOST_PIXELS))
    while True:
        png, size = _encode(grid, factor)
        if len(png) <= most_bytes or max(size) <= 64:
            break
        factor = math.ceil(factor * 1.5)
    rows, cols = grid.shape
    yaw, edge = grid.origin.yaw, grid.resolution
    cos, sin = math.cos(yaw), math.sin(yaw)
    corners = np.array([[0.0, 0.0], [cols, 0.0], [cols, rows], [0.0, rows]]) * edge
    frame = Frame.around(corners @ np.array([[cos, sin], [-sin, cos]]) + [grid.origin.x, grid.origin.y])
    high = size[1] * factor * edge
    step = factor * edge * frame.scale
    left, top = grid.origin.x - sin * high, grid.origin.y + cos * high
    matrix = (cos * step, -sin * step, sin * step, cos * step, frame.x(left), frame.y(top))
    return WorldMap(frame, png, size, matrix)


def _encode(grid: OccupancyGrid, factor: int) -> tuple[bytes, tuple[int, int]]:
    """Return the cells as a PNG of eight greys, and its columns and rows."""
    order = np.array([*range(OCCUPIED), *range(OCCUPIED + 1, 256), OCCUPIED], dtype=np.uint8)
    ranks = np.empty(256, np.uint8)
    ranks[order] = np.arange(256, dtype=np.uint8)
    values = order[merge_cells(ranks, grid.data.view(np.uint8), factor)][::-1]
    grey = np.full(256, _GREYS, np.uint8)
    grey[: OCCUPIED + 1] = np.rint(np.arange(OCCUPIED + 1) / OCCUPIED * (_GREYS - 1))
    palette = occupancy_palette()
    steps = [palette[round(OCCUPIED * step / (_GREYS - 1))] for step in range(_GREYS)]
    image = Image.fromarray(np.ascontiguousarray(grey[values]), "L")
    image = _paletted(image, [*steps, palette[_UNKNOWN]])
    stream = io.BytesIO()
    image.save(stream, "PNG", optimize=True, bits=4)
    return stream.getvalue(), (values.shape[1], values.shape[0])


def _paletted(indices: Image.Image, colors: list[npt.NDArray[np.uint8]]) -> Image.Image:
    image = Image.frombytes("P", indices.size, indices.tobytes())
    image.putpalette(np.stack(colors).tobytes())
    return image
