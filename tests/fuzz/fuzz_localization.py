"""The kernels of localisation on random maps, scans and particles, against slow versions."""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from localization import kernel_oracles as oracle
from trundle._core import (
    distance_field,
    expect_surfaces,
    field_at,
    judge_beams,
    learn_surfaces,
    match_scan,
    move_particles,
    peak_particle,
    pick_beams,
    resample_particles,
    search_poses,
    weigh_particles,
)


def _field(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, float, float]:
    """A map, its distance field, the edge of its cells and the farthest distance."""
    shape = rng.integers(1, 24, 2)
    occupied = (rng.random(shape) < rng.choice((0.0, 0.05, 0.4, 1.0))).astype(np.uint8)
    edge = float(rng.choice((0.05, 0.1, 1.0)))
    limit = edge * float(rng.choice((1.0, 3.5, 12.0, 900.0)))
    return occupied, distance_field(occupied, edge, 0.0, limit), edge, limit


def check_field(generator: random.Random) -> None:
    rng = rng_of(generator)
    occupied, _, edge, limit = _field(rng)
    arguments = (occupied, edge, float(rng.uniform(-edge, edge)), limit)
    if generator.random() < 0.4:
        attempt(distance_field, spoil(generator, arguments))
        return
    field = distance_field(*arguments)
    assert np.allclose(field, oracle.distance_field(*arguments), atol=1e-4 * limit)
    points = rng.uniform(-2.0 * edge, 26.0 * edge, (generator.choice((0, 1, 40)), 2))
    if generator.random() < 0.4:
        attempt(field_at, spoil(generator, (field, edge, limit, points)))
        return
    found = field_at(field, edge, limit, points)
    assert np.allclose(found, oracle.field_at(field, edge, limit, points), atol=1e-6 * max(1.0, limit / edge))


def check_particles(generator: random.Random) -> None:
    rng = rng_of(generator)
    _, field, edge, _ = _field(rng)
    cloud = rng.uniform(-5.0, 5.0, (generator.choice((0, 1, 50)), 3))
    seed = generator.choice((0, 1, 2**63, 2**64 - 1))
    motion, alphas, least = rng.uniform(-1, 1, 3), rng.uniform(0, 1, 4), rng.uniform(0, 1, 2)
    moving = (cloud, motion, alphas, least, seed)
    weighing = (field, edge, -1.0, cloud, rng.uniform(-3.0, 3.0, (generator.choice((0, 1, 30)), 2)))
    bound = np.array([generator.choice((1.0, 20.0)), generator.choice((20.0, 300.0)), 0.05, 2.33])
    weights = rng.random(len(cloud)) * generator.choice((0.0, 1.0, 1.0))
    peak = (cloud, weights, float(rng.uniform(0, 5)), float(rng.uniform(0, 4)))
    drawing = (cloud, rng.random(len(cloud)), np.array([0.5, 0.2]), bound, seed)
    if generator.random() < 0.5:
        for kernel, arguments in (
            (move_particles, moving),
            (weigh_particles, weighing),
            (resample_particles, drawing),
            (peak_particle, peak),
        ):
            attempt(kernel, spoil(generator, arguments))
        return
    moved = move_particles(*moving)
    assert moved.shape == cloud.shape
    assert np.isfinite(moved).all()
    assert np.array_equal(moved, move_particles(*moving))
    assert np.allclose(weigh_particles(*weighing), oracle.weigh_particles(*weighing))
    if len(cloud):
        assert np.allclose(peak_particle(*peak), oracle.peak_particle(*peak))
        drawn = resample_particles(*drawing)
        assert bound[0] <= len(drawn) <= bound[1]
        assert {tuple(row) for row in drawn} <= {tuple(row) for row in cloud}


def check_match(generator: random.Random) -> None:
    rng = rng_of(generator)
    _, field, edge, limit = _field(rng)
    count, beams = generator.choice((0, 1, 3)), generator.choice((0, 1, 30))
    points = rng.uniform(-5.0, 5.0, (beams, 2)) * 2.0 * edge
    poses = rng.uniform(0.0, 20.0, (count, 3)) * (edge, edge, 0.3)
    covariances = np.tile(np.diag((0.0025, 0.0025, 0.0025)), (count, 1, 1))
    settings = np.array((generator.choice((0.1, 1.0)), 0.1, 0.05, 30.0, generator.choice((1.0, 8.0))))
    arguments = (field, edge, limit, points, np.zeros((count, beams)), poses, poses, covariances, settings)
    judging = (field, edge, np.zeros((beams, 2)), points, poses, edge, 2.0 * edge)
    if generator.random() < 0.5:
        attempt(match_scan, spoil(generator, arguments))
        attempt(judge_beams, spoil(generator, judging))
        return
    found, spread, told = match_scan(*arguments)
    assert np.isfinite(found).all()
    assert np.isfinite(told).all()
    assert (np.abs(found[:, 2]) <= math.pi + 1e-9).all()
    for matrix in spread:
        values = np.linalg.eigvalsh(matrix)
        assert values.min() > 0.0
        assert values.max() < 0.002501  # beams only add to the prior's information
    verdicts = judge_beams(*judging)
    assert verdicts.shape == (count, beams)
    for pose, row in zip(poses, verdicts, strict=True):
        for point, verdict in zip(points, row, strict=True):
            end = oracle.ends_of(point[np.newaxis], pose)
            value = oracle.field_at(field, edge, math.nan, end)[0, 0]
            assert (verdict == 3) == math.isnan(value)
            if abs(value) > 1e-9:
                assert not (verdict == 0 and value > edge)
                assert not (verdict == 1 and value < edge)


