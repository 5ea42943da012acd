"""What each pixel of a picture sees of some triangles, ray by ray."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

SIZE = 16
"""Edge of the picture [pixels]."""


def cast(
    triangles: FloatArray, scale: float, near: float, perspective: bool
) -> tuple[npt.NDArray[np.int64], FloatArray, FloatArray]:
    """Every pixel's ray against every triangle; also how far from sure each answer is."""
    cols, rows = np.meshgrid(np.arange(SIZE) + 0.5 - SIZE / 2.0, SIZE / 2.0 - np.arange(SIZE) - 0.5)
    flat = np.stack([cols / scale, rows / scale, np.ones((SIZE, SIZE))], axis=-1)
    origins, rays = (flat * 0.0, flat) if perspective else (flat * (1.0, 1.0, 0.0), flat * (0.0, 0.0, 1.0))
    faces, depths = np.full((SIZE, SIZE), -1), np.full((SIZE, SIZE), math.inf)
    doubt = np.full((SIZE, SIZE), math.inf)
    for index, (a, b, c) in enumerate(triangles):
        normal = np.cross(b - a, c - a)
        across = rays @ normal
        edge_on = np.abs(across) < 1e-6
        t = np.where(edge_on, math.inf, ((a - origins) @ normal) / np.where(edge_on, 1.0, across))
        points = origins + rays * np.where(edge_on, 0.0, t)[..., None]
        sides = [np.cross(q - p, points - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
        inside = np.min(sides, axis=0) / max(normal @ normal, 1e-12)
        doubt = np.where(edge_on, 0.0, np.minimum(doubt, np.abs(inside)))
        if perspective:
            doubt = np.where(edge_on, 0.0, np.minimum(doubt, np.abs(t - near)))
        met = ~edge_on & (inside > 0.0) & ((t > near) | (not perspective))
        rival = met & np.isfinite(depths)
        doubt[rival] = np.minimum(doubt[rival], np.abs(t[rival] - depths[rival]))
        nearer = met & (t < depths)
        faces[nearer], depths[nearer] = index, t[nearer]
    return faces, depths, doubt
