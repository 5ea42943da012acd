"""Whole missions in the kernel against the navigator in Python, and what measures them against NumPy."""

from __future__ import annotations

import random
from functools import partial
from typing import Any

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.distance_oracle import distances_to_polyline, polygon_distances
from support.period_oracle import drive_period as drive_slowly
from support.stopping_oracle import stopping_poses as stop_slowly
from trundle._core import (
    MissionDriver,
    chebyshev_field,
    drive_period,
    outline_distances,
    polyline_distances,
    stopping_poses,
)
from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D
from trundle.geometry.footprint import convex_hull
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome
from trundle.mission.batch.missions import numbers_of
from trundle.mission.running.session import Session
from trundle.navigation import Navigator
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

ROBOTS = [Robot.load(name) for name in ("nova_carter", "turtlebot3_burger")]
ARRIVED, TIMED_OUT, DRIVING = 0, 1, 8


def make_path(generator: random.Random) -> Path:
    """Lines with bends and turns in place, some of them driven backwards."""
    rng = rng_of(generator)
    corners = np.cumsum(rng.uniform(-1.2, 1.2, (generator.choice((1, 2, 4)), 2)), axis=0)
    places = np.vstack([[0.0, 0.0], corners])
    yaws = np.arctan2(*np.diff(places, axis=0).T[::-1])
    backward = rng.random(len(yaws)) < 0.2
    yaws = yaws + np.pi * backward
    poses, legs = [], []
    for leg, yaw in enumerate(yaws):
        poses += [(*places[leg], yaw), (*places[leg + 1], yaw)]
        legs += [False, backward[leg]]
    return Path(np.array(poses), backward=np.array(legs[1:]))


def check_distances(generator: random.Random) -> None:
    """Distances of points and outlines, some of which touch, and of polygons without an area."""
    rng = rng_of(generator)
    points = rng.uniform(-3, 3, (generator.choice((0, 1, 40)), 2))
    corners = np.round(rng.uniform(-3, 3, (generator.choice((1, 2, 9)), 2)), generator.choice((0, 6)))
    outlines = convex_hull(rng.uniform(-1, 1, (6, 2)))[None] + rng.uniform(-3, 3, (generator.choice((1, 20)), 1, 2))
    shape = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, generator.choice((0.0, 1.0))), (0.0, generator.choice((0.0, 1.0)))])
    polygons = shape[None, :: generator.choice((1, -1))] * rng.uniform(0.1, 2) + rng.uniform(-3, 3, (3, 1, 2))
    polygons = np.ascontiguousarray(polygons)
    if generator.random() < 0.4:
        attempt(polyline_distances, spoil(generator, (points, corners)))
        attempt(outline_distances, spoil(generator, (outlines, polygons)))
        return
    expected = distances_to_polyline(points, corners) if len(points) else np.zeros(0)
    assert np.abs(polyline_distances(points, corners) - expected).max(initial=0.0) < 1e-12
    assert np.abs(outline_distances(outlines, polygons) - polygon_distances(outlines, polygons)).max() < 1e-12


def check_stops(generator: random.Random) -> None:
    """A robot that drives a command and brakes, from any motion."""
    rng = rng_of(generator)
    pose, speeds = rng.uniform(-3, 3, 3).tolist(), (rng.uniform(-2, 2, 4) * generator.choice((0.0, 1.0, 1e3))).tolist()
    limits = (1.2, generator.choice((0.0, 0.5)), 2.0, generator.choice((1e-3, 2.5)), generator.choice((0.5, 8.0)))
    arguments = (*pose, *speeds, *limits, generator.choice((0.05, 1.0)), generator.choice((np.inf, 0.03)))
    if generator.random() < 0.4:
        attempt(stopping_poses, spoil(generator, arguments))
        return
    assert np.allclose(stopping_poses(*arguments), stop_slowly(*arguments), rtol=1e-9, atol=1e-9)


def check_periods(generator: random.Random) -> None:
    """Control periods of an ideal robot, one after the other, with commands within and above its limits."""
    rng = rng_of(generator)
    state = np.array([*rng.uniform(-3, 3, 3), *np.zeros(8)])
    wheels = 0.14, 0.4, generator.choice((np.inf, 5.0))
    limits = np.array([1.2, generator.choice((0.0, 0.5)), 2.0, *rng.uniform(1e-3, 0.1, 2), *wheels, 0.005])
    for _ in range(3):
        speeds = (rng.uniform(-2, 2, 2) * generator.choice((0.0, 1.0, 1e3))).tolist()
        arguments = (state, *speeds, limits, generator.choice((1, 10)))
        if generator.random() < 0.3:
            attempt(drive_period, spoil(generator, arguments))
            return
        found, expected = drive_period(*arguments), drive_slowly(*arguments)
        assert np.allclose(found[0], expected[0], rtol=1e-12, atol=1e-12)
        assert np.allclose(found[1], expected[1], rtol=1e-12, atol=1e-12)
        assert found[2] == expected[2]
        state = found[0][-1]