def check_scan(generator: random.Random) -> None:
    rng = rng_of(generator)
    count = generator.choice((0, 1, 2, 60))
    ranges = rng.uniform(0.0, 6.0, count)
    ranges[rng.random(count) < 0.3] = generator.choice((math.inf, -math.inf, math.nan, 0.0))
    poses = rng.uniform(-4.0, 4.0, (2, 3))
    if generator.random() < 0.5:
        poses[1] = poses[0]
    body = rng.uniform(-1.0, 1.0, (generator.choice((0, 4)), 3))
    most, offset = generator.choice((1, 7, 1000)), float(rng.uniform(0.0, 1.0))
    arguments = (ranges, rng.uniform(-4, 4, count), rng.uniform(-1, 1, 3), poses, body, 0.1, 5.0, most, offset)
    if generator.random() < 0.4:
        attempt(pick_beams, spoil(generator, arguments))
        return
    for one, other in zip(pick_beams(*arguments), oracle.pick_beams(*arguments), strict=True):
        assert one.shape == other.shape
        assert np.allclose(one, other)


def check_surfaces(generator: random.Random) -> None:
    rng = rng_of(generator)
    _, field, edge, limit = _field(rng)
    points = rng.uniform(-5.0, 5.0, (generator.choice((0, 1, 40)), 2)) * 2.0 * edge
    pose = rng.uniform(0.0, 20.0, 3) * (edge, edge, 0.3)
    shape = tuple(rng.integers(1, 12, 2))
    counts, means = rng.uniform(0, 30, shape).astype(np.float32), rng.normal(0, 0.2, shape).astype(np.float32)
    surfaces = (field, edge, limit, points, pose, counts, means, 2.0 * edge)
    settings = np.array((3.0 * edge, 0.04, 0.03, 0.9, 2.0))
    expecting, learning = (*surfaces, float(rng.normal(0.0, 0.02)), settings), (*surfaces, 3.0 * edge, 20.0)
    if generator.random() < 0.4:
        attempt(expect_surfaces, spoil(generator, expecting))
        attempt(learn_surfaces, spoil(generator, learning))
        return
    # A foot that lies on the border of two patches may belong to either.
    found, expected = expect_surfaces(*expecting), oracle.expect_surfaces(*expecting)
    assert np.isclose(found, expected, atol=1e-6).mean() > 0.9 or len(points) < 2
    for one, other in zip((counts, means), _learned(learning), strict=True):
        assert np.isclose(one, other, atol=1e-5).mean() > 0.9 or one.size < 20


def _learned(learning: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """What the slow version makes of the tables, which the kernel changes."""
    expected = oracle.learn_surfaces(*learning)
    learn_surfaces(*learning)
    return expected


def check_search(generator: random.Random) -> None:
    rng = rng_of(generator)
    occupied, field, edge, _ = _field(rng)
    table = np.rint(255.0 * np.exp(-np.abs(field) / edge)).astype(np.uint8)
    points = rng.uniform(-5.0, 5.0, (generator.choice((1, 12)), 2)) * edge
    least = generator.choice((0.0, 60.0))
    window = np.array((0.0, 25.0 * edge, 0.0, 25.0 * edge, -0.5, 0.5))
    settings = np.array((0.25, least, generator.choice((0.0, 0.9, 1.0)), 3.0 * edge, 0.5))
    arguments = (table, 1 - occupied, edge, points, window, settings, generator.choice((1, 5)), 1_000_000)
    if generator.random() < 0.4:
        attempt(search_poses, spoil(generator, arguments))
        return
    poses, scores, complete = search_poses(*arguments)
    assert complete
    assert (np.diff(scores) <= 0.0).all()
    yaws = -0.5 + 0.25 * np.arange(5)
    best = max(
        (
            oracle.score(table, edge, points, col, row, yaw)
            for row, col in np.argwhere(occupied == 0).tolist()
            for yaw in yaws
        ),
        default=-1.0,
    )
    if best >= least:
        assert abs(scores.max(initial=-1.0) - best) < 1e-9
    else:
        assert len(poses) == 0


def one_round(generator: random.Random) -> None:
    checks = check_field, check_particles, check_match, check_scan, check_surfaces, check_search
    generator.choice(checks)(generator)
