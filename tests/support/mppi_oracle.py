"""`Mppi.step` in NumPy: all trajectories first, then a function for each critic.

Motion is in single precision in the kernel's order of operations, so that each sample meets the same cells; costs and
weights are in double precision.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from support.mppi_values import Courses, Doubles, Floats, Request, knots_of

ARCS, HALF = 64, 8
SPEEDS = (-1.0, -0.5, 0.0, 0.25, 0.5, 0.75, 1.0)
TURNS = (-1.0, -0.5, -0.25, -0.1, 0.0, 0.1, 0.25, 0.5, 1.0)


@dataclass
class Answer:
    """What a step is to answer."""

    costs: Doubles
    controls: Floats
    courses: Courses
    contacts: npt.NDArray[np.bool_]
    cost: float
    temperature: float
    effective: float
    best_taken: bool
    free: npt.NDArray[np.bool_] = field(init=False)

    def __post_init__(self) -> None:
        self.free = self.courses.hit_step == self.controls.shape[0]


def hashed(counter: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    with np.errstate(over="ignore"):
        z = counter * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def normals(seed: int, count: int) -> Floats:
    """Sums of twelve numbers of 16 bits."""
    first = hashed(np.array([seed + 1], np.uint64)) + np.uint64(3) * np.arange(count, dtype=np.uint64)
    total = np.zeros(count, np.int64)
    for i in range(3):
        bits = hashed(first + np.uint64(i))
        for k in range(4):
            total += ((bits >> np.uint64(16 * k)) & np.uint64(0xFFFF)).astype(np.int64)
    return ((total - 6 * 65535) / 65536).astype(np.float32)


def unit_draws(request: Request) -> Floats:
    """Draws of one half of the antithetic pairs, shape (pairs, knots, 2), wide and narrow; the first is 0."""
    blocks, knots = (request.samples - ARCS) // (2 * HALF), knots_of(request)
    draws = normals(int(request.noise[3]), blocks * knots * 2 * HALF).reshape(blocks, knots, 2, HALF)
    draws = np.ascontiguousarray(draws.transpose(0, 3, 1, 2))
    draws[0, 0] = 0.0
    draws *= np.float32(0.5) ** (np.arange(blocks, dtype=np.float32) % 4)[:, np.newaxis, np.newaxis, np.newaxis]
    return draws.reshape(-1, knots, 2)


def arcs_of(request: Request) -> Floats:
    """Speeds of the constant arcs, shape (64, 2)."""
    _, v_min, v_max, w_max, *_ = request.model.astype(np.float32)
    pairs = [(speed, turn) for speed in SPEEDS for turn in TURNS] + [(0.1, 0.0)]
    shares = np.array(pairs, np.float32)
    v = np.where(shares[:, 0] < 0, -shares[:, 0] * v_min, shares[:, 0] * v_max)
    return np.stack([v, shares[:, 1] * w_max], axis=1).astype(np.float32)


def shifted(request: Request) -> Floats:
    """The controls some steps later."""
    last = request.steps - 1
    at = np.minimum(np.arange(request.steps) + request.noise[4], float(last))
    first = at.astype(int)
    part = (at - first).astype(np.float32)[:, np.newaxis]
    a, b = request.controls[first], request.controls[np.minimum(first + 1, last)]
    with np.errstate(invalid="ignore", over="ignore"):
        value = np.where(part > 0, a + (b - a) * part, a)
        return np.where(np.abs(value) <= 1e6, value, 0.0).astype(np.float32)


def between_knots(knots: Any, request: Request) -> Any:
    """By step what is given by knot, along the axis before the last."""
    step = np.arange(request.steps)
    k = step // request.knot_steps
    share = np.float32(1.0) / np.float32(request.knot_steps)
    part = ((step % request.knot_steps).astype(np.float32) * share)[:, np.newaxis]
    return knots[..., k, :] + (knots[..., k + 1, :] - knots[..., k, :]) * part


def targets_of(request: Request) -> Floats:
    """Speeds that each sample aims at, shape (samples, steps, 2)."""
    nominal = shifted(request)
    scale = request.noise[:2].astype(np.float32)
    half = unit_draws(request)
    # Blocks of 8 samples and their mirror images.
    plus, minus = half * scale, half * -scale
    blocks = np.stack([plus.reshape(-1, HALF, *half.shape[1:]), minus.reshape(-1, HALF, *half.shape[1:])], axis=1)
    noise = between_knots(blocks.reshape(-1, *half.shape[1:]), request)
    arcs = np.broadcast_to(arcs_of(request)[:, np.newaxis], (ARCS, request.steps, 2))
    return np.concatenate([arcs, noise + nominal]).astype(np.float32)


def room_at(request: Request, x: Floats, y: Floats, cos: Floats, sin: Floats) -> list[Floats]:
    """What the window's bytes are under each disc, as single numbers."""
    rows, cols = request.nearness.shape
    found: list[Floats] = []
    for offset in (request.discs[:, 0] / request.resolution).astype(np.float32):
        col = np.clip(x + cos * offset, np.float32(0), np.float32(cols - 0.5)).astype(int)
        row = np.clip(y + sin * offset, np.float32(0), np.float32(rows - 0.5)).astype(int)
        found.append(request.nearness[row, col].astype(np.float32))
    return found


