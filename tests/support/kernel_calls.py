"""One call of each kernel on a small input, and a program that makes them from several threads at once.

    python -m support.kernel_calls NAME ...

prints each name whose answers were the same in all threads as in one.
"""

from __future__ import annotations

import math
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from support.crowd_calls import CROWD_CALLS
from support.mission_calls import MISSION_CALLS, WAY
from support.mppi_values import arguments_of
from trundle import _core

KERNELS = sorted(name for name in vars(_core) if not name.startswith("_"))
THREADS, CALLS = 4, 150
RNG = np.random.default_rng(0)
SIDE = 24
BLOCKED = np.ascontiguousarray(RNG.random((SIDE, SIDE)) < 0.2, dtype=np.uint8)
BLOCKED[0], BLOCKED[-1], BLOCKED[:, 0], BLOCKED[:, -1] = 0, 0, 0, 0
COSTS = np.where(BLOCKED, 254, 0).astype(np.uint8)
START, GOAL = (0, 0), (SIDE - 1, SIDE - 1)
ENDS = np.array([START] * 4), np.array([GOAL] * 4)
LINE_WEIGHTS = np.where(np.arange(256) < 253, 1.0, 0.0)
OUTLINE = np.array([(0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.2, -0.1)])
POSES = np.column_stack([RNG.uniform(0, 2.4, (20, 2)), RNG.uniform(-3, 3, 20)])
OPEN = np.zeros((SIDE, SIDE), np.uint8)
FIRST_FIXED = (np.arange(20) == 0).astype(np.uint8)
UNKNOWN = np.where(BLOCKED, 100, -1).astype(np.int8)
BAND = 0.1, 0.6, 0.1, 1e-6  # heights, resolution, depth
VERTICES = np.array([(x, y, z) for x in (0.31, 1.27) for y in (0.33, 1.42) for z in (0.0, 0.8)])
FACES = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
     (1, 5, 7), (1, 7, 3)], dtype=np.int32
)  # fmt: skip
MESH = VERTICES, FACES, np.eye(3, 4)
HEIGHTS = np.zeros((2, 2)), 2.0 * SIDE, -1.0, -1.0, 0.1, SIDE, SIDE
HYBRID = {
    "radius": 0.3,
    "reverse": True,
    "in_place": False,
    "reverse_penalty": 2.0,
    "change_cost": 0.3,
    "turn_cost": 0.5,
    "cost_weight": 2.0,
    "heuristic_weight": 1.2,
    "cell_size": 0.1,
}
SMOOTH = {
    "radius": 0.4,
    "reverse_penalty": 2.0,
    "change_cost": 0.3,
    "turn_cost": 0.5,
    "cost_weight": 4.0,
    "curve_weight": 0.1,
    "cost_tolerance": 0.02,
    "step": 0.03,
    "spacing": 0.05,
}
EVIDENCE = np.zeros((SIDE, SIDE), np.uint8)
MARKS = np.where(BLOCKED, 128 + 20, 1).astype(np.uint8)
HIT_POINTS = np.full((SIDE, SIDE, 2), 99, np.uint8)
HIT_TIMES = np.zeros((SIDE, SIDE))
SCAN = (
    *(0, 0, 0.1, np.array([(1.2, 1.3, 0.4)]), np.linspace(-3, 3, 60), RNG.uniform(0.2, 2.0, 60), np.zeros((0, 2))),
    *(np.array([0.0, 2.0, 0.0, 1.5, 0.0, 2.0]), True, 5, 1, 0.0),
)
GRID = _core.BinaryGrid(BLOCKED, 8, "jps")
LEAST_COST = _core.LeastCost(LINE_WEIGHTS)
HYBRID_ASTAR = _core.HybridAStar(**HYBRID)
SMOOTHER = _core.PathSmoother()
MPPI_NUMBERS = (
    *(np.array([1.2, 1.2, 0.3, 0.0, 0.0, 0.0, 0.0]), np.zeros((10, 2), np.float32)),
    *(np.array([0.05, -0.2, 0.5, 1.0, 1.0, 1.0, 2.0]), np.array([0.2, 0.3, 0.1, 1.0, 1.0]), np.array([(0.0, 0.1)])),
    *(COSTS, RNG.random((SIDE, SIDE), np.float32), 0.1, 0.01, np.array([2.0, 2.0, 1.0, 1.0, 0.5, 0.2, 1.0])),
    *(np.array([(1.0, 0.5, 0.1, 0.0, 0.2, 0.01, 0.01)]), np.ones(15), np.ones(5)),
)
MPPI_STEP = arguments_of(*MPPI_NUMBERS)
RIM = 2.0 * np.column_stack([np.cos(np.linspace(-3.0, 3.0, 60)), np.sin(np.linspace(-3.0, 3.0, 60))])
TURN = (np.arange(60) % 7 + 1.0, np.arange(60) * 0.1, np.zeros((1, 3)), np.array([0.0, 0.0, 0.0, 0.0, 9.0]))
TRACKER = _core.ScanTracker(np.array([15.0, 3.0, 1.0, 0.07, 0.6, 0.2, 2.0, 0.8, 1.5]), OUTLINE)
TRACKER.see(0, 0.0, *TURN)
MPPI = _core.Mppi(128, 10, 3)
MPPI.step(*MPPI_STEP)


