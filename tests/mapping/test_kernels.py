"""The kernels of mapping against slow versions, SciPy and lines."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from mapping import kernel_oracles as oracle
from mapping.rooms import ANGLES, cast, ring
from trundle import Pose2D
from trundle._core import SurfaceMap, count_beams, draw_cells, find_normals, solve_graph

RNG = np.random.default_rng(1)


def test_normals_of_a_wall_point_to_the_sensor():
    points = np.column_stack((np.linspace(-2.0, 2.0, 60), np.full(60, 3.0)))
    normals = find_normals(points, np.zeros((60, 2)), 0.05, 0.15)
    assert np.allclose(normals, (0.0, -1.0))


def test_normals_are_those_of_the_slow_version():
    points = np.column_stack((np.cumsum(RNG.uniform(0.0, 0.2, 200)), RNG.normal(0.0, 0.05, 200)))
    sensors = RNG.uniform(-3.0, 3.0, (200, 2))
    assert np.allclose(find_normals(points, sensors, 0.02, 0.15), oracle.find_normals(points, sensors, 0.02, 0.15))


def graph(count: int = 60):
    truth = np.column_stack((np.cumsum(RNG.uniform(0.2, 0.6, (count, 2)), axis=0), RNG.uniform(-3.0, 3.0, count)))
    pairs = [(i, i + 1) for i in range(count - 1)] + [(5, 40), (50, 2), (10, 30)]
    edges = np.array(pairs, dtype=np.int32)
    exact = oracle.residuals(truth, edges, np.zeros((len(edges), 3)))
    transforms = exact + RNG.normal(0.0, 0.03, exact.shape)
    roots = RNG.normal(0.0, 1.0, (len(edges), 3, 3))
    information = roots @ roots.transpose(0, 2, 1) + 2.0 * np.eye(3)
    return truth, edges, transforms, 0.5 * (information + information.transpose(0, 2, 1))


def test_a_graph_is_solved_as_by_scipy():
    truth, edges, transforms, information = graph()
    fixed = (np.arange(len(truth)) == 0).astype(np.uint8)
    start = truth + RNG.normal(0.0, 0.02, truth.shape) * (np.arange(len(truth)) > 0)[:, None]
    found, errors, told = solve_graph(start, edges, transforms, information, np.zeros(len(edges)), fixed, 50)
    roots = np.linalg.cholesky(information).transpose(0, 2, 1)

    def residual(x):
        poses = np.vstack((truth[:1], x.reshape(-1, 3)))
        return np.einsum("eij,ej->ei", roots, oracle.residuals(poses, edges, transforms)).ravel()

    best = least_squares(residual, start[1:].ravel(), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    assert told[2] == pytest.approx(2.0 * best.cost, rel=1e-5)
    assert errors.sum() == pytest.approx(told[2])
    assert np.abs(found[1:, :2] - best.x.reshape(-1, 3)[:, :2]).max() < 1e-3


def test_a_wrong_loop_counts_for_little_where_edges_are_robust():
    poses = np.column_stack((np.arange(30) * 0.5, np.zeros(30), np.zeros(30)))
    edges = np.array([*[(i, i + 1) for i in range(29)], (0, 29)], dtype=np.int32)
    transforms = np.array([*[(0.5, 0.0, 0.0)] * 29, (2.0, 3.0, 1.0)])
    information = np.tile(np.eye(3) * 1e4, (30, 1, 1))
    fixed = (np.arange(30) == 0).astype(np.uint8)
    robust = np.where(np.arange(30) == 29, 3.0, 0.0)
    found, errors, _ = solve_graph(poses, edges, transforms, information, robust, fixed, 30)
    assert np.abs(found - poses).max() < 0.02
    assert errors[-1] > 100.0
    pulled, _, _ = solve_graph(poses, edges, transforms, information, np.zeros(30), fixed, 30)
    assert np.abs(pulled - poses).max() > 1.0


@pytest.mark.parametrize("spoiled", ["edge", "information", "pose"])
def test_a_graph_that_is_none_is_refused(spoiled):
    truth, edges, transforms, information = graph(60)
    if spoiled == "edge":
        edges[3, 1] = 60
    if spoiled == "information":
        information[3] = 0.0
    if spoiled == "pose":
        truth[3, 0] = math.nan
    with pytest.raises(ValueError, match=r"edge|definite|finite"):
        solve_graph(truth, edges, transforms, information, np.zeros(len(edges)), np.zeros(60, np.uint8), 5)


def room_surface(pose: Pose2D) -> tuple[np.ndarray, np.ndarray]:
    ranges = cast(pose)
    points = np.column_stack((ranges * np.cos(ANGLES), ranges * np.sin(ANGLES)))
    return points, find_normals(points, np.zeros_like(points), 0.07, 0.15)


def test_a_scan_is_matched_to_millimetres():
    known = SurfaceMap(0.1)
    for share in np.linspace(0.0, 0.1, 8):
        pose = ring(float(share))
        known.add(*room_surface(pose), np.array(pose.as_tuple()), 1)
    truth = np.array(ring(0.055).as_tuple())
    start = truth + np.array((0.08, -0.05, 0.02))
    points, normals = room_surface(ring(0.055))
    settings = np.array((0.2, 0.08, 0.03, 60.0, 20.0))
    poses, spreads, fits = known.match(points, normals, start[None], start, np.diag((0.1, 0.1, 0.1)) ** 2, settings)
    assert np.abs(poses[0] - truth).max() < 0.01
    assert fits[0, 0] > 0.9
    assert np.linalg.eigvalsh(spreads[0]).min() > 0.0


def test_a_search_finds_what_all_poses_give():
    known = SurfaceMap(0.1)
    pose = ring(0.2)
    points, normals = room_surface(pose)
    known.add(points, normals, np.array(pose.as_tuple()), 1)
    centre = np.array(pose.as_tuple()) + np.array((0.2, -0.1, 0.05))
    table, corner = known.table(0.1)
    best = -1.0
    for turn in range(-5, 6):
        for dy in range(-3, 4):
            for dx in range(-3, 4):
                at = centre + np.array((dx * 0.1, dy * 0.1, turn * 0.02))
                cells = np.floor(oracle.moved(points, at) / 0.1 + 1e-9).astype(int) - np.round(corner / 0.1).astype(int)
                inside = (cells >= 0).all(axis=1) & (cells < table.shape[::-1]).all(axis=1)
                best = max(best, (table[cells[inside][:, 1], cells[inside][:, 0]] / 127.5).astype(int).sum())
    found, share = known.search(points, centre, np.array((0.3, 0.1, 0.02)), np.array((1e3, 1e3)))
    assert share == pytest.approx(best / (2 * len(points)), abs=0.01)
    assert np.hypot(*(found - pose.as_tuple())[:2]) < 0.15


def test_what_is_taken_away_leaves_nothing():
    known = SurfaceMap(0.1)
    points, normals = room_surface(ring(0.3))
    at = np.array((1.0, 2.0, 0.3))
    known.add(points, normals, at, 1)
    assert known.table(0.1)[0].any()
    known.add(points, normals, at, -1)
    assert not known.table(0.1)[0].any()


def test_a_noisy_wall_is_drawn_one_cell_thick_between_free_and_unknown():
    counts = np.zeros((60, 60, 4), dtype=np.int32)
    for _ in range(30):
        x = RNG.uniform(0.2, 2.8, 200)
        points = np.column_stack((x, 2.0 + RNG.normal(0.0, 0.02, 200)))
        sensors = np.tile((1.5, 0.3), (200, 1))
        count_beams(counts, sensors, points, np.ones(200, np.uint8), np.zeros(2), 0.05, 0.1, 1)
    cells = draw_cells(counts, np.array((2.0, 0.1, 1.0)))
    wall = (cells >= 65).sum(axis=0)[6:54]
    assert (wall == 1).mean() > 0.9
    assert (wall >= 1).all()
    assert (cells[10, 28:32] == 0).all()
    assert (cells[45:] == -1).all()


def test_beams_count_as_on_fine_points_of_them():
    sensors, points = RNG.uniform(-1.0, 3.0, (60, 2)), RNG.uniform(-1.0, 3.0, (60, 2))
    beams = sensors, points, (RNG.random(60) < 0.5).astype(np.uint8), np.zeros(2), 0.1, 0.15
    counts = np.zeros((20, 20, 4), dtype=np.int32)
    count_beams(counts, *beams, 1)
    least, most = oracle.count_beams(counts.shape, *beams)
    assert (counts[..., 0] == most[..., 0]).all()
    assert (counts[..., 1] >= least).all()
    assert (counts[..., 1] <= most[..., 1]).all()


def test_a_wall_on_the_border_of_two_cells_leaves_nothing_unknown_before_it():
    counts = np.zeros((60, 60, 4), dtype=np.int32)
    for _ in range(30):
        x = RNG.uniform(0.2, 2.8, 200)
        points = np.column_stack((x, 2.0 + 0.02 * (x - 1.5) + RNG.normal(0.0, 0.01, 200)))
        count_beams(counts, np.tile((1.5, 0.3), (200, 1)), points, np.ones(200, np.uint8), np.zeros(2), 0.05, 0.1, 1)
    cells = draw_cells(counts, np.array((2.0, 0.1, 1.0)))
    for col in range(6, 54):
        wall = np.flatnonzero(cells[:, col] >= 65)
        assert 0 <= cells[wall[0] - 1, col] <= 20
        assert cells[wall[-1] + 1, col] == -1