def one_round(generator: random.Random) -> None:
    """Drive, stop, or measure."""
    generator.choice((drive, check_stops, check_periods, check_distances))(generator)


def drive(generator: random.Random) -> None:
    """Drive one path beside a few blocked cells, or give the kernel what it does not expect."""
    rng, robot = rng_of(generator), generator.choice(ROBOTS)
    path = make_path(generator)
    cells = np.zeros((200, 200), np.int8)
    for row, col in rng.integers(0, 195, (generator.choice((0, 5, 30)), 2)):
        cells[row : row + 4, col : col + 4] = 100
    grid = OccupancyGrid(cells, 0.05, Pose2D(-5.0, -5.0, 0.0))
    costmap = Costmap.from_grid(grid, robot, inflation_radius=generator.choice((0.55, 1.5)))
    navigator = Navigator((grid, costmap), robot, planner=lambda *_: path)
    start, goal = Pose2D(*(path.poses[0] + rng.normal(0.0, 0.03, 3))), Goal.of(path.goal)
    limit_s, check = generator.choice((4.0, 60.0)), PathCheck(path)
    model = (
        *(costmap.data, chebyshev_field((costmap.data >= 254).view(np.uint8)), costmap.resolution),
        *(np.array(costmap.origin.as_tuple()), *numbers_of(navigator)),
    )
    mission = (
        *(np.array([start.as_tuple()]), np.array([goal.pose.as_tuple()]), np.array([limit_s]), path.poses),
        *(np.append(path.backward, False), np.array([len(path.poses)]), check.poses, check.along),
        *(np.array([len(check.poses)]), 1),
    )
    stepped = (
        *(np.array(start.as_tuple()), np.array(goal.pose.as_tuple()), limit_s, path.poses),
        *(np.append(path.backward, False), check.poses, check.along, np.array([0.5, 7.0, 20.0])),
    )
    if generator.random() < 0.7:
        made = attempt(MissionDriver, spoil(generator, model)) if generator.random() < 0.5 else MissionDriver(*model)
        if made is not None:
            attempt(made.drive, spoil(generator, mission))
            attempt(partial(step, made), spoil(generator, stepped))
        return
    rows, ends, results = MissionDriver(*model).drive(*mission)
    assert ends.tolist() == [len(rows)]
    ending, again, standing = step(MissionDriver(*model), *stepped)
    assert np.array_equal(again, rows)
    assert [ending, standing] == results[0].tolist()
    assert np.array_equal(step_by_others(MissionDriver(*model), rows, *stepped), rows)
    check_drive(rows, results[0].tolist(), navigator, grid, start, goal, limit_s)


def step(driver: MissionDriver, *mission: Any) -> tuple[int, Any, int]:
    """Drive one mission period by period."""
    run = driver.begin(*mission)
    attempt(run.take, (0.1, 0.0))  # out of turn
    while True:
        ending, *_, v, w = run.decide()
        if ending != DRIVING:
            return ending, *run.result()
        run.move(v, w)


def step_by_others(driver: MissionDriver, rows: Any, *mission: Any) -> Any:
    """Drive it again by the commands that it was driven by, and those of the kernel in its last period."""
    run = driver.begin(*mission)
    for v, w in rows[1:, 5:].tolist():
        assert run.look() == (DRIVING, *rows[len(run.result()[0]) - 1, :5].tolist())
        assert run.take(v, w) == DRIVING
        run.move(v, w)
    run.look()
    return run.result()[0]


def check_drive(
    rows: Any, result: list[int], navigator: Navigator, grid: OccupancyGrid, start: Pose2D, goal: Goal, limit_s: float
) -> None:
    """Compare what the kernel has driven with the same mission in Python."""
    sim = KinematicSimulator(World.from_map(grid, unknown="free"), navigator.robot)
    with Session(sim, navigator, start, goal, time_limit_s=limit_s, measure=None) as session:
        while len(session_rows := session._log._rows) < len(rows) and session.step() is not None:
            pass
        driven = np.array(session_rows)[:, [1, 2, 3, 4, 5, 6, 7]]
        assert len(driven) == len(rows)
        assert np.abs(driven - rows).max() < 1e-9
        if result[0] in (ARRIVED, TIMED_OUT):
            assert session.step() is None
            assert session.outcome is (Outcome.ARRIVED if result[0] == ARRIVED else Outcome.TIMED_OUT)
