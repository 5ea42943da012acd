"""The kernels of localisation against slow and plain versions."""

import math

import numpy as np
import pytest

from localization import kernel_oracles as oracle
from trundle import _core

RNG = np.random.default_rng(4)
ROOM = np.zeros((40, 60), np.uint8)
ROOM[:3] = ROOM[-3:] = ROOM[:, :3] = ROOM[:, -3:] = 1
ROOM[10:16, 20:26] = ROOM[25:27, 40:50] = 1
CELL, LIMIT = 0.05, 0.8
FIELD = _core.distance_field(ROOM, CELL, 0.0, LIMIT)
SETTINGS = np.array([0.1, 0.1, 0.02, 1000.0, 60.0])


def rays_from(pose, count=90):
    """Where beams from a pose end on the room's walls, in the robot's frame."""
    angles = np.linspace(-math.pi, math.pi, count, endpoint=False)
    ranges = CELL * _core.cast_grid_rays(ROOM, pose[0] / CELL, pose[1] / CELL, angles + pose[2], 200.0)
    return np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])


@pytest.mark.parametrize("shift", [0.0, 0.05, -0.03])
@pytest.mark.parametrize("share", [0.02, 0.3, 0.9])
def test_distances_are_those_to_the_nearest_squares(shift, share):
    occupied = (RNG.random((17, 23)) < share).astype(np.uint8)
    found = _core.distance_field(occupied, 0.1, shift, 0.7)
    assert found.dtype == np.float32
    assert np.allclose(found, oracle.distance_field(occupied, 0.1, shift, 0.7), atol=1e-6)


def test_the_zero_of_the_field_is_the_border_of_a_wall():
    wall = np.zeros((9, 20), np.uint8)
    wall[:, 10:] = 1
    field = _core.distance_field(wall, 0.1, 0.0, 0.5)
    at_border = np.array([(1.0, 0.45), (0.93, 0.45), (1.12, 0.45)])
    assert np.allclose(_core.field_at(field, 0.1, 0.5, at_border)[:, 0], (0.0, 0.07, -0.12), atol=1e-6)
    assert np.allclose(_core.field_at(field, 0.1, 0.5, at_border)[:, 1:], (-1.0, 0.0), atol=1e-6)


def test_a_map_without_obstacles_is_far_from_everything():
    assert (_core.distance_field(np.zeros((5, 5), np.uint8), 0.1, 0.0, 0.4) == np.float32(0.4)).all()
    assert (_core.distance_field(np.ones((5, 5), np.uint8), 0.1, 0.0, 0.4) == np.float32(-0.4)).all()


def test_values_and_slopes_are_bilinear():
    points = RNG.uniform(-0.3, 3.3, (300, 2))
    assert np.allclose(_core.field_at(FIELD, CELL, LIMIT, points), oracle.field_at(FIELD, CELL, LIMIT, points))


def test_particles_move_as_the_model_says():
    cloud = np.tile((1.0, 2.0, 0.3), (40_000, 1))
    motion, alphas, least = np.array([0.2, 0.5, -0.1]), np.array([0.01, 0.02, 0.03, 0.04]), np.array([0.01, 0.02])
    moved = _core.move_particles(cloud, motion, alphas, least, 5)
    yaw_var = 0.01 * (0.2**2 + 0.1**2) + 2 * 0.02 * 0.5**2 + 0.02**2
    assert moved[:, 2].mean() == pytest.approx(0.4, abs=0.003)
    assert moved[:, 2].var() == pytest.approx(yaw_var, rel=0.03)
    along = (moved[:, :2] - (1.0, 2.0)) @ (math.cos(0.5), math.sin(0.5))
    across = (moved[:, :2] - (1.0, 2.0)) @ (-math.sin(0.5), math.cos(0.5))
    first = 0.01 * 0.2**2 + 0.02 * 0.5**2
    assert along.mean() == pytest.approx(0.5 * math.exp(-first / 2), abs=0.003)
    assert across.var() == pytest.approx(first * 0.5**2 + 0.01**2, rel=0.06)
    assert along.var() == pytest.approx(0.03 * 0.5**2 + 0.04 * (0.2**2 + 0.1**2) + 0.01**2, rel=0.06)


def test_the_same_seed_moves_particles_the_same_way():
    cloud, arguments = RNG.random((50, 3)), (np.array([0.1, 0.3, 0.2]), np.full(4, 0.1), np.full(2, 0.01))
    first, again, other = (_core.move_particles(cloud, *arguments, seed) for seed in (3, 3, 4))
    assert (first == again).all()
    assert not np.allclose(first, other)


