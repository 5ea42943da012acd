"""Requests to `Mppi`: a robot in an empty window, and random ones among obstacles and movers."""

from __future__ import annotations

import dataclasses

import numpy as np

from support.mppi_values import Request
from trundle._core import inflate
from trundle.geometry import FloatArray

SIDE, CELL, UNIT = 80, 0.05, 0.01
TABLE = np.clip(254 - np.round(np.sqrt(np.arange(30 * 30 + 1)) * CELL / UNIT), 1, 254).astype(np.uint8)
EMPTY = Request(
    samples=512,
    steps=56,
    knot_steps=7,
    state=np.array([2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    controls=np.zeros((56, 2), np.float32),
    model=np.array([0.05, -0.4, 0.8, 1.0, 2.0, 2.0, 3.0]),
    noise=np.array([0.3, 0.5, 0.05, 1.0, 1.0]),
    discs=np.array([(0.0, 0.2)]),
    nearness=np.zeros((SIDE, SIDE), np.uint8),
    to_go=np.zeros((SIDE, SIDE), np.float32),
    resolution=CELL,
    unit=UNIT,
    goal=np.array([3.0, 2.0, 0.0, 0.0, 1.0, 0.3, 1.0]),
    movers=np.zeros((0, 7)),
    weights=np.array([1000, 50, 1, 1, 3, 8, 5, 0.3, 0.3, 5, 4, 0.05, 0.1, 0.1, 1], float),
    bounds=np.array([0.3, 0.3, 2.0, 0.6, 10.0]),
)


def distances(x: float, y: float) -> FloatArray:
    """From each cell's centre [m]."""
    rows, cols = np.mgrid[:SIDE, :SIDE]
    return np.hypot((cols + 0.5) * CELL - x, (rows + 0.5) * CELL - y)


def request_of(goal: tuple[float, float], direction: float = 1.0, goal_yaw: float | None = None) -> Request:
    """An empty window with a robot at (2, 2) that looks along x."""
    yaw, has_yaw = (0.0, 0.0) if goal_yaw is None else (goal_yaw, 1.0)
    values = np.array([*goal, yaw, has_yaw, 1.0, 0.3, direction])
    return dataclasses.replace(EMPTY, goal=values, to_go=distances(*goal).astype(np.float32))


def random_request(rng: np.random.Generator) -> Request:
    """A robot of one to four discs on its way among boxes and movers."""
    occupied = np.zeros((SIDE, SIDE), np.int8)
    for row, col in rng.integers(0, SIDE - 6, (14, 2)):
        if max(abs(row + 3 - SIDE // 2), abs(col + 3 - SIDE // 2)) > 9:
            occupied[row : row + 6, col : col + 6] = rng.choice([100, -1])
    near = inflate(occupied, TABLE)
    goal = rng.uniform(0.5, 3.5, 2)
    to_go = distances(*goal).astype(np.float32)
    to_go[near > 230] = np.inf
    steps = int(rng.integers(10, 57))
    speeds = rng.uniform(0.1, 1.5, 3)
    return Request(
        samples=int(rng.choice([128, 256, 400])),
        steps=steps,
        knot_steps=int(rng.integers(1, 9)),
        state=np.array(
            [*rng.uniform(1.8, 2.2, 2), rng.uniform(-4, 4), *rng.uniform(-0.3, 0.5, 2), *rng.normal(0, 0.5, 2)]
        ),
        controls=rng.normal(0.2, 0.3, (steps, 2)).astype(np.float32),
        model=np.array([rng.uniform(0.02, 0.12), -speeds[0], *speeds[1:], *rng.uniform(0.3, 3.0, 3)]),
        noise=np.array([*rng.uniform(0.05, 0.6, 2), rng.uniform(0.01, 0.3), rng.integers(0, 99), rng.uniform(0, 2)]),
        discs=np.stack([rng.uniform(-0.3, 0.2, (k := int(rng.integers(1, 5)))), rng.uniform(0.05, 0.2, k)], axis=1),
        nearness=near,
        to_go=to_go,
        resolution=CELL,
        unit=UNIT,
        goal=np.array(
            [*goal, rng.uniform(-4, 4), rng.integers(0, 2), rng.choice([0.0, 0.8]), 0.4, rng.integers(-1, 2)]
        ),
        movers=np.column_stack(
            [
                rng.uniform(0, 4, (m := int(rng.integers(0, 5)), 2)),
                rng.normal(0, 0.6, (m, 2)),
                rng.uniform(0.1, 0.5, m),
                rng.uniform(0, 0.02, (m, 2)),
            ]
        ),
        weights=np.array([1000, 50, *rng.uniform(0, 2, 13)]),
        bounds=rng.uniform(0, 0.7, 5),
    )
