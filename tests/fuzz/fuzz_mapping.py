"""The kernels of mapping on random scans and graphs, against slow versions."""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from mapping import kernel_oracles as oracle
from trundle._core import SurfaceMap, count_beams, draw_cells, find_normals, solve_graph


def check_normals(generator: random.Random) -> None:
    rng = rng_of(generator)
    count = generator.choice((0, 1, 3, 40))
    points = np.column_stack((np.arange(count) * 0.1, rng.normal(0.0, generator.choice((0.0, 0.01, 0.3)), count)))
    points += rng.uniform(-5.0, 5.0, 2)
    arguments = points, rng.uniform(-5.0, 5.0, (count, 2)), 0.05, generator.choice((0.05, 0.15, 1.0))
    attempt(find_normals, spoil(generator, arguments))
    assert np.allclose(find_normals(*arguments), oracle.find_normals(*arguments), atol=1e-6)


def check_graph(generator: random.Random) -> None:
    rng = rng_of(generator)
    count = generator.choice((2, 5, 30))
    poses = np.cumsum(rng.normal(0.0, 0.3, (count, 3)), axis=0)
    pairs = [(i, i + 1) for i in range(count - 1)]
    pairs += [tuple(rng.choice(count, 2, replace=False).tolist()) for _ in range(generator.choice((0, 3, 20)))]
    edges = np.array(pairs, dtype=np.int32)
    transforms = rng.normal(0.0, 0.3, (len(edges), 3))
    information = np.tile(np.diag((10.0, 20.0, 30.0)), (len(edges), 1, 1))
    widths = rng.choice((0.0, 3.0), len(edges))
    fixed = (np.arange(count) == 0).astype(np.uint8)
    arguments = poses, edges, transforms, information, widths, fixed, 20
    attempt(solve_graph, spoil(generator, arguments))
    found, errors, told = solve_graph(*arguments)
    assert (found[0] == oracle.wrapped(poses)[0]).all()
    assert told[2] <= told[1] * (1.0 + 1e-9)
    assert np.allclose(errors, oracle.edge_errors(found, edges, transforms, information), rtol=1e-6, atol=1e-6)


def check_drawing(generator: random.Random) -> None:
    rng = rng_of(generator)
    counts = np.zeros((*rng.integers(1, 30, 2), 4), dtype=np.int32)
    count, edge = generator.choice((0, 1, 30)), float(rng.choice((0.05, 1.0)))
    sensors, points = (rng.uniform(-5.0, 35.0, (count, 2)) * edge for _ in range(2))
    hits = (rng.random(count) < 0.7).astype(np.uint8)
    beams = sensors, points, hits, np.zeros(2), edge, edge * generator.choice((0.0, 1.5))
    attempt(count_beams, spoil(generator, (counts.copy(), *beams, 1)))
    count_beams(counts, *beams, 1)
    least, most = oracle.count_beams(counts.shape, *beams)
    assert (counts[..., 0] == most[..., 0]).all()
    assert (counts[..., 1] >= least).all()
    assert (counts[..., 1] <= most[..., 1]).all()
    settings = np.array((1.0, 0.1, 1.0))
    attempt(draw_cells, spoil(generator, (counts, settings)))
    cells = draw_cells(counts, settings)
    assert cells.min() >= -1
    assert cells.max() <= 100
    nothing = counts[..., :2].sum(axis=2) == 0
    assert (cells[nothing & ~oracle.widened(counts[..., 0] > 0)] == -1).all()
    assert (cells >= 65).any() or not (counts[..., 0] > 9 * counts[..., 1]).any()
    count_beams(counts, *beams, -1)
    assert not counts.any()


def check_surfaces(generator: random.Random) -> None:
    rng = rng_of(generator)
    known = SurfaceMap(0.1)
    count = generator.choice((1, 20, 200))
    points, turns = rng.uniform(-3.0, 3.0, (count, 2)), rng.uniform(-math.pi, math.pi, count)
    normals = np.column_stack((np.cos(turns), np.sin(turns)))
    pose = rng.uniform(-2.0, 2.0, 3)
    attempt(known.add, spoil(generator, (points, normals, pose, 1)))
    known = SurfaceMap(0.1)
    known.add(points, normals, pose, 1)
    window = np.array((0.1, 0.1, 0.05)), np.array((0.1, 0.1))
    found, share = known.search(points, pose, *window)
    assert share == 1.0
    assert np.allclose(found, pose)
    attempt(known.search, spoil(generator, (points, pose, *window)))
    settings = np.array((0.2, 0.08, 0.03, 60.0, 10.0))
    arguments = points, normals, pose[None], pose, np.eye(3), settings
    attempt(known.match, spoil(generator, arguments))
    poses, spreads, fits = known.match(*arguments)
    assert np.isfinite(poses).all()
    assert (np.linalg.eigvalsh(spreads[0]) > 0.0).all()
    assert (fits[0, [0, 2]] >= 0.0).all()
    assert (fits[0, [0, 2]] <= 1.0 + 1e-9).all()
    attempt(known.table, spoil(generator, (0.2,)))
    table, corner = known.table(0.1)
    cells = np.floor(oracle.moved(points, pose) / 0.1).astype(int) - np.round(corner / 0.1).astype(int)
    assert (table[cells[:, 1], cells[:, 0]] == 255).all()
    known.add(points, normals, pose, -1)
    assert not known.table(0.1)[0].any()


def check_corner(generator: random.Random) -> None:
    """A scan of a corner finds back to where the corner was seen from."""
    rng = rng_of(generator)
    along = np.arange(0.0, 4.0, 0.05)
    points = np.concatenate([np.column_stack(pair) for pair in ((along, 0.0 * along), (0.0 * along, along))])
    normals = np.repeat(((0.0, 1.0), (1.0, 0.0)), len(along), axis=0)
    pose = rng.uniform(-2.0, 2.0, 3)
    known = SurfaceMap(0.1)
    known.add(points, normals, pose, 1)
    start = pose + rng.uniform(-1.0, 1.0, 3) * (0.05, 0.05, 0.02)
    settings = np.array((0.2, 0.08, 0.03, 60.0, 10.0))
    poses, _, fits = known.match(points, normals, start[None], start, np.eye(3), settings)
    assert np.allclose(poses[0], pose, atol=5e-4)
    assert fits[0, 0] > 0.99


def one_round(generator: random.Random) -> None:
    check_normals(generator)
    check_graph(generator)
    check_drawing(generator)
    check_surfaces(generator)
    check_corner(generator)