def start_of(request: Request) -> tuple[Floats, ...]:
    x, y, yaw, v, w, _, _ = request.state
    place = x / request.resolution, y / request.resolution, math.cos(yaw), math.sin(yaw), v, w
    return tuple(np.array([value], np.float32) for value in place)


def touching_bytes(request: Request) -> list[np.float32]:
    """The byte from which on each disc touches something; one that does so at the start may stay as near."""
    given = (254.0 - request.discs[:, 1] / request.unit).astype(np.float32)
    here = [byte[0] for byte in room_at(request, *start_of(request)[:4])]
    return [np.float32(byte + 0.5) if byte >= limit else limit for byte, limit in zip(here, given, strict=True)]


def drive(request: Request, targets: Floats, stops: bool = True) -> Courses:
    """Move all samples step by step; one that touches something stands from then on."""
    f32 = np.float32
    dt, v_min, v_max, w_max, faster, slower, turn = request.model
    up, down, aside = f32(faster * dt), f32(slower * dt), f32(turn * dt)
    half_step = f32(0.5 * dt / request.resolution)
    count = len(targets)
    x, y, cos, sin, v, w = (np.repeat(value, count) for value in start_of(request))
    limits = touching_bytes(request)
    alive, hit_step = np.ones(count, bool), np.full(count, request.steps)
    kept: list[tuple[Any, ...]] = []
    for step in range(request.steps):
        aim_v = np.clip(targets[:, step, 0], f32(v_min), f32(v_max))
        aim_w = np.clip(targets[:, step, 1], f32(-w_max), f32(w_max))
        next_v = np.clip(aim_v, v - np.where(v > 0, down, up), v + np.where(v < 0, down, up))
        next_w = np.clip(aim_w, w - aside, w + aside)
        v, w = np.where(alive, next_v, f32(0)), np.where(alive, next_w, f32(0))
        angle = w * f32(dt)
        square = angle * angle
        turn_cos = f32(1) - square * (f32(0.5) - square * f32(1 / 24))
        turn_sin = angle * (f32(1) - square * (f32(1) / f32(6) - square * (f32(1) / f32(120))))
        new_cos, new_sin = cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin
        half = v * half_step
        x, y = x + half * (cos + new_cos), y + half * (sin + new_sin)
        cos, sin = new_cos, new_sin
        bytes_ = room_at(request, x, y, cos, sin)
        room = np.min([limit - byte for limit, byte in zip(limits, bytes_, strict=True)], axis=0)
        kept.append((x, y, cos, sin, v, w, room, alive))
        if stops:
            hit = alive & (room <= 0)
            hit_step = np.where(hit, step, hit_step)
            alive = alive & ~hit
    x, y, cos, sin, v, w, room, was_alive = (np.stack(values, axis=1) for values in zip(*kept, strict=True))
    return Courses(x, y, cos, sin, v, w, room, was_alive, hit_step)


# Critics: costs of each sample ----------------------------------------------------------------------------------------


def summed(courses: Courses, by_step: Any) -> Doubles:
    """Over the steps before and in which a sample touches something."""
    return np.where(courses.alive, by_step, 0.0).sum(axis=1)


def obstacle_costs(request: Request, courses: Courses) -> Doubles:
    speed = np.abs(courses.v).astype(float)
    near = np.maximum(1.0 - courses.room * (request.unit / max(request.bounds[0], 1e-6)), 0.0)
    return summed(courses, near**2 * speed * request.model[0] * (request.weights[7] + request.weights[8] * speed))


def collision_costs(request: Request, courses: Courses) -> Doubles:
    left = 1.0 + (request.steps - courses.hit_step) / request.steps
    return np.where(courses.hit_step < request.steps, left * request.weights[0], 0.0)