def test_without_noise_particles_follow_the_motion():
    moved = _core.move_particles(
        np.array([(1.0, 1.0, math.pi / 2)]), np.array([0.0, 2.0, 0.5]), np.zeros(4), np.zeros(2), 1
    )
    assert np.allclose(moved, [(1.0, 3.0, math.pi / 2 + 0.5)])


def test_weights_are_sums_over_the_table():
    table = RNG.random((40, 60)).astype(np.float32)
    particles = np.column_stack([RNG.uniform(-0.5, 3.5, (60, 2)), RNG.uniform(-4, 4, 60)])
    points = RNG.uniform(-1.0, 1.0, (25, 2))
    found = _core.weigh_particles(table, CELL, -2.0, particles, points)
    assert np.allclose(found, oracle.weigh_particles(table, CELL, -2.0, particles, points))


def picked(ranges, most=20, offset=0.3, poses=((0.1, 0.2, 0.3), (0.1, 0.2, 0.3)), body=None):
    angles = np.linspace(-3.0, 3.0, len(ranges))
    sides = np.array([(1.0, 0.0, 0.4), (-1.0, 0.0, 0.4), (0.0, 1.0, 0.3), (0.0, -1.0, 0.3)]) if body is None else body
    return np.asarray(ranges), angles, np.array((0.2, 0.1, 0.5)), np.array(poses), sides, 0.05, 9.0, most, offset


MOVING = ((0.1, 0.2, 3.1), (0.3, 0.2, -3.1))


@pytest.mark.parametrize("poses", [((0.1, 0.2, 0.3), (0.1, 0.2, 0.3)), MOVING])
@pytest.mark.parametrize("most", [7, 90, 1000])
def test_beams_are_picked_placed_and_kept_off_the_body(poses, most):
    ranges = RNG.uniform(0.0, 3.0, 90)
    ranges[::7], ranges[3], ranges[4] = math.inf, math.nan, 9.0
    arguments = picked(ranges, most, poses=poses)
    found, expected = _core.pick_beams(*arguments), oracle.pick_beams(*arguments)
    assert 0 < len(found[0]) <= most
    for one, other in zip(found, expected, strict=True):
        assert np.allclose(one, other)


def test_no_beams_are_picked_of_a_scan_without_returns():
    points, sensors = _core.pick_beams(*picked(np.full(30, math.inf)))
    assert points.shape == sensors.shape == (0, 2)


def surfaces(seed=0):
    rng = np.random.default_rng(seed)
    counts, means = rng.uniform(0, 5, (20, 30)).astype(np.float32), rng.normal(0, 0.1, (20, 30)).astype(np.float32)
    pose = (1.5, 1.1, 0.3)
    return (FIELD, CELL, LIMIT, rays_from(pose) * rng.uniform(0.9, 1.1, (90, 1)), np.array(pose), counts, means, 0.1)


def test_beams_are_expected_where_they_were_seen_before():
    arguments = (*surfaces(), 0.01, np.array((0.35, 0.04, 0.03, 0.9, 2.0)))
    found = _core.expect_surfaces(*arguments)
    assert np.allclose(found, oracle.expect_surfaces(*arguments), atol=1e-7)
    assert len(np.unique(found.round(6))) > 20


def test_patches_learn_how_far_off_beams_end():
    *given, counts, means, edge = surfaces()
    expected = oracle.learn_surfaces(*given, counts, means, edge, 0.35, 4.0)
    before = means.copy()
    _core.learn_surfaces(*given, counts, means, edge, 0.35, 4.0)
    assert (before != means).sum() > 20
    assert counts.max() == pytest.approx(expected[0].max())
    for one, other in zip((counts, means), expected, strict=True):
        assert np.allclose(one, other, atol=1e-6)


def test_the_peak_is_the_mean_of_the_particles_round_the_heaviest():
    cloud = np.column_stack([RNG.normal(1.0, 0.3, (200, 2)), math.pi + RNG.normal(0.0, 0.2, 200)])
    weights = RNG.random(200)
    found = _core.peak_particle(cloud, weights, 0.3, 0.2)
    assert np.allclose(found, oracle.peak_particle(cloud, weights, 0.3, 0.2))
    assert not np.allclose(found, cloud[weights.argmax()])


def test_particles_are_drawn_in_proportion_to_their_weights():
    cloud = np.column_stack([np.arange(100) * 10.0, np.zeros(100), np.zeros(100)])
    weights = RNG.random(100)
    drawn = _core.resample_particles(cloud, weights, np.array([0.5, 0.2]), np.array([2000.0, 2000.0, 0.05, 2.3]), 9)
    counts = np.bincount((drawn[:, 0] / 10.0).astype(int), minlength=100)
    assert len(drawn) == 2000
    assert (np.abs(counts - 2000 * weights / weights.sum()) <= 1.0).all()  # systematic: at most one off


