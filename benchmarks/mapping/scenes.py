"""Worlds to map: solids of all kinds, and meshes of many triangles."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from trundle.geometry import FloatArray, Pose3D, rotation_matrices
from trundle.geometry.solids import Box, Cylinder, Mesh, Shape, Solid, Sphere
from trundle.worlds import World

BAND = (0.10, 0.62)
HALL = (30.0, 20.0)
FIELD = (200.0, 200.0)

# Of each kind, so many in 100 solids.
_SHARES = {
    "box": 40,
    "cylinder": 20,
    "thin wall": 10,
    "tumbled box": 10,
    "ball": 5,
    "table top": 5,
    "tilted pipe": 5,
    "concave mesh": 5,
}
KINDS = tuple(_SHARES)


def mixed_world(count: int, size: tuple[float, float], seed: int = 0) -> World:
    """Solids of all kinds at random places, all of them reaching into the band, and four outer walls."""
    rng = np.random.default_rng(seed)
    kinds = [kind for kind, share in _SHARES.items() for _ in range(share)]
    solids = [_wall(index, size) for index in range(4)]
    for number in range(count - len(solids)):
        kind = kinds[number % len(kinds)]
        shape, z, orientation = _make(kind, rng)
        place = (rng.uniform(1.0, size[0] - 1.0), rng.uniform(1.0, size[1] - 1.0), z)
        solids.append(Solid(f"{kind} {number}", shape, Pose3D(place, orientation), kind=kind))
    return World(f"{count} solids", tuple(solids))


def _wall(index: int, size: tuple[float, float]) -> Solid:
    length = size[index // 2]
    x, y = (length / 2.0, size[1] * (index % 2)) if index < 2 else (size[0] * (index % 2), length / 2.0)
    full = (length, 0.1, 2.5) if index < 2 else (0.1, length, 2.5)
    return Solid(f"outer wall {index}", Box(full), Pose3D((x, y, 1.25)), kind="box")


def _make(kind: str, rng: np.random.Generator) -> tuple[Shape, float, tuple[float, float, float, float]]:
    """A shape, its height [m] and its orientation."""
    turn = rng.uniform(-math.pi, math.pi) / 2.0
    upright = (math.cos(turn), 0.0, 0.0, math.sin(turn))
    w, x, y, z = rng.normal(size=4).tolist()
    free = (w, x, y, z)
    match kind:
        case "box":
            width, depth, height = rng.uniform(0.2, 1.2, 3).tolist()
            return Box((width, depth, height)), height / 2.0, upright
        case "thin wall":
            return Box((float(rng.uniform(1.0, 4.0)), 0.004, 2.0)), 1.0, upright
        case "tumbled box":
            width, depth, height = rng.uniform(0.1, 0.8, 3).tolist()
            return Box((width, depth, height)), float(rng.uniform(0.1, 0.6)), free
        case "table top":
            return Box((float(rng.uniform(0.6, 2.0)), 0.8, 0.04)), 0.59, upright
        case "cylinder":
            return Cylinder(float(rng.uniform(0.05, 0.4)), 1.2), 0.6, upright
        case "tilted pipe":
            return Cylinder(float(rng.uniform(0.03, 0.2)), float(rng.uniform(0.5, 2.0))), 0.4, free
        case "ball":
            return Sphere(float(rng.uniform(0.1, 0.5))), 0.3, upright
        case _:
            return _ring(float(rng.uniform(0.3, 0.8)), float(rng.uniform(0.03, 0.15))), 0.36, upright


def _ring(radius: float, thickness: float) -> Mesh:
    """A closed ring of radius [m] and thickness [m] that stands on the floor: what is inside of it is free."""
    sides = 24
    profile = np.array([(radius, -0.4), (radius, 0.4), (radius - thickness, 0.4), (radius - thickness, -0.4)])
    angles = np.arange(sides) * (2.0 * math.pi / sides)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    vertices = np.concatenate(
        [around[:, None, :] * profile[None, :, :1], np.broadcast_to(profile[:, 1:], (sides, 4, 1))], axis=2
    )
    faces: list[tuple[int, int, int]] = []
    for side in range(sides):
        for corner in range(4):
            a, b = 4 * side + corner, 4 * side + (corner + 1) % 4
            c, d = 4 * ((side + 1) % sides) + corner, 4 * ((side + 1) % sides) + (corner + 1) % 4
            faces += [(a, c, b), (c, d, b)]
    return Mesh(vertices.reshape(-1, 3), np.array(faces))


def _places(rng: np.random.Generator, count: int) -> FloatArray:
    """Points over the field, at heights in the band."""
    low, high = (0.0, 0.0, BAND[0]), (*FIELD, BAND[1])
    return rng.uniform(low, high, (count, 3))


def soup(edge: float, count: int) -> Mesh:
    """Triangles of one edge [m] at random places and orientations: all in the band, nothing closed."""
    rng = np.random.default_rng(0)
    turned = rotation_matrices(_unit_quaternions(rng, count))
    angles = np.array([0.0, 2.0, 4.0]) * math.pi / 3.0
    flat = np.stack([np.cos(angles), np.sin(angles), np.zeros(3)]) * edge / math.sqrt(3.0)
    corners = (turned @ flat).transpose(0, 2, 1) + _places(rng, count)[:, None, :]
    return Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


def tetrahedra(edge: float, count: int) -> Mesh:
    """One closed mesh of as many faces: tetrahedra of one edge [m] at random places and orientations."""
    rng = np.random.default_rng(0)
    bodies = count // 4
    base = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]) * edge / math.sqrt(8.0)
    turned = rotation_matrices(_unit_quaternions(rng, bodies))
    corners = (turned @ base.T).transpose(0, 2, 1) + _places(rng, bodies)[:, None, :]
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return Mesh(corners.reshape(-1, 3), (faces + 4 * np.arange(bodies)[:, None, None]).reshape(-1, 3))


def walls(edge: float, count: int) -> Mesh:
    """Upright triangles of one edge [m] along the walls of rooms of 5 m that lie across the grid."""
    rng = np.random.default_rng(0)
    line, along = 5.0 * rng.integers(0, 40, count) + 2.5, rng.uniform(0.0, FIELD[0], count)
    height, first = rng.uniform(*BAND, count), rng.uniform(0.0, 2.0 * math.pi, count)
    radius = edge / math.sqrt(3.0)
    corners = np.stack(
        [
            np.stack([along + radius * np.cos(angle), line, height + radius * np.sin(angle)], axis=1)
            for angle in (first, first + 2.0 * math.pi / 3.0, first + 4.0 * math.pi / 3.0)
        ],
        axis=1,
    )
    across = rng.random(count) < 0.5
    corners[across] = corners[across][..., [1, 0, 2]]
    turn = 0.1
    rotation = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1.0]])
    return Mesh((corners @ rotation.T).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


MESHES: dict[str, Callable[[float, int], Mesh]] = {
    "at random, open": soup,
    "tetrahedra, closed": tetrahedra,
    "walls of rooms, open": walls,
}


def _unit_quaternions(rng: np.random.Generator, count: int) -> FloatArray:
    quaternions = rng.normal(size=(count, 4))
    return quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