def direction_costs(request: Request, courses: Courses) -> Doubles:
    against = np.maximum(-np.sign(request.goal[6]) * courses.v, 0.0)
    return summed(courses, against * request.model[0] * request.weights[10])


def twirl_costs(request: Request, courses: Courses) -> Doubles:
    return summed(courses, np.abs(courses.w) * request.model[0] * request.weights[11])


def speed_costs(request: Request, courses: Courses) -> Doubles:
    over = np.maximum(np.abs(courses.v).astype(float) - request.bounds[4], 0.0)
    return summed(courses, over**2 * request.model[0] * request.weights[14])


def smoothness_costs(request: Request, courses: Courses) -> Doubles:
    dt = request.model[0]
    total = np.zeros(len(courses.v))
    for speeds, now, before, limit in (
        (courses.v, request.state[3], request.state[5], request.model[4]),
        (courses.w, request.state[4], request.state[6], request.model[6]),
    ):
        changes = np.diff(speeds.astype(float), axis=1, prepend=np.float32(now)) / (limit * dt)
        jerks = np.diff(changes, axis=1, prepend=before / limit)
        total += summed(courses, request.weights[12] * changes**2 + request.weights[13] * jerks**2) / request.steps
    return total


def mover_costs(request: Request, courses: Courses) -> tuple[Doubles, npt.NDArray[np.bool_]]:
    """What is near a mover's predicted places, and touches one."""
    cell, dt = request.resolution, request.model[0]
    _, margin, sigmas, *_ = request.bounds
    radius = request.discs[:, 1].max(initial=0.0)
    rear, front = request.discs[:, 0].min() / cell, request.discs[:, 0].max() / cell
    total, surest = np.zeros(len(courses.v)), np.zeros(len(courses.v))
    time = dt * np.arange(1, request.steps + 1)
    for x, y, vx, vy, own, place, velocity in request.movers:
        variance = place + velocity * time**2
        touch = max((own + radius) / cell, 1e-3)
        reach = touch + np.maximum((margin + sigmas * np.sqrt(variance)) / cell, 1e-2)
        certainty = touch**2 / (touch**2 + 2.0 * variance / cell**2)
        weighed = certainty * (1.0 - 0.5 * np.arange(request.steps) / request.steps)
        dx, dy = (x + vx * time) / cell - courses.x, (y + vy * time) / cell - courses.y
        ahead, left = dx * courses.cos + dy * courses.sin, dy * courses.cos - dx * courses.sin
        square = (ahead - np.clip(ahead, rear, front)) ** 2 + left**2
        share = np.maximum((reach**2 - square) / (reach**2 - touch**2), 0.0)
        total += summed(courses, share**2 * request.weights[9] * certainty * dt)
        surest = np.maximum(surest, np.where(courses.alive & (share >= 1.0), weighed, 0.0).max(axis=1))
    return total + surest * request.weights[1], surest > 0.0


def read_to_go(request: Request) -> tuple[Doubles, float]:
    """Costs to go without numbers that are none, and what stands for unreachable."""
    known = request.to_go < 1e6
    most = max(float(request.to_go[known].max(initial=0.0)), 0.0)
    unreachable = most + request.resolution * sum(request.to_go.shape)
    return np.where(known, np.maximum(request.to_go, 0.0), unreachable).astype(float), unreachable


def interpolated(request: Request, x: Floats, y: Floats) -> tuple[Doubles, Doubles, Doubles]:
    """Cost to go, and the direction in which it falls."""
    field_, unreachable = read_to_go(request)
    rows, cols = field_.shape
    col = np.clip(x - np.float32(0.5), np.float32(0), np.float32(cols - 1))
    row = np.clip(y - np.float32(0.5), np.float32(0), np.float32(rows - 1))
    c, r = np.minimum(col.astype(int), cols - 2), np.minimum(row.astype(int), rows - 2)
    tx, ty = (col - c).astype(float), (row - r).astype(float)
    corners = np.stack([field_[r, c], field_[r, c + 1], field_[r + 1, c], field_[r + 1, c + 1]])
    rim = np.minimum(corners.min(axis=0) + 3.0 * request.resolution, unreachable)
    a, b, d, e = np.where(corners < np.float32(unreachable), corners, rim)
    lower, upper = a + (b - a) * tx, d + (e - d) * tx
    return lower + (upper - lower) * ty, (a - b) + ((d - e) - (a - b)) * ty, lower - upper


def half_cosine(cosine: Doubles) -> Doubles:
    return np.sqrt(np.maximum(0.5 + 0.5 * cosine, 0.0))


