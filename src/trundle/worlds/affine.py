"""Affine transforms of shapes: rotations keep a shape's kind, scales too where possible; shears make it a mesh."""

from __future__ import annotations

import math

import numpy as np

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Sphere
from trundle.worlds.tessellate import as_mesh

ALIKE = 1e-6
"""Relative tolerance for equal scales and orthogonal columns: the accuracy of single precision."""


class FlattenedError(WorldError):
    """A shape that a scale of 0 has flattened to no area."""


def split(matrix: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Split a linear map into a rotation and scales along its own axes, `matrix = rotation @ diag(scales)`.

    Args:
        matrix: Shape (3, 3).

    Returns:
        A proper rotation, shape (3, 3), and the scales, shape (3,), of which the last is negative for a mirror; None
        if the map shears or flattens, because no such split exists.
    """
    lengths = np.sqrt((matrix**2).sum(axis=0))
    if lengths.min() <= ALIKE * lengths.max():
        return None
    rotation = matrix / lengths
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > ALIKE:
        return None
    if np.linalg.det(rotation) < 0.0:
        rotation[:, 2] = -rotation[:, 2]
        lengths[2] = -lengths[2]
    return rotation, lengths


def pose_of(position: FloatArray, rotation: FloatArray) -> Pose3D:
    """Return the pose with a position [m], shape (3,), and a rotation matrix, shape (3, 3)."""
    # Shepperd, Quaternion from Rotation Matrix (1978): the largest of the four components is taken from the diagonal,
    # so that nothing cancels.
    diagonal = np.array([np.trace(rotation), *np.diag(rotation)])
    largest = int(diagonal.argmax())
    skew = [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    if largest == 0:
        quaternion = [1.0 + diagonal[0], *skew]
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        quaternion = [0.0, 0.0, 0.0, 0.0]
        quaternion[0] = skew[i]
        quaternion[1 + i] = 1.0 + 2.0 * rotation[i, i] - diagonal[0]
        quaternion[1 + j] = rotation[j, i] + rotation[i, j]
        quaternion[1 + k] = rotation[k, i] + rotation[i, k]
    w, x, y, z = (float(number) for number in quaternion)
    px, py, pz = (float(number) for number in position)
    return Pose3D((px, py, pz), (w, x, y, z))


def place(shape: Box | Cylinder | Sphere | Mesh, matrix: FloatArray) -> tuple[Box | Cylinder | Sphere | Mesh, Pose3D]:
    """Transform a shape by an affine map.

    Args:
        shape: The shape, in its own frame.
        matrix: From that frame to the map frame [m], acting on columns, shape (4, 4).

    Returns:
        The same kind of shape if possible, otherwise a mesh, and its pose. A mirrored mesh keeps its faces
        outwards.

    Raises:
        FlattenedError: If the result has no area.
    """
    linear, position = matrix[:3, :3], matrix[:3, 3]
    parts = split(linear)
    if parts is None:
        return _place_sheared(shape, linear, position)
    rotation, scales = parts
    pose = pose_of(position, rotation)
    x, y, z = (abs(float(scale)) for scale in scales)
    match shape:
        case Box(size):
            return Box((size[0] * x, size[1] * y, size[2] * z)), pose
        case Sphere(radius) if _alike(x, y) and _alike(y, z):
            return Sphere(radius * (x + y + z) / 3.0), pose
        case Cylinder(radius, length) if _alike(x, y):
            return Cylinder(radius * (x + y) / 2.0, length * z), pose
        case Mesh() as mesh:
            return scale_mesh(mesh, scales), pose
    return scale_mesh(as_mesh(shape), scales), pose


def scale_mesh(mesh: Mesh, scales: FloatArray) -> Mesh:
    """Scale a mesh along its axes; faces still point outwards if an odd number of scales is negative."""
    if np.abs(scales - 1.0).max() < 1e-12:
        return mesh
    faces = mesh.faces[:, ::-1] if scales.prod() < 0.0 else mesh.faces
    return Mesh(mesh.vertices * scales, faces)


def _place_sheared(
    shape: Box | Cylinder | Sphere | Mesh, linear: FloatArray, position: FloatArray
) -> tuple[Mesh, Pose3D]:
    mesh = as_mesh(shape)
    vertices = mesh.vertices @ linear.T
    corners = vertices[mesh.faces]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    extent = float(np.ptp(vertices, axis=0).max())
    if not doubled.max() > 1e-12 * max(extent, 1e-150) ** 2:
        raise FlattenedError("its scale of 0 flattens it")
    faces = mesh.faces[:, ::-1] if np.linalg.det(linear) < 0.0 else mesh.faces
    x, y, z = (float(number) for number in position)
    return Mesh(vertices, faces), Pose3D((x, y, z))


def _alike(first: float, second: float) -> bool:
    return math.isclose(first, second, rel_tol=ALIKE)
