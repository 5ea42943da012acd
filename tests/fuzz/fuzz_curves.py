"""Dubins' and Reeds and Shepp's curves: each ends at its goal, and none is longer than what is known to be possible."""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.driving import drive, off_by
from trundle._core import shortest_curves


def one_round(generator: random.Random) -> None:
    rng, count = rng_of(generator), generator.choice((0, 1, 3, 20))
    size, radius = generator.choice((1e-9, 0.1, 1.0, 10.0, 1e4)), generator.choice((0.01, 0.4, 1.0, 20.0))
    starts, goals = (rng.uniform(-size, size, (count, 3)) for _ in range(2))
    for poses in (starts, goals):
        poses[:, 2] = rng.choice(np.array([0.0, math.pi / 2, -math.pi / 2, math.pi, 1.234, 100.0]), count)
        poses[rng.random(count) < 0.5, 2] += rng.uniform(-3, 3)
    goals[rng.random(count) < 0.2, :2] = 0.0
    goals[rng.random(count) < 0.1] = generator.choice((0.0, 1.0))
    if generator.random() < 0.3:
        attempt(shortest_curves, spoil(generator, (starts, goals, radius, generator.random() < 0.5)))
        return
    lengths = []
    for reverse in (True, False):
        pieces = shortest_curves(starts, goals, radius, reverse)
        reached = drive(starts.T, [(pieces[:, k, 0], pieces[:, k, 1]) for k in range(5)])
        # A piece starts where the one before ends: what is rounded there grows with the place and with the turns.
        assert (off_by(reached, goals.T) <= 1e-8 * (1.0 + size + radius + size / radius)).all()
        assert np.isin(np.round(pieces[:, :, 1] * radius, 9), (-1.0, 0.0, 1.0)).all()
        assert reverse or (pieces[:, :, 0] >= 0.0).all()
        lengths.append(np.abs(pieces[:, :, 0]).sum(axis=1))
    straight = np.hypot(*(goals - starts)[:, :2].T)
    scale = 1e-9 * (size + radius)
    assert (straight <= lengths[0] + scale).all()
    assert (lengths[0] <= lengths[1] + scale).all()
    # Turn towards the goal, go there, turn round: Reeds and Shepp need at most that and two three-point turns.
    assert (lengths[0] <= straight + 4.0 * math.pi * radius + scale).all()