def goal_costs(request: Request, courses: Courses) -> Doubles:
    """Cost to go, heading, goal yaw and overshoot, at the end of each stretch between knots."""
    goal_x, goal_y, goal_yaw, has_yaw, reach, fade, way = request.goal
    ends = np.minimum(np.arange(1, knots_of(request)) * request.knot_steps, request.steps) - 1
    x, y, cos, sin = (values[:, ends] for values in (courses.x, courses.y, courses.cos, courses.sin))
    to_go, fall_x, fall_y = interpolated(request, x, y)
    near = np.zeros(to_go.shape)
    if reach > 0.0:
        dx, dy = goal_x / request.resolution - x, goal_y / request.resolution - y
        distance = np.hypot(dx, dy)
        straight = distance < reach / request.resolution
        to_go = np.where(straight, distance * request.resolution, to_go)
        fall_x, fall_y = np.where(straight, dx, fall_x), np.where(straight, dy, fall_y)
        near = np.maximum(1.0 - distance * request.resolution / max(fade, 1e-3), 0.0)
    along = (fall_x * cos + fall_y * sin) / np.maximum(np.hypot(fall_x, fall_y), 1e-6)
    ahead = along * np.sign(way) if way != 0.0 else np.abs(along)
    free = math.cos(0.5 * min(request.bounds[3], math.pi))
    heading = np.maximum(free - half_cosine(ahead), 0.0) * (1.0 - near)
    cost = request.weights[2] * to_go.mean(axis=1) + request.weights[3] * to_go[:, -1]
    cost += request.weights[4] * heading.mean(axis=1)
    if reach > 0.0 and has_yaw > 0.0:
        towards = cos * math.cos(goal_yaw) + sin * math.sin(goal_yaw)
        cost += request.weights[5] * (1.0 - half_cosine(towards) * near).mean(axis=1)
    speed = np.where(courses.hit_step < request.steps, 0.0, courses.v[:, -1])
    stop = speed**2 / (2.0 * request.model[5])
    return cost + request.weights[6] * np.maximum(stop - to_go[:, -1], 0.0)


def costs_of(request: Request, courses: Courses) -> tuple[Doubles, npt.NDArray[np.bool_]]:
    """What each sample costs, and whether it touches a mover."""
    movers, contacts = mover_costs(request, courses)
    critics = (
        *(obstacle_costs, collision_costs, direction_costs, twirl_costs, speed_costs, smoothness_costs),
        goal_costs,
    )
    return movers + sum(critic(request, courses) for critic in critics), contacts


# The answer -----------------------------------------------------------------------------------------------------------


def effective_size(weights: Doubles) -> float:
    return float(weights.sum() ** 2 / (weights**2).sum())


def softmin(gaps: Doubles, aim: float) -> tuple[Doubles, float]:
    """Weights at the temperature at which as many samples as `aim` take effect, and the temperature."""
    mean = float(gaps.mean())
    scale = mean if mean > 1e-20 else 1.0
    low, high = -14.0, 8.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        if effective_size(np.exp(-gaps / (scale * 2.0**middle))) > aim:
            high = middle
        else:
            low = middle
    temperature = scale * 2.0 ** (0.5 * (low + high))
    return np.exp(-gaps / temperature), temperature


def realised(courses: Courses) -> Floats:
    return np.stack([courses.v[0], courses.w[0]], axis=1)


def step(request: Request) -> Answer:
    """The answer of one step."""
    targets = targets_of(request)
    courses = drive(request, targets)
    costs, contacts = costs_of(request, courses)
    free = courses.hit_step == request.steps
    used = free if free.any() else np.ones(len(costs), bool)
    chosen = np.flatnonzero(used)
    best = int(chosen[np.argmin(costs[chosen])])
    untouched = np.count_nonzero(~contacts[chosen])
    aim = max(1.0, min(np.float32(request.noise[2]) * request.samples, 0.5 * (untouched or len(chosen))))
    weights, temperature = softmin(costs[chosen] - costs[best], aim)
    effective = effective_size(weights)
    mean = np.einsum("n,ntk->tk", weights / weights.sum(), targets[chosen].astype(float)).astype(np.float32)
    alone = drive(request, mean[np.newaxis])
    (cost,), (contact,) = costs_of(request, alone)
    touches = alone.hit_step[0] < request.steps or (contact and not contacts[best])
    best_taken = bool(touches and free[best])
    final = drive(request, targets[[best]] if best_taken else mean[np.newaxis], stops=False)
    own = float(costs[best]) if best_taken else float(cost)
    return Answer(costs, realised(final), courses, contacts, own, temperature, effective, best_taken)
