"""Rows of evaluations that never ran: drawn by seed, with failures in clusters."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence

import numpy as np

from trundle.evaluation.row import Row


def make_rows(
    missions: int,
    *,
    worlds: Sequence[str] = ("office", "warehouse"),
    planners: Sequence[str] = ("jps", "least_cost"),
    failing: Sequence[float] = (0.07, 0.0),
    seed: int = 0,
    vary: bool = False,
    slower_s: Sequence[float] = (),
) -> Iterator[Row]:
    """Rows of `missions` missions in each world with each planner; planner k fails with probability `failing[k]`."""
    rng = np.random.default_rng(seed)
    index = 0
    for world in worlds:
        for mission in range(missions):
            start, goal = rng.uniform(-9.0, 9.0, 2), rng.uniform(-9.0, 9.0, 2)
            hardness, noise = rng.uniform(), rng.normal(size=6)
            straight = float(np.hypot(*(goal - start))) + 0.5
            for place, planner in enumerate(planners):
                friction = float(rng.uniform(0.4, 1.0)) if vary else 1.0
                fails = hardness < failing[place % len(failing)] + (0.5 * max(0.0, 0.6 - friction) if vary else 0.0)
                late = slower_s[place] if place < len(slower_s) else 0.0
                yield _row(index, world, mission, planner, start, goal, straight, fails, late, noise, friction, vary)
                index += 1


def _row(
    index: int,
    world: str,
    mission: int,
    planner: str,
    start: np.ndarray,
    goal: np.ndarray,
    straight: float,
    fails: bool,
    late: float,
    noise: np.ndarray,
    friction: float,
    vary: bool,
) -> Row:
    distance = straight * 1.05 + 0.02 * abs(noise[0])
    end = np.array([6.0, 2.0]) + 0.2 * noise[1:3] if fails else goal
    share = np.linspace(0.0, 1.0, 24)[:, None]
    bend = np.sin(share * math.pi) * noise[3:5] * 0.8
    trail = np.round(start + share * (end - start) + bend, 2).ravel()
    outcome = ("stuck", "collided", "stuck", "timed_out")[mission % 4] if fails else "arrived"
    name = hashlib.sha256(f"{world} {planner} {mission}".encode()).hexdigest()[:16]
    return Row(
        id=name,
        mission=hashlib.sha256(f"{world} {mission}".encode()).hexdigest()[:16],
        index=index,
        world=world,
        robot="nova_carter",
        planner=planner,
        controller="regulated_pure_pursuit",
        backend="kinematic",
        seed=mission,
        outcome=outcome,
        message=f"{outcome} at ({end[0]:.2f}, {end[1]:.2f}) after {20.0 + noise[0]:.1f} s",
        time_s=round(distance / 0.6 + 2.0 + late + 0.1 * noise[5], 2),
        distance_m=distance,
        spl=0.0 if fails else straight / distance,
        min_clearance_m=0.0 if outcome == "collided" else round(0.05 + 0.2 * abs(noise[2]), 3),
        contacts=1 if outcome == "collided" else 0,
        replans=0,
        path_length_m=straight * 1.02,
        shortest_path_m=None if fails else straight,
        max_cross_track_error_m=0.02 + 0.01 * abs(noise[3]),
        smoothness_rad_per_m=0.3,
        touched="shelf_3" if outcome == "collided" else "",
        start_x=float(start[0]),
        start_y=float(start[1]),
        start_yaw=0.0,
        goal_x=float(goal[0]),
        goal_y=float(goal[1]),
        end_x=float(end[0]),
        end_y=float(end[1]),
        end_yaw=0.0,
        closest_x=float(end[0]) + 0.3,
        closest_y=float(end[1]),
        trail=tuple(float(value) for value in trail),
        vary={"friction": friction, "mass": 1.0 + 0.1 * float(noise[4])} if vary else None,
        place=hashlib.sha256(world.encode()).hexdigest()[:16],
        planning_ms=3.0 + abs(noise[1]) * 2.0 + (10.0 if planner == "jps" else 0.0),
        cpu_s=0.18,
        wall_s=0.2,
    )
