"""`TransformTree`: the poses of frames over time, from the transforms of a bag."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from trundle.geometry import FloatArray


@dataclass(slots=True, eq=False)
class _Edge:
    """Pose of a frame in its parent, over time or for good."""

    parent: str
    is_static: bool
    times: list[float] = field(default_factory=list[float])
    matrices: list[FloatArray] = field(default_factory=list[FloatArray])


class TransformTree:
    """Frames with their parents, as tf2's buffer has them, but for all of a recording."""

    def __init__(self) -> None:
        self._edges: dict[str, _Edge] = {}

    def add(self, parent: str, child: str, time: float, matrix: FloatArray, *, is_static: bool) -> None:
        """Add the pose of `child` in `parent` at a time [s], shape (4, 4)."""
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent or edge.is_static != is_static:
            edge = self._edges[child] = _Edge(parent, is_static)
        if is_static:
            edge.times, edge.matrices = [time], [matrix]
        else:
            edge.times.append(time)
            edge.matrices.append(matrix)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of all frames, sorted."""
        return tuple(sorted({*self._edges, *(edge.parent for edge in self._edges.values())}))

    def chain(self, frame: str, ancestor: str) -> list[str] | None:
        """Return the frames from `frame` up to, and without, `ancestor`; None where it is not above it."""
        found: list[str] = []
        while frame != ancestor:
            edge = self._edges.get(frame)
            if edge is None or frame in found:
                return None
            found.append(frame)
            frame = edge.parent
        return found

    def chain_to_root(self, frame: str) -> list[str]:
        """Return a frame and all frames above it, upwards."""
        found = [frame]
        while (edge := self._edges.get(found[-1])) is not None and edge.parent not in found:
            found.append(edge.parent)
        return found

    def times(self, frame: str) -> FloatArray:
        """Return the times [s] at which a frame's pose in its parent was sent, increasing; empty if it is static."""
        edge = self._edges[frame]
        return np.zeros(0) if edge.is_static else np.unique(np.array(edge.times))

    def poses(self, frame: str, ancestor: str, times: FloatArray) -> FloatArray:
        """Return poses (x, y, yaw) of a frame in one above it at some times [s], interpolated; shape (N, 3).

        Before the first and after the last transform the nearest one holds.
        """
        chain = self.chain(frame, ancestor)
        if chain is None:
            raise KeyError(frame)
        found = np.zeros((len(times), 3))
        for child in chain:
            found = _compose(self._edge_poses(self._edges[child], times), found)
        return found

    def static(self, frame: str, ancestor: str) -> FloatArray | None:
        """Return the pose of a frame that is fixed to one above it, shape (4, 4); None where it is not."""
        chain = self.chain(frame, ancestor)
        if chain is None:
            return None
        found = np.eye(4)
        for child in chain:
            edge = self._edges[child]
            if not edge.is_static and np.ptp(edge.matrices, axis=0).max() > 1e-6:
                return None
            found = edge.matrices[-1] @ found
        return found

    def _edge_poses(self, edge: _Edge, times: FloatArray) -> FloatArray:
        matrices = np.array(edge.matrices)
        stamps, first = np.unique(np.array(edge.times), return_index=True)
        matrices = matrices[first]
        yaw = np.unwrap(np.arctan2(matrices[:, 1, 0], matrices[:, 0, 0]))
        columns = (matrices[:, 0, 3], matrices[:, 1, 3], yaw)
        return np.column_stack([np.interp(times, stamps, column) for column in columns])


def _compose(outer: FloatArray, inner: FloatArray) -> FloatArray:
    """Return poses `outer @ inner`, row by row, shape (N, 3)."""
    cos, sin = np.cos(outer[:, 2]), np.sin(outer[:, 2])
    return np.column_stack(
        [
            outer[:, 0] + cos * inner[:, 0] - sin * inner[:, 1],
            outer[:, 1] + sin * inner[:, 0] + cos * inner[:, 1],
            outer[:, 2] + inner[:, 2],
        ]
    )
