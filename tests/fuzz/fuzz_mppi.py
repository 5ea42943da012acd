"""Steps of `Mppi` against the oracle, in registers of both widths, with wild fields, weights and movers."""

from __future__ import annotations

import dataclasses
import math
import random
from typing import Any

import numpy as np

from fuzz.loop import REFUSALS, attempt, rng_of, spoil, with_extremes
from support import mppi_oracle as oracle
from support.mppi_requests import random_request
from trundle._core import Mppi


def wild_request(generator: random.Random) -> oracle.Request:
    """A request with windows of every size, bytes and costs of every value, and zeros in places."""
    rng = rng_of(generator)
    request = random_request(rng)
    samples, steps = generator.choice((128, 144, 400)), generator.choice((2, 3, 13, 30))
    shape = generator.choice(((2, 2), (2, 70), (33, 80), request.nearness.shape))
    nearness = rng.choice(request.nearness.ravel(), shape) if generator.random() < 0.3 else request.nearness
    nearness = np.ascontiguousarray(nearness[: shape[0], : shape[1]])
    to_go = np.ascontiguousarray(request.to_go[: shape[0], : shape[1]])
    if generator.random() < 0.5:
        nearness = with_extremes(generator, nearness)
    for _ in range(generator.choice((0, 0, 1, 30))):
        to_go = with_extremes(generator, to_go)
    controls = rng.normal(0.2, 0.5, (steps, 2)).astype(np.float32)
    if generator.random() < 0.2:
        controls = with_extremes(generator, controls)
    knots = generator.choice((1, 2, 5, steps))
    changed: dict[str, Any] = {"knot_steps": min(knots, steps), "controls": controls}
    for name in ("state", "weights", "bounds", "movers", "noise"):
        values = getattr(request, name).copy()
        if values.size and generator.random() < 0.3:
            values.flat[generator.randrange(values.size)] = generator.choice((0.0, 0.0, 1e-3, 5.0))
        changed[name] = values
    changed["noise"][2] = np.clip(changed["noise"][2], 0.01, 1.0)
    changed["noise"][3] = generator.randrange(5)
    return dataclasses.replace(request, samples=samples, steps=steps, nearness=nearness, to_go=to_go, **changed)


def finite(*answers: Any) -> bool:
    return all(np.isfinite(np.asarray(answer, float)).all() for answer in answers)


def is_sure(expected: oracle.Answer, answer: tuple[Any, ...]) -> bool:
    """Whether the last digits of the costs decide nothing."""
    return expected.best_taken == answer[-1] and 1e-6 * abs(expected.costs).max() < 1e-3 * expected.temperature


def check_costs(costs: Any, expected: Any) -> None:
    """All are close; where a spoiled field is flat, digits decide in which direction it falls."""
    errors = np.abs(costs - expected) / (1.0 + np.abs(expected))
    assert errors.max() < 1e-2
    assert np.quantile(errors, 0.97) < 1e-5


def compare(request: oracle.Request) -> None:
    kernel = Mppi(request.samples, request.steps, request.knot_steps, "base")
    arguments = request.arguments()
    answer = kernel.step(*arguments)
    costs = kernel.costs()
    assert finite(answer, arguments[1], costs, *kernel.rollouts(7))
    expected = oracle.step(request)
    check_costs(costs, expected.costs)
    assert answer[4:6] == (expected.free.sum(), (~expected.free).sum())
    assert answer[7] == 0
    if is_sure(expected, answer):
        assert np.allclose(arguments[1], expected.controls, atol=2e-3)
    best = Mppi(request.samples, request.steps, request.knot_steps)
    again = request.arguments()
    assert best.step(*again) == answer
    assert again[1].tobytes() == arguments[1].tobytes()
    assert best.costs().tobytes() == costs.tobytes()


def one_round(generator: random.Random) -> None:
    request = wild_request(generator)
    compare(request)
    sizes = spoil(generator, (request.samples, request.steps, request.knot_steps, "base"))
    if math.prod(size for size in sizes[:3] if isinstance(size, int)) < 2**30:
        attempt(Mppi, sizes)
    kernel = Mppi(request.samples, request.steps, request.knot_steps)
    numbers = spoil(generator, request.numbers())
    try:
        arguments = oracle.arguments_of(*numbers)
        answer = kernel.step(*arguments)
    except REFUSALS:
        return
    assert finite(answer, arguments[1], kernel.costs(), *kernel.rollouts(7))
