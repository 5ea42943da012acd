"""Slow and plain versions of the kernels of mapping."""

from __future__ import annotations

import math

import numpy as np


def moved(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Points seen from a pose."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return points @ np.array(((cos, sin), (-sin, cos))) + pose[:2]


def wrapped(poses: np.ndarray) -> np.ndarray:
    """Poses with their yaws from -pi to pi."""
    out = poses.copy()
    out[:, 2] = [math.remainder(yaw, 2.0 * math.pi) for yaw in poses[:, 2].tolist()]
    return out


def find_normals(points: np.ndarray, sensors: np.ndarray, gap: float, least: float) -> np.ndarray:
    """The direction of least spread of up to three points on either side."""
    out = np.zeros_like(points)
    for i, (point, sensor) in enumerate(zip(points, sensors, strict=True)):
        most = max(least, gap * np.linalg.norm(point - sensor))
        near = [point]
        for step in (-1, 1):
            last = i
            for _ in range(3):
                after = last + step
                if not 0 <= after < len(points) or np.linalg.norm(points[after] - points[last]) > most:
                    break
                if np.linalg.norm(points[after] - point) > 2.0 * most:
                    break
                near.append(points[after])
                last = after
        if len(near) < 3:
            continue
        values, vectors = np.linalg.eigh(np.cov(np.array(near).T))
        if not values[1] > 0.0 or values[0] > 0.1 * values[1]:
            continue
        normal = vectors[:, 0]
        out[i] = normal if normal @ (sensor - point) >= 0.0 else -normal
    return out


def residuals(poses: np.ndarray, edges: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Errors of edges (E, 3)."""
    a, b = poses[edges[:, 0]], poses[edges[:, 1]]
    cos, sin = np.cos(a[:, 2]), np.sin(a[:, 2])
    dx, dy = (b - a)[:, 0], (b - a)[:, 1]
    out = np.column_stack((cos * dx + sin * dy, cos * dy - sin * dx, b[:, 2] - a[:, 2])) - transforms
    out[:, 2] = np.arctan2(np.sin(out[:, 2]), np.cos(out[:, 2]))
    return out


def edge_errors(poses: np.ndarray, edges: np.ndarray, transforms: np.ndarray, information: np.ndarray) -> np.ndarray:
    """Squared errors of edges."""
    errors = residuals(poses, edges, transforms)
    return np.einsum("ei,eij,ej->e", errors, information, errors)


def count_beams(
    shape: tuple[int, ...],
    sensors: np.ndarray,
    points: np.ndarray,
    hits: np.ndarray,
    corner: np.ndarray,
    resolution: float,
    short_by: float,
) -> tuple[np.ndarray, np.ndarray]:
    """What passes at least (cells on fine points of the beams), and the ends and what passes at most."""
    rows, cols = shape[:2]
    least, most = np.zeros((rows, cols), int), np.zeros((rows, cols, 2), int)
    for sensor, point, hit in zip((sensors - corner) / resolution, (points - corner) / resolution, hits, strict=True):
        length = np.linalg.norm(point - sensor)
        end = np.floor(point).astype(int)
        if hit and 0 <= end[0] < cols and 0 <= end[1] < rows:
            most[end[1], end[0], 0] += 1
        until = length - short_by / resolution if hit else length
        if until <= 0.0:
            continue
        at = sensor + np.linspace(0.0, until / length, int(length * 60) + 2)[:, None] * (point - sensor)
        for slack, table in ((-0.02, least), (0.02, most[..., 1])):
            cells = set()
            for dx in (-slack, slack):
                for dy in (-slack, slack):
                    here = {tuple(cell) for cell in np.floor(at + np.array((dx, dy))).astype(int).tolist()}
                    cells = here if not cells else cells & here if slack < 0 else cells | here
            for col, row in cells:
                if 0 <= col < cols and 0 <= row < rows and not (hit and slack < 0 and (col, row) == tuple(end)):
                    table[row, col] += 1
    return least, most


def widened(cells: np.ndarray, by: int = 3) -> np.ndarray:
    """Cells, and those near them."""
    out = cells.copy()
    for dy in range(-by, by + 1):
        for dx in range(-by, by + 1):
            shifted = np.roll(cells, (dy, dx), axis=(0, 1))
            out |= shifted
    return out