@pytest.mark.parametrize(("bins", "expected"), [(1, 50), (10, None), (300, 2000)])
def test_as_many_particles_are_drawn_as_their_spread_needs(bins, expected):
    cloud = np.column_stack([10.0 * (np.arange(3000) % bins), np.zeros(3000), np.zeros(3000)])
    drawn = _core.resample_particles(
        cloud, np.ones(3000), np.array([0.5, 0.2]), np.array([50.0, 2000.0, 0.05, 2.33]), 1
    )
    if expected is None:
        k = bins - 1
        expected = math.ceil(k / 0.1 * (1 - 2 / (9 * k) + math.sqrt(2 / (9 * k)) * 2.33) ** 3)
    assert len(drawn) == expected


@pytest.mark.parametrize("pose", [(1.5, 1.1, 0.3), (0.6, 0.5, -2.0), (2.2, 0.9, 1.6)])
def test_a_scan_is_matched_where_it_was_taken(pose):
    start = np.array([pose]) + np.array((0.06, -0.05, 0.04))
    weak = np.eye(3)[np.newaxis] * 1e3
    points = rays_from(pose)
    found, covariances, told = _core.match_scan(
        FIELD, CELL, LIMIT, points, np.zeros((1, len(points))), start, start, weak, SETTINGS
    )
    assert np.abs(found[0] - pose).max() < 0.004
    assert (np.linalg.eigvalsh(covariances[0]) > 0.0).all()
    assert told[0, 0] > 0.95 * len(points)


def test_a_match_is_the_least_of_the_robust_cost():
    pose = np.array((1.5, 1.1, 0.3))
    points = rays_from(pose, 60)
    points[::9] *= 0.6  # something that is not on the map
    targets = np.where(np.arange(60) < 20, -0.02, 0.0)
    prior, information = pose + np.array((0.03, 0.02, -0.02)), np.diag((900.0, 900.0, 2000.0))
    found, _, _ = _core.match_scan(
        *(FIELD, CELL, LIMIT, points, targets[np.newaxis], prior[np.newaxis], prior[np.newaxis]),
        *(np.linalg.inv(information)[np.newaxis], SETTINGS),
    )
    expected = oracle.best_pose(FIELD, CELL, LIMIT, points, targets, prior, information, 0.02, 0.1, 1000.0)
    assert np.abs(found[0] - expected).max() < 1e-3


def test_without_points_the_prior_stays():
    prior = np.array([(1.0, 1.0, 0.5)])
    covariance = np.array(((0.4, 0.1, -0.05), (0.1, 0.3, 0.02), (-0.05, 0.02, 0.1)))
    found, covariances, _ = _core.match_scan(
        FIELD, CELL, LIMIT, np.zeros((0, 2)), np.zeros((1, 0)), prior, prior, covariance[np.newaxis], SETTINGS
    )
    assert np.allclose(found, prior)
    assert np.allclose(covariances, covariance)


def test_beams_agree_end_before_or_go_through():
    pose = (1.5, 1.1, 0.3)
    points = rays_from(pose)
    poses = np.array([pose, (1.5, 1.1, 1.2), (0.9, 1.5, -1.0), (5.0, 5.0, 0.0)])
    sensors = np.zeros_like(points)
    found = _core.judge_beams(FIELD, CELL, sensors, points, poses, 0.08, 0.1)
    expected = np.array(
        [
            [oracle.judge_beam(FIELD, CELL, s, p, at, 0.08, 0.1) for s, p in zip(sensors, points, strict=True)]
            for at in poses
        ]
    )
    assert (found[0] == 0).all()
    assert (found[3] == 3).all()
    assert (found != expected).mean() < 0.02  # beams that graze a corner


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_search_finds_the_best_of_all_poses(seed):
    rng = np.random.default_rng(seed)
    pose = (rng.uniform(0.4, 0.9), rng.uniform(0.4, 1.5), rng.uniform(-3.0, 3.0))
    points = rays_from(pose, 40)
    table = np.rint(255 * np.exp(-0.5 * (FIELD / 0.1) ** 2)).astype(np.uint8)
    free = 1 - ROOM
    window = np.array((0.0, 3.0, 0.0, 2.0, -math.pi, math.pi - 1e-9))
    poses, scores, complete = _core.search_poses(
        table, free, CELL, points, window, np.array([0.15, 50.0, 0.7, 0.4, 0.3]), 10, 10_000_000
    )
    assert complete
    yaws = -math.pi + 0.15 * np.arange(math.ceil(2 * math.pi / 0.15 + 0.5))
    near = [yaw for yaw in yaws if abs(math.remainder(yaw - pose[2], 2 * math.pi)) < 0.4]
    rows, cols = (range(int(at / CELL) - 5, int(at / CELL) + 6) for at in (pose[1], pose[0]))
    cells = [(row, col) for row in rows for col in cols if 0 <= row < 40 and 0 <= col < 60 and free[row, col]]
    best = max(oracle.score(table, CELL, points, col, row, yaw) for row, col in cells for yaw in near)
    assert scores[0] >= best - 1e-9
    for (x, y, yaw), given in zip(poses, scores, strict=True):
        own = oracle.score(table, CELL, points, math.floor(x / CELL), math.floor(y / CELL), yaw)
        assert own == pytest.approx(given)