CLOUD = np.column_stack([RNG.uniform(0.2, 2.2, (300, 2)), RNG.uniform(-3.0, 3.0, 300)])
FIELD = _core.distance_field(BLOCKED, 0.1, 0.0, 0.8)
ENDS_SEEN = RNG.uniform(-1.0, 1.0, (40, 2))
SURFACES = (
    *(FIELD, 0.1, 0.8, ENDS_SEEN, np.array([1.2, 1.2, 0.4])),
    *(RNG.uniform(0, 9, (12, 12)).astype(np.float32), RNG.uniform(-0.2, 0.2, (12, 12)).astype(np.float32), 0.2),
)
FIT = np.clip(255.0 - 400.0 * np.abs(FIELD), 0, 255).astype(np.uint8)


def marked(kernel: Callable[..., Any], cells: Any, *arguments: Any) -> Any:
    """What a kernel returns, and what it made of its first argument."""
    cells = cells.copy()
    return kernel(cells, *arguments), cells


JUMPS = _core.chebyshev_field(BLOCKED)
MANY = _core.Batch(
    *(JUMPS.ravel(), np.array([JUMPS.shape]), np.zeros((1, 3)), 0.1, OUTLINE),
    *(np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1, 0.3, 9.0, 0.01]), np.array([(0.0, 0.0, 0.0, 0.0, 2.0)])),
    *(np.array([20]), np.linspace(-3.0, 3.0, 20), np.zeros((0, 2)), np.zeros(0, np.int64), np.zeros(0)),
    *(np.zeros((0, 1, 3)), np.array([0]), 1.0),
)
MANY_PLACES = np.tile(np.array([0, -1]), (20, 1)), np.ones(20, bool)


def drive_many() -> Any:
    state = (
        *(POSES.copy(), np.zeros((20, 6)), np.zeros((20, 2)), np.zeros(20), np.zeros(20, np.int64)),
        np.zeros((20, 4), np.int64),
    )
    MANY.drive(*state, np.ones((20, 2)), *MANY_PLACES, 5, 2)
    return state


def scan_many() -> Any:
    ranges = np.zeros((20, 20))
    noise = np.full((20, 2), 0.1), np.arange(20, dtype=np.uint64)
    MANY.scan(ranges, POSES, np.zeros(20, np.int64), *MANY_PLACES, *noise, 2)
    return ranges


def counted() -> Any:
    """Beams counted in cells."""
    counts = np.zeros((SIDE, SIDE, 4), dtype=np.int32)
    _core.count_beams(counts, np.ones((40, 2)), ENDS_SEEN, np.ones(40, np.uint8), np.zeros(2), 0.1, 0.1, 1)
    return counts


def filled() -> Any:
    """A surface map of one scan."""
    known = _core.SurfaceMap(0.1)
    known.add(ENDS_SEEN, np.tile((1.0, 0.0), (40, 1)), POSES[0], 1)
    return known


def surfaces() -> Any:
    """What a surface map answers."""
    known, normals = filled(), np.tile((1.0, 0.0), (40, 1))
    settings = np.array([0.2, 0.08, 0.03, 60.0, 10.0])
    return known.match(ENDS_SEEN, normals, POSES[:2], POSES[0], np.eye(3), settings), known.table(0.1)


