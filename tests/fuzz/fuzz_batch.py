"""Many robots at once: motion, contacts and scans, against plain versions."""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.batch_oracle import drive
from trundle._core import Batch, cast_grid_rays, chebyshev_field, footprint_collides

CELL = 0.1
OUTLINE = np.array([(0.25, 0.15), (-0.35, 0.2), (-0.35, -0.2), (0.25, -0.15)])


def cells_of(generator: random.Random) -> np.ndarray:
    rng = rng_of(generator)
    shape = generator.choice((1, 3, 20)), generator.choice((1, 7, 31))
    return (rng.random(shape) < generator.choice((0.0, 0.003, 0.03, 0.2, 1.0))).astype(np.uint8)


def check_batch(generator: random.Random) -> None:
    rng = rng_of(generator)
    grids = [cells_of(generator) for _ in range(generator.choice((1, 3)))]
    frames = rng.uniform((-2, -2, -4), (2, 2, 4), (len(grids), 3))
    limits = np.array([1.2, 0.5, 1.5, 0.02, 0.05, 0.1, 0.4, generator.choice((math.inf, 8.0)), 0.01])
    count, beams = generator.choice((1, 5, 70)), generator.choice((1, 9))
    tracks = rng.uniform(-5, 5, (2, generator.choice((1, 4)), 3))
    model = (
        *(np.concatenate([chebyshev_field(grid).ravel() for grid in grids]),),
        *(np.array([grid.shape for grid in grids]), frames, CELL, OUTLINE, limits),
        *(np.array([(0.1, 0.05, 0.3, 0.02, 2.0)]), np.array([beams]), np.linspace(-2.0, 2.0, beams)),
        *(OUTLINE * 2.0, np.array([4, 0]), np.array([0.0, 0.3]), tracks, np.array([0, 2]), 0.5),
    )
    if generator.random() < 0.2:
        attempt(Batch, spoil(generator, model))
        return
    batch = Batch(*model)
    places = np.column_stack([rng.integers(0, len(grids), count), np.full(count, -1)])
    poses = rng.uniform((-3, -3, -9), (3, 3, 9), (count, 3))
    state = [poses.copy(), np.zeros((count, 6)), np.zeros((count, 2)), np.zeros(count), np.zeros(count, np.int64)]
    contacts, active = np.zeros((count, 4), np.int64), rng.random(count) < 0.8
    commands, substeps = rng.uniform(-2, 2, (count, 2)), generator.choice((0, 1, 7))
    arguments = (*state, contacts, commands, places, active, substeps, generator.choice((1, 3)))
    if generator.random() < 0.2:
        attempt(batch.drive, spoil(generator, arguments))
        return
    batch.drive(*arguments)
    for robot in range(count):
        pose, motion = (poses[robot], np.zeros(6))
        touching = []
        for _ in range(max(1, substeps) if active[robot] else 0):
            pose, motion = drive(pose, motion, commands[robot], limits, min(substeps, 1))
            map_number = places[robot, 0]
            grid = np.pad(grids[map_number], 99)  # beyond the map is nothing
            x, y, yaw = frames[map_number]
            dx, dy, cos, sin = pose[0] - x, pose[1] - y, math.cos(yaw), math.sin(yaw)
            middle = cos * dx + sin * dy + 99 * CELL, cos * dy - sin * dx + 99 * CELL
            turned = np.array([(*middle, pose[2] - yaw)])
            touching.append(footprint_collides(grid * np.uint8(254), CELL, 0.0, 0.0, 0.0, OUTLINE, turned)[0])
        assert np.abs(state[0][robot] - pose).max() < 1e-11
        assert np.abs(state[1][robot] - motion).max() < 1e-11
        assert bool(contacts[robot, 0]) == any(touching)
    if generator.random() < 0.2:
        seen = (np.zeros((count, beams)), state[0], state[4], places, active, np.zeros((count, 2)),
                np.zeros(count, np.uint64), 1)  # fmt: skip
        attempt(batch.scan, spoil(generator, seen))


def check_scan(generator: random.Random) -> None:
    """A scan of one robot beside a disc, which stands, in the frame of a turned map."""
    rng, blocked = rng_of(generator), cells_of(generator)
    frame, pose = rng.uniform(-2, 2, 3), rng.uniform(-2, 2, 3)
    disc, angles = rng.uniform(-3, 3, 3), np.linspace(-3.0, 3.0, 40)
    batch = Batch(
        *(chebyshev_field(blocked).ravel(), np.array([blocked.shape]), frame[None], CELL, OUTLINE),
        *(np.array([1.0, 1, 1, 1, 1, 1, 1, 1, 0.01]), np.array([(0.0, 0.0, 0.0, 0.0, 2.5)]), np.array([40]), angles),
        *(np.zeros((0, 2)), np.zeros(1, np.int64), np.array([0.4]), disc[None, None], np.array([0, 1]), 1.0),
    )
    ranges = np.zeros((1, 40))
    state = pose[None], np.zeros(1, np.int64), np.array([(0, 0)]), np.ones(1, bool), np.zeros((1, 2))
    batch.scan(ranges, *state, np.zeros(1, np.uint64), 1)
    (dx, dy), turn = pose[:2] - frame[:2], frame[2]
    x, y = math.cos(turn) * dx + math.sin(turn) * dy, math.cos(turn) * dy - math.sin(turn) * dx
    walls = CELL * cast_grid_rays(blocked, x / CELL, y / CELL, angles + pose[2] - turn, 25.0)
    away = disc[:2] - pose[:2]
    along = np.column_stack([np.cos(angles + pose[2]), np.sin(angles + pose[2])]) @ away
    root = 0.16 - (away @ away - along**2)
    half = np.sqrt(np.maximum(root, 0.0))
    met = np.where(along - half >= 0.0, along - half, along + half)
    met = np.where((root >= 0.0) & (met >= 0.0) & (met <= 2.5), met, np.inf)
    expected = np.minimum(walls, met)
    steady = (np.abs(root) > 1e-6) & (np.abs(np.nan_to_num(expected, posinf=9.0) - 2.5) > 1e-6)
    assert np.allclose(ranges[0][steady], expected[steady], rtol=0.0, atol=1e-7)


def one_round(generator: random.Random) -> None:
    generator.choice((check_batch, check_scan))(generator)
