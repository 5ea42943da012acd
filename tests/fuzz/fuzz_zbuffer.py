"""Triangles in a depth buffer: every pixel's ray against every triangle."""

from __future__ import annotations

import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.ray_picture import SIZE, cast
from trundle._core import draw_triangles


def one_round(generator: random.Random) -> None:
    triangles = rng_of(generator).uniform((-3, -3, -1), (3, 3, 6), (generator.choice((0, 1, 2, 6)), 3, 3))
    if generator.random() < 0.2:
        triangles = np.round(triangles * 2.0) / 2.0
    scale, near, perspective = (
        generator.choice((1.0, 6.0, 40.0)),
        generator.choice((0.01, 0.1, 2.0)),
        generator.random() < 0.5,
    )
    if generator.random() < 0.3:
        size = generator.choice((1, 5)), generator.choice((1, 9))
        triangles *= generator.choice((1.0, 1e6, 1e150))
        attempt(draw_triangles, spoil(generator, (triangles, *size, scale, near, perspective)))
        return
    faces, depths = draw_triangles(triangles, SIZE, SIZE, scale, near, perspective)
    expected, distances, doubt = cast(triangles, scale, near, perspective)
    sure = doubt > 1e-6
    assert np.array_equal(faces[sure], expected[sure])
    assert np.allclose(depths[sure], distances[sure], rtol=1e-6, atol=1e-6)