def step_mppi() -> Any:
    state, controls, *others = MPPI_STEP
    controls = controls.copy()
    return MPPI.step(state, controls, *others), controls


def mppi_arguments() -> list[str]:
    return [type(one).__name__ for one in arguments_of(*MPPI_NUMBERS)]


def painted_marks() -> Any:
    cells = UNKNOWN.copy()
    _core.paint_marks(MARKS, HIT_POINTS, 0, 0, 0.1, cells, OPEN, 0.3, 0.2, 0.4, 0.1, True)
    return cells


def repainted_marks() -> Any:
    cells, (rows, cols) = UNKNOWN.copy(), UNKNOWN.shape
    window = 1, rows, 0, cols - 1
    box = _core.repaint_marks(MARKS, HIT_POINTS, 0, 0, 0.1, cells, UNKNOWN, OPEN, window, 0.3, 0.2, 0.4, 0.1, True)
    return cells, box


def updated() -> Any:
    grid = _core.BinaryGrid(OPEN, 8, "auto")
    grid.update(0, 0, BLOCKED)
    return grid.find_path(START, GOAL, None, None)


def planes() -> Any:
    return _core.floor_planes(*HEIGHTS)


# What each of them calls is in its name.
CALLS_OF: dict[str, Callable[[], Any]] = {
    "BinaryGrid": lambda: _core.BinaryGrid(BLOCKED, 8, "jps").bytes,
    "BinaryGrid.find_path": lambda: GRID.find_path(START, GOAL, 10.0, None),
    "BinaryGrid.find_point_path": lambda: GRID.find_point_path(START, GOAL, 10.0, None),
    "BinaryGrid.find_paths": lambda: GRID.find_paths(*ENDS, 2, 10.0, None),
    "BinaryGrid.find_point_paths": lambda: GRID.find_point_paths(*ENDS, 2, 10.0, None),
    "BinaryGrid.settle_ends": lambda: GRID.settle_ends(*ENDS, 1.0, 1.0, True),
    "BinaryGrid.update": updated,
    "BinaryGrid.method": lambda: GRID.method,
    "BinaryGrid.clutter": lambda: GRID.clutter,
    "BinaryGrid.bytes": lambda: GRID.bytes >= 0,
    "walk_corners": lambda: _core.walk_corners(np.array([(0, 0), (20, 20), (20, 3)], np.int32)),
    "label_components": lambda: _core.label_components(BLOCKED, True),
    "mark_gaps": lambda: _core.mark_gaps(BLOCKED, 6.0),
    "cost_field": lambda: _core.cost_field(COSTS, np.array([GOAL]), 8, 2, 10.0, None),
    "eikonal_field": lambda: _core.eikonal_field(
        COSTS, np.where(np.arange(256) < 253, 1.0, np.inf).astype(np.float32), np.array([GOAL]), np.zeros(1), 3, 3, 5.0
    ),
    "footprint_collides": lambda: _core.footprint_collides(COSTS, 0.1, 0.0, 0.0, 0.0, OUTLINE, POSES),
    "footprint_sweep": lambda: _core.footprint_sweep(COSTS, 0.1, 0.0, 0.0, 0.0, OUTLINE, POSES[:10], POSES[10:]),
    "footprint_clearance": lambda: _core.footprint_clearance(COSTS, 0.1, 0.0, 0.0, 0.0, OUTLINE, POSES, 1.0),
    "grid_search": lambda: _core.grid_search(
        COSTS, np.where(np.arange(256) < 253, 1, 0).astype(np.uint16), START, GOAL, 8, 10.0, None
    ),
    "cast_grid_rays": lambda: _core.cast_grid_rays(BLOCKED, 12.0, 0.5, np.linspace(0.0, 6.0, 40), 30.0),
    "cast_jumping_rays": lambda: _core.cast_jumping_rays(JUMPS, 12.0, 0.5, np.linspace(0.0, 6.0, 40), 30.0),
    "chebyshev_field": lambda: _core.chebyshev_field(BLOCKED),
    "Batch": lambda: type(MANY).__name__,
    "Batch.drive": drive_many,
    "Batch.scan": scan_many,
    **CROWD_CALLS,
    **MISSION_CALLS,
    "polyline_distances": lambda: _core.polyline_distances(POSES[:, :2].copy(), WAY[:, :2].copy()),
    "stopping_poses": lambda: _core.stopping_poses(
        *(1.0, 2.0, 0.3, 0.8, 0.1, 1.0, 0.4, 1.2, 0.5, 2.0, 2.5, 8.0, 0.05, 0.03)
    ),
    "outline_distances": lambda: _core.outline_distances(OUTLINE[None] + POSES[:, None, :2], OUTLINE[None]),
    "HybridAStar": lambda: _core.HybridAStar(**HYBRID).bytes,
    "HybridAStar.plan": lambda: HYBRID_ASTAR.plan(
        OPEN, 0.1, OUTLINE, np.array([0.5, 0.5, 0.0]), np.array([1.8, 1.8, 2.0]), False, 0.02, 0.05, 500, 10.0, None
    ),
    "HybridAStar.bytes": lambda: HYBRID_ASTAR.bytes >= 0,
    "inflate": lambda: _core.inflate(UNKNOWN, np.arange(10, 0, -1, dtype=np.uint8)),
    "flood_free": lambda: marked(_core.flood_free, UNKNOWN, np.array([START])),
    "flood_largest": lambda: marked(_core.flood_largest, UNKNOWN),
    "flood_poses": lambda: _core.flood_poses(
        COSTS, 0.1, OUTLINE, POSES[0], False, POSES[1], True, 0.05, 40, 5_000, 10.0, None
    ),
    "floor_planes": planes,
    "line_costs": lambda: _core.line_costs(COSTS, LINE_WEIGHTS, POSES[:, :2].copy(), POSES[::-1, :2].copy()),
    "shortcut": lambda: _core.shortcut(COSTS, LINE_WEIGHTS, np.array([(0.5, 0.5), (5.5, 0.5), (5.5, 8.5)])),
    "LeastCost": lambda: _core.LeastCost(LINE_WEIGHTS).bytes,
    "LeastCost.find": lambda: LEAST_COST.find(COSTS, START, GOAL, np.array([(0.5, 0.5), (23.5, 23.5)]), 10.0, None),
    "LeastCost.bytes": lambda: LEAST_COST.bytes >= 0,
    "cast_outline_rays": lambda: _core.cast_outline_rays(
        np.array([(2.0, -1.0, 2.0, 1.0)]), np.array([(-2.0, 0.0, 0.5)]), 0.0, 0.0, 0.0, 0.1, 60, 10.0
    ),
    "ScanTracker": lambda: _core.ScanTracker(np.ones(9), OUTLINE) is not None,
    "ScanTracker.see": lambda: TRACKER.see(0, 0.0, *TURN),
    "ScanTracker.tracks": lambda: TRACKER.tracks(0.5),
    "find_lone_hits": lambda: _core.find_lone_hits(
        np.where(np.arange(90) % 9 == 0, 2.0, 5.0),
        np.linspace(-3.0, 3.0, 90),
        np.zeros((1, 3)),
        np.full(90, 5.0),
        np.linspace(-3.0, 3.0, 90),
        np.zeros((1, 3)),
        0.1,
        12.0,
    ),
    "measure_ranges": lambda: _core.measure_ranges(np.full(90, 2.0), np.linspace(-3.0, 3.0, 90), 0.1, 0.1, 2.1),
    "drive_period": lambda: _core.drive_period(
        np.zeros(11), 0.5, 0.2, np.array([1.0, 0.5, 2.0, 0.01, 0.02, 0.14, 0.4, 9.0, 0.005]), 10
    ),
    "place_scan": lambda: _core.place_scan(
        *(np.full(90, 2.0), np.linspace(-3.0, 3.0, 90), np.array((0.1, 0.0, 0.0)), np.array((1.0, 2.0, 0.5))),
        *(np.array([(1.0, 0.0, 0.4), (-1.0, 0.0, 0.4)]), 0.1, 12.0, np.zeros(3), *np.zeros((2, 0)), np.zeros(3)),
    ),
    "find_moved": lambda: _core.find_moved(
        *(RIM + 0.3, np.zeros(3), np.linspace(-3.0, 3.0, 60), np.full(60, 9.0)),
        *(RIM, np.zeros(3), np.linspace(-3.0, 3.0, 60), np.full(60, 9.0)),
        0.25,
    ),
    "points_around": lambda: _core.points_around(RIM, 0.1 * RIM, np.array((1.0, 0.5, 0.2)), 0.3, 2.0, 1.0),
    "outline_clearances": lambda: _core.outline_clearances(
        *(RIM, 0.1 * RIM, POSES, np.linspace(0.0, 1.0, 20), np.array([(0.3, -0.2), (0.3, 0.2), (-0.1, 0.0)])),
        *(np.array([(1.0, 0.0, 0.3), (-0.4, 0.9, 0.1), (-0.4, -0.9, 0.1)]), 0.1, 3),
    ),
    "distance_field": lambda: _core.distance_field(BLOCKED, 0.1, 0.05, 0.8),
    "field_at": lambda: _core.field_at(FIELD, 0.1, 0.8, POSES[:, :2].copy()),
    "move_particles": lambda: _core.move_particles(CLOUD, np.array([0.1, 0.2, 0.1]), np.ones(4), np.ones(2), 7),
    "pick_beams": lambda: _core.pick_beams(
        *(np.linspace(0.3, 2.0, 200), np.linspace(-3.0, 3.0, 200), np.zeros(3), POSES[:2].copy()),
        *(np.array([(1.0, 0.0, 0.2)]), 0.1, 1.9, 60, 0.5),
    ),
    "expect_surfaces": lambda: _core.expect_surfaces(*SURFACES, 0.01, np.array([0.35, 0.04, 0.03, 0.9, 2.0])),
    "learn_surfaces": lambda: marked(
        lambda means: _core.learn_surfaces(*SURFACES[:5], SURFACES[5].copy(), means, 0.2, 0.3, 20.0), SURFACES[6]
    ),
    "peak_particle": lambda: _core.peak_particle(CLOUD, np.linspace(0.0, 1.0, 300), 0.8, 0.4),
    "weigh_particles": lambda: _core.weigh_particles(FIELD, 0.1, -1.0, CLOUD, ENDS_SEEN),
    "resample_particles": lambda: _core.resample_particles(
        CLOUD, np.linspace(0.0, 1.0, 300), np.array([0.5, 0.2]), np.array([50.0, 500.0, 0.05, 2.3]), 7
    ),
    "match_scan": lambda: _core.match_scan(
        FIELD,
        0.1,
        0.8,
        ENDS_SEEN,
        np.zeros((20, 40)),
        POSES,
        POSES,
        np.tile(np.eye(3), (20, 1, 1)),
        np.array([0.3, 0.1, 0.05, 30.0, 8.0]),
    ),
    "judge_beams": lambda: _core.judge_beams(FIELD, 0.1, np.zeros((40, 2)), ENDS_SEEN, POSES, 0.1, 0.2),
    "search_poses": lambda: _core.search_poses(
        FIT,
        OPEN + 1,
        0.1,
        ENDS_SEEN,
        np.array([0.0, 2.4, 0.0, 2.4, -3.0, 3.0]),
        np.array([0.1, 20.0, 0.7, 0.5, 0.3]),
        5,
        100_000,
    ),
    "SurfaceMap": lambda: surfaces(),
    "SurfaceMap.add": lambda: surfaces(),
    "SurfaceMap.match": lambda: surfaces(),
    "SurfaceMap.search": lambda: filled().search(ENDS_SEEN, POSES[0], np.array([0.1, 0.1, 0.05]), np.array([0.1, 0.1])),
    "SurfaceMap.table": lambda: filled().table(0.2),
    "SurfaceMap.memory": lambda: filled().memory,
    "find_normals": lambda: _core.find_normals(ENDS_SEEN, np.zeros((40, 2)), 0.1, 0.5),
    "solve_graph": lambda: _core.solve_graph(
        POSES,
        np.array([(i, i + 1) for i in range(19)], np.int32),
        np.tile((0.4, 0.0, 0.1), (19, 1)),
        np.tile(np.eye(3), (19, 1, 1)),
        np.zeros(19),
        FIRST_FIXED,
        5,
    ),
    "count_beams": lambda: counted(),
    "draw_cells": lambda: _core.draw_cells(counted(), np.array([1.0, 0.1, 1.0])),
    "mark_scan": lambda: marked(_core.mark_scan, EVIDENCE, HIT_POINTS.copy(), HIT_TIMES.copy(), *SCAN),
    "unmark_before": lambda: marked(_core.unmark_before, MARKS, HIT_TIMES, 1.0, 5, 2),
    "unmark_within": lambda: marked(_core.unmark_within, MARKS, HIT_POINTS, 0, 0, 0.1, OUTLINE + 1.0, 5, 2),
    "paint_marks": painted_marks,
    "repaint_marks": repainted_marks,
    "png_unfilter": lambda: _core.png_unfilter(np.full((8, 9), 4, np.uint8), 1),
    "raster_hexahedra": lambda: marked(_core.raster_hexahedra, UNKNOWN, VERTICES[np.newaxis], *BAND, False),
    "raster_discs": lambda: marked(_core.raster_discs, UNKNOWN, np.array([(1.0, 1.0, 0.5)]), *BAND[2:], False),
    "raster_cylinders": lambda: marked(
        _core.raster_cylinders, UNKNOWN, np.array([(1.0, 1.0, 0.3, 0.6, 0.0, 0.8, 0.2, 1.0)]), *BAND, False
    ),
    "raster_mesh": lambda: marked(_core.raster_mesh, UNKNOWN, *MESH, *BAND, False, True),
    "raster_thin_faces": lambda: marked(_core.raster_thin_faces, UNKNOWN, *MESH, *BAND),
    "raster_mesh_over_floor": lambda: marked(_core.raster_mesh_over_floor, UNKNOWN, planes(), *MESH, *BAND, False),
    "raster_thin_faces_over_floor": lambda: marked(_core.raster_thin_faces_over_floor, UNKNOWN, planes(), *MESH, *BAND),
    "shortest_curves": lambda: _core.shortest_curves(POSES[:10], POSES[10:], 0.4, True),
    "PathSmoother": _core.PathSmoother,
    "PathSmoother.smooth": lambda: SMOOTHER.smooth(
        OPEN, 0.1, OUTLINE, np.array([(0.5, 0.5, 0.0), (1.0, 0.5, 0.0), (1.5, 0.7, 0.0)]), OPEN[0, :2], **SMOOTH
    ),
    **{f"Mppi{part}": mppi_arguments for part in ("Aim", "Critics", "Limits", "Noise", "State", "Window")},
    "Mppi": lambda: _core.Mppi(128, 10, 3, "base").level,
    "Mppi.level": lambda: MPPI.level,
    "Mppi.step": step_mppi,
    "Mppi.costs": lambda: MPPI.costs(),
    "Mppi.rollouts": lambda: MPPI.rollouts(5),
    "draw_triangles": lambda: _core.draw_triangles(
        np.array([[(-1.0, -1.0, 2.0), (1.0, -1.0, 2.0), (0.0, 1.0, 3.0)]]), 32, 24, 20.0, 0.1, True
    ),
}


def is_same(a: Any, b: Any) -> bool:
    if isinstance(a, tuple):
        return len(a) == len(b) and all(is_same(own, other) for own, other in zip(a, b, strict=True))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    return a == b or type(a) is type(b) is _core.PathSmoother or (a != a and b != b)


def call_from_threads(call: Callable[[], Any]) -> bool:
    """Whether every thread got what one alone gets, beside one that keeps the interpreter busy."""
    expected = call()
    same: list[bool] = []

    def repeat() -> None:
        same.extend(is_same(expected, call()) for _ in range(CALLS))

    threads = [threading.Thread(target=repeat) for _ in range(THREADS)]
    for thread in threads:
        thread.start()
    number = 0.0
    while any(thread.is_alive() for thread in threads):
        number = math.sqrt(number + 1.0)
    return len(same) == THREADS * CALLS and all(same)


if __name__ == "__main__":
    sys.setswitchinterval(1e-6)
    for name in sys.argv[1:]:
        if call_from_threads(CALLS_OF[name]):
            print(name, flush=True)  # noqa: T201
