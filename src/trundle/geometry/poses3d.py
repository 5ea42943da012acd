"""`Pose3D`: a pose in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry.poses import FloatArray, exactly
from trundle.values import as_array


@dataclass(frozen=True, slots=True)
class Pose3D:
    """A pose in space: position [m] and unit quaternion (w, x, y, z).

    Raises:
        InputError: If a number is NaN or infinite, or the quaternion is zero.
    """

    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        x, y, z = exactly(self.position, 3, "a position")
        qw, qx, qy, qz = exactly(self.quaternion, 4, "a quaternion")
        norm = math.sqrt(qw * qw + qx * qx + qy * qy + qz * qz)
        if not (math.isfinite(x + y + z) and math.isfinite(norm) and norm > 1e-12):
            raise InputError(f"not a pose: position {self.position}, quaternion {self.quaternion}")
        object.__setattr__(self, "position", (x, y, z))
        object.__setattr__(self, "quaternion", (qw / norm, qx / norm, qy / norm, qz / norm))

    @classmethod
    def planar(cls, x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> Pose3D:
        """Make an upright pose at (x, y, z) [m], turned by yaw [rad]."""
        return cls((x, y, z), (math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0)))

    @classmethod
    def from_rpy(cls, position: Sequence[float], rpy: Sequence[float]) -> Pose3D:
        """Make a pose turned by roll, pitch and yaw [rad] about the fixed x, y and z axes, in this order."""
        x, y, z = exactly(position, 3, "a position")
        angles = exactly(rpy, 3, "roll, pitch and yaw")
        (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle / 2.0), math.sin(angle / 2.0)) for angle in angles)
        quaternion = (
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )
        return cls((x, y, z), quaternion)

    @classmethod
    def from_matrix(cls, matrix: npt.ArrayLike) -> Pose3D:
        """Make a pose from a rigid transform, shape (4, 4); its rotation must be one (no scale, no mirror)."""
        m = as_array(matrix, np.float64, "a matrix", copy=False)
        if m.shape != (4, 4):
            raise InputError(f"a transform is a matrix of shape (4, 4), got {m.shape}")
        trace = (m[0, 0], m[1, 1], m[2, 2])
        # The largest of the four components first, to avoid dividing by a small number (Shepperd, 1978).
        squares = np.array(
            [
                1.0 + trace[0] + trace[1] + trace[2],
                1.0 + trace[0] - trace[1] - trace[2],
                1.0 - trace[0] + trace[1] - trace[2],
                1.0 - trace[0] - trace[1] + trace[2],
            ]
        )
        rows = np.array(
            [
                [squares[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
                [m[2, 1] - m[1, 2], squares[1], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
                [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], squares[2], m[1, 2] + m[2, 1]],
                [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[3]],
            ]
        )
        w, x, y, z = rows[int(np.argmax(squares))].tolist()
        px, py, pz = m[:3, 3].tolist()
        return cls((px, py, pz), (w, x, y, z))

    def __matmul__(self, other: Pose3D) -> Pose3D:
        """Compose: `T_a_c = T_a_b @ T_b_c`."""
        w1, x1, y1, z1 = self.quaternion
        w2, x2, y2, z2 = other.quaternion
        x, y, z = self.transform_points([other.position])[0].tolist()
        return Pose3D(
            (x, y, z),
            (
                w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
                w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
                w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
                w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
            ),
        )

    def inverse(self) -> Pose3D:
        """Return `T_b_a` of `T_a_b`."""
        w, x, y, z = self.quaternion
        turned = Pose3D((0.0, 0.0, 0.0), (w, -x, -y, -z))
        px, py, pz = (-turned.transform_points([self.position])[0]).tolist()
        return Pose3D((px, py, pz), turned.quaternion)

    def rotation(self) -> FloatArray:
        """Return the rotation matrix, shape (3, 3)."""
        w, x, y, z = self.quaternion
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )

    def transform_points(self, points: npt.ArrayLike) -> FloatArray:
        """Transform points [m], shape (N, 3), from this pose's frame to the frame it is given in."""
        return as_array(points, np.float64, "points", copy=False) @ self.rotation().T + np.asarray(self.position)

    def is_upright(self, tolerance: float = 1e-9) -> bool:
        """Return whether the pose only turns about z."""
        _, x, y, _ = self.quaternion
        return x * x + y * y <= tolerance * tolerance

    def yaw(self) -> float:
        """Return the yaw [rad] of the x axis seen from above."""
        w, x, y, z = self.quaternion
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def rotation_matrices(quaternions: npt.ArrayLike) -> FloatArray:
    """Return rotation matrices, shape (N, 3, 3), of unit quaternions (w, x, y, z), shape (N, 4)."""
    w, x, y, z = np.asarray(quaternions, dtype=np.float64).reshape(-1, 4).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), -1, 0)