def test_a_symmetric_map_has_several_places():
    square = np.zeros((60, 60), np.uint8)
    square[:3] = square[-3:] = square[:, :3] = square[:, -3:] = 1
    field = _core.distance_field(square, CELL, 0.0, LIMIT)
    table = np.rint(255 * np.exp(-0.5 * (field / 0.1) ** 2)).astype(np.uint8)
    angles = np.linspace(-math.pi, math.pi, 60, endpoint=False)
    ranges = CELL * _core.cast_grid_rays(square, 18.0, 24.0, angles, 200.0)
    points = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])
    window = np.array((0.0, 3.0, 0.0, 3.0, -math.pi, math.pi - 1e-9))
    poses, scores, _ = _core.search_poses(
        table, 1 - square, CELL, points, window, np.array([0.026, 50.0, 0.9, 0.4, 0.3]), 10, 10_000_000
    )
    assert len(poses) == 4
    assert scores[-1] > 0.95 * scores[0]


MATCHED = np.zeros((1, 2)), np.zeros((1, 1)), np.zeros((1, 3)), np.zeros((1, 3))
BAD = [
    ("distance_field", (ROOM, 0.0, 0.0, 1.0)),
    ("distance_field", (ROOM, 0.1, 0.2, 1.0)),
    ("distance_field", (ROOM, 0.1, 0.0, math.nan)),
    ("distance_field", (ROOM[:0], 0.1, 0.0, 1.0)),
    ("field_at", (FIELD, CELL, 1.0, np.array([(math.nan, 0.0)]))),
    ("move_particles", (np.zeros((2, 2)), np.zeros(3), np.zeros(4), np.zeros(2), 1)),
    ("move_particles", (np.zeros((2, 3)), np.zeros(3), -np.ones(4), np.zeros(2), 1)),
    ("weigh_particles", (FIELD, CELL, 0.0, np.full((1, 3), math.inf), np.zeros((1, 2)))),
    ("resample_particles", (np.zeros((2, 3)), np.zeros(2), np.ones(2), np.array([1.0, 9.0, 0.1, 2.0]), 1)),
    ("resample_particles", (np.zeros((0, 3)), np.zeros(0), np.ones(2), np.array([1.0, 9.0, 0.1, 2.0]), 1)),
    ("match_scan", (FIELD, CELL, LIMIT, *MATCHED, -np.eye(3)[np.newaxis], SETTINGS)),
    ("pick_beams", picked(np.ones(9), most=0)),
    ("pick_beams", picked(np.ones(9), poses=MOVING[:1])),
    ("pick_beams", picked(np.ones(9), poses=((math.nan, 0.0, 0.0), (0.0, 0.0, 0.0)))),
    ("expect_surfaces", (*surfaces(), math.nan, np.array((0.35, 0.04, 0.03, 0.9, 2.0)))),
    ("expect_surfaces", (*surfaces(), 0.0, np.zeros(5))),
    ("learn_surfaces", (*surfaces()[:-1], 0.0, 0.35, 20.0)),
    ("learn_surfaces", (*surfaces()[:5], np.zeros((0, 3), np.float32), np.zeros((0, 3), np.float32), 0.1, 0.35, 20.0)),
    ("peak_particle", (np.zeros((0, 3)), np.zeros(0), 0.3, 0.2)),
    ("peak_particle", (np.zeros((2, 3)), np.full(2, math.nan), 0.3, 0.2)),
    ("judge_beams", (FIELD, CELL, np.zeros((1, 2)), np.zeros((2, 2)), np.zeros((1, 3)), 0.1, 0.1)),
]


@pytest.mark.parametrize(("name", "arguments"), BAD)
def test_bad_arguments_are_refused(name, arguments):
    with pytest.raises((ValueError, TypeError)):
        getattr(_core, name)(*arguments)
